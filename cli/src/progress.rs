//! The progress of long work, on standard error if that is a terminal.

use std::time::Duration;

use indicatif::{ProgressBar, ProgressStyle};

const TICK: Duration = Duration::from_millis(200);

pub(crate) struct ProgressDisplay(Option<ProgressBar>);

impl ProgressDisplay {
    /// Of work with this many pieces; of an unknown number if it is 0.
    pub(crate) fn new(whole: usize, quiet: bool) -> Self {
        Self((!quiet).then(|| new_bar(whole)))
    }

    pub(crate) fn show(&self, done: usize, what: &str) {
        let Self(Some(bar)) = self else { return };
        bar.set_position(done as u64);
        if bar.message() != what {
            bar.set_message(what.to_owned());
        }
    }

    pub(crate) fn wait(quiet: bool, what: &'static str) -> Self {
        let progress = Self::new(0, quiet);
        progress.show(0, what);
        progress
    }
}

impl Drop for ProgressDisplay {
    fn drop(&mut self) {
        if let Self(Some(bar)) = self {
            bar.finish_and_clear();
        }
    }
}

/// It hides itself where standard error is no terminal.
fn new_bar(whole: usize) -> ProgressBar {
    let (bar, template) = match whole {
        0 => (ProgressBar::new_spinner(), "{spinner} {msg}, {elapsed}"),
        _ => (ProgressBar::new(whole as u64), "{bar:40} {percent} %  {msg}, {eta} left"),
    };
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(TICK);
    bar
}
