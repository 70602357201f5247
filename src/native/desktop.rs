//! The explorer in a window: its picture is saved two seconds after a change, and when the system asks the program to end.

use std::path::Path;
use std::time::{Duration, Instant};

use eframe::Storage;
use egui::{Context, Ui};
use kalmanscope::App;
use kalmanscope_core::RunError;

use super::record_store::Folder;
use super::state_file::StateFile;

const SOON: Duration = Duration::from_secs(2);

pub(super) struct Desktop {
    app: App,
    file: Option<StateFile>,
    due: Option<Instant>,
}

impl Desktop {
    pub(super) fn new(
        ctx: &Context,
        folder: Result<&Path, String>,
        equip: impl FnOnce(App) -> App,
    ) -> Result<Self, RunError> {
        let (last, file) = match folder.and_then(StateFile::open) {
            Ok((file, last)) => (last, Some(file)),
            Err(reason) => (Err(format!("This session is not saved when the window closes: {reason}.")), None),
        };
        let mut app = App::resumed(ctx, last)?;
        if let Some(file) = &file {
            app = app.keeping_records(Box::new(Folder::of(&file.folder)), ctx);
        }
        Ok(Self { app: equip(app), file, due: None })
    }
}

impl eframe::App for Desktop {
    fn logic(&mut self, ctx: &Context, frame: &mut eframe::Frame) {
        self.app.logic(ctx, frame);
        // Any frame may change the picture, and none comes while nothing changes: each asks for one more, which saves.
        let now = Instant::now();
        let due = *self.due.get_or_insert(now + SOON);
        if now < due {
            ctx.request_repaint_after(due - now);
        }
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        self.app.ui(ui, frame);
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        self.app.clear_color(visuals)
    }

    fn save(&mut self, _: &mut dyn Storage) {
        self.due = None;
        let Some(file) = &mut self.file else { return };
        if let Some(reason) = file.save(&self.app.last_picture()) {
            log::error!("The session is not saved: {reason}");
            self.app.report(&format!("The session is not saved: {reason}."));
        }
    }

    fn auto_save_interval(&self) -> Duration {
        if self.due.is_some_and(|due| due <= Instant::now()) { Duration::ZERO } else { Duration::MAX }
    }
}

#[cfg(unix)]
pub(super) fn close_at_signals(ctx: &Context) {
    use std::thread;

    use egui::{ViewportCommand, ViewportId};
    use signal_hook::consts::{SIGINT, SIGTERM};
    use signal_hook::iterator::Signals;
    use signal_hook::low_level::emulate_default_handler;

    let ctx = ctx.clone();
    let heard = Signals::new([SIGINT, SIGTERM]).and_then(|mut signals| {
        thread::Builder::new().spawn(move || {
            for signal in signals.forever() {
                ctx.send_viewport_cmd_to(ViewportId::ROOT, ViewportCommand::Close);
                // A window that draws no frame does not hear it; then there is nothing to be saved either.
                thread::sleep(SOON);
                emulate_default_handler(signal).ok();
            }
        })
    });
    heard.map_err(|error| log::warn!("Signals do not save the session: {error}")).ok();
}

#[cfg(test)]
mod tests;
