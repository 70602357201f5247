//! The progress of long work, on standard error if that is a terminal.

use std::time::{Duration, Instant};

use indicatif::{ProgressBar, ProgressStyle};
use kalmanscope_cli::{FilterProgress, Work};

/// Limits the time of work that shows no progress.
const PATIENCE: Duration = Duration::from_millis(400);
/// The time between two pictures of a bar, and between two checks of the clock.
const TICK: Duration = Duration::from_millis(200);

/// The pieces of a bar for the results of one filter.
const OF_FILTER: usize = 1000;

pub(crate) struct Progress {
    started: Instant,
    whole: usize,
    bar: Option<ProgressBar>,
    quiet: bool,
}

impl Progress {
    /// Of work with this many pieces; of an unknown number if it is 0.
    pub(crate) fn new(whole: usize, quiet: bool) -> Self {
        Self { started: Instant::now(), whole, bar: None, quiet }
    }

    pub(crate) fn show(&mut self, done: usize, what: &str) {
        let Self { started, whole, bar, quiet } = self;
        if *quiet || bar.is_none() && started.elapsed() < PATIENCE {
            return;
        }
        let bar = bar.get_or_insert_with(|| new_bar(*whole, *started));
        bar.set_position(done as u64);
        if bar.message() != what {
            bar.set_message(what.to_owned());
        }
    }

    pub(crate) fn of_results(filters: usize, quiet: bool) -> Self {
        Self::new(filters * OF_FILTER, quiet)
    }

    pub(crate) fn show_results(&mut self, FilterProgress { place, name, work, share }: FilterProgress<'_>) {
        let (begin, pieces, what) = match work {
            Work::Filter => (0, 400, name.to_owned()),
            Work::Causes => (400, 500, format!("{name}: causes of its verdict")),
            Work::Bound => (900, 100, format!("{name}: Cramér-Rao bound")),
        };
        self.show(place * OF_FILTER + begin + (share * f64::from(pieces)) as usize, &what);
    }

    /// Shows that work of unknown length is under way.
    pub(crate) fn wait(quiet: bool, what: &'static str) -> Self {
        let mut progress = Self::new(0, quiet);
        if !quiet {
            progress.bar = Some(new_bar(0, progress.started).with_message(what));
        }
        progress
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        if let Some(bar) = &self.bar {
            bar.finish_and_clear();
        }
    }
}

/// It hides itself where standard error is no terminal.
fn new_bar(whole: usize, started: Instant) -> ProgressBar {
    let (bar, template) = match whole {
        0 => (ProgressBar::new_spinner(), "{spinner} {msg}, {elapsed}"),
        _ => (ProgressBar::new(whole as u64), "{bar:40} {percent} %  {msg}, {eta} left"),
    };
    let bar = bar.with_elapsed(started.elapsed());
    if let Ok(style) = ProgressStyle::with_template(template) {
        bar.set_style(style);
    }
    bar.enable_steady_tick(TICK);
    bar
}
