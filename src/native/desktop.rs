//! The explorer in a window: its state outlasts crashes, signals and a second instance.

use std::path::PathBuf;

use eframe::{CreationContext, Storage};
use egui::{Context, Ui};
use kalmanscope::App;
use kalmanscope::saved::{KEY, UNREADABLE_KEY};
use kalmanscope_core::RunError;

use super::crash::{self, Crash};
use super::crash_page::{Choice, CrashPage};
use super::keeper::Keeper;
use super::shelf::Folder;
use super::signals;
use super::slot::Slot;
use super::state_file::StateFile;

/// Makes the explorer from a saved state.
pub(super) type Start = Box<dyn FnOnce(&Context, Option<&dyn Storage>) -> Result<App, RunError>>;

/// The explorer, or the page about a crash before it.
pub(super) struct Desktop {
    stage: Stage,
    memory: Option<Memory>,
}

/// The state of one instance and its place.
pub(super) struct Memory {
    keeper: Keeper,
    slot: Slot,
    /// A sentence for the first frame of the explorer, if the state is not the one that was saved last.
    said: Option<String>,
}

enum Stage {
    /// The page about a crash is shown.
    Telling(Box<CrashPage>, Option<Start>),
    Running(Box<App>),
    /// Not even the first scenario can be run.
    Failed(String),
}

impl Desktop {
    /// The explorer that `start` makes, with the state of an instance, or the reason why nothing is kept.
    ///
    /// # Errors
    /// [`RunError`] where even the first scenario cannot be run.
    pub(super) fn new(
        creation: &CreationContext<'_>,
        memory: Result<Memory, String>,
        start: Start,
    ) -> Result<Self, RunError> {
        let ctx = &creation.egui_ctx;
        let memory = match memory {
            Ok(memory) => memory,
            Err(reason) => {
                let mut app = start(ctx, creation.storage)?;
                app.report(&format!("Nothing of this session is kept when the window closes: {reason}."));
                return Ok(Self { stage: Stage::Running(Box::new(app)), memory: None });
            }
        };
        let stage = match memory.crash() {
            Some(page) => {
                App::set_theme(ctx, Some(&*memory.keeper.kept().file()));
                Stage::Telling(Box::new(page), Some(start))
            }
            None => Stage::Running(Box::new(memory.start(ctx, start)?)),
        };
        Ok(Self { stage, memory: Some(memory) })
    }

    /// Goes on after a crash as the user has chosen.
    fn go_on(&mut self, choice: Choice, ctx: &Context) {
        let Self { stage: Stage::Telling(page, start), memory: Some(memory) } = self else { return };
        let Some(start) = start.take() else { return };
        memory.take_up(choice, page.crash.as_ref().ok().and_then(|crash| crash.session.clone()));
        self.stage = match memory.start(ctx, start) {
            Ok(app) => Stage::Running(Box::new(app)),
            Err(error) => Stage::Failed(error.to_string()),
        };
        ctx.request_repaint();
    }

    /// The explorer, once it runs.
    #[cfg(test)]
    fn app(&mut self) -> Option<&mut App> {
        match &mut self.stage {
            Stage::Running(app) => Some(app),
            _ => None,
        }
    }
}

impl Memory {
    /// The state of an instance. One of an older program is in the toolkit's storage.
    pub(super) fn new(slot: Slot, older: Option<&dyn Storage>) -> Self {
        let (mut file, said) = StateFile::open(&slot);
        if file.get_string(KEY).is_none() {
            for key in [KEY, UNREADABLE_KEY] {
                if let Some(text) = older.and_then(|older| older.get_string(key)) {
                    file.set_string(key, text);
                }
            }
        }
        Self { keeper: Keeper::new(file), slot, said }
    }

    /// From now on the state is saved where the system ends the program, and panics of the program are noted.
    pub(super) fn watch(&self) {
        let Self { keeper, slot, .. } = self;
        signals::save_at_end(keeper.kept());
        crash::note_panics(&slot.path("crash"), &slot.path("state"), keeper.kept());
    }

    /// The crash of the last use, if it ended by one.
    fn crash(&self) -> Option<CrashPage> {
        let crash = Crash::read(&self.slot.path("crash")).transpose()?;
        let place = |crash: &Crash| crash.place.clone();
        let last = Crash::read(&self.told()).ok().flatten().as_ref().map(place);
        let is_repeated = last.is_some() && last == crash.as_ref().ok().map(place);
        Some(CrashPage::new(crash, self.told().display().to_string(), is_repeated))
    }

    /// The file for the note about a crash that the user has seen.
    fn told(&self) -> PathBuf {
        self.slot.path("last-crash")
    }

    /// Restores the state of the crash, or none.
    fn take_up(&self, choice: Choice, session: Option<String>) {
        let mut file = self.keeper.kept().file();
        match (choice, session) {
            (Choice::Restore, Some(session)) => file.set_string(KEY, session),
            // The state that was saved last.
            (Choice::Restore, None) => {}
            (Choice::StartAnew, _) => file.remove_string(KEY),
        }
        drop(file);
        crash::put_aside(&self.slot.path("crash"), &self.told());
    }

    /// The explorer in the state that is kept.
    fn start(&self, ctx: &Context, start: Start) -> Result<App, RunError> {
        let Self { slot, said, keeper } = self;
        let app = start(ctx, Some(&*keeper.kept().file()))?;
        let mut app = app.keeping_records(Box::new(Folder::of(slot)), ctx);
        if let Some(sentence) = said {
            app.report(sentence);
        }
        if slot.is_further() {
            app.inform(&format!(
                "Kalmanscope is open in another window too. This one keeps its settings apart, in {}; they come back in a second \
                 window.",
                slot.path("state").display()
            ));
        }
        Ok(app)
    }
}

impl eframe::App for Desktop {
    fn logic(&mut self, ctx: &Context, frame: &mut eframe::Frame) {
        let Stage::Running(app) = &mut self.stage else { return };
        app.logic(ctx, frame);
        if let Some(Memory { keeper, .. }) = &self.memory {
            keeper.follow(app.saved());
            if let Some(reason) = keeper.trouble() {
                app.report(&format!("The session cannot be saved: {reason}."));
            }
        }
    }

    fn ui(&mut self, ui: &mut Ui, frame: &mut eframe::Frame) {
        match &mut self.stage {
            Stage::Running(app) => app.ui(ui, frame),
            Stage::Telling(page, _) => {
                if let Some(choice) = page.ui(ui) {
                    let ctx = ui.ctx().clone();
                    self.go_on(choice, &ctx);
                }
            }
            Stage::Failed(reason) => {
                ui.label(format!("The first scenario cannot be run: {reason}."));
            }
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    /// The toolkit keeps the window's place. The state has a file of its own; once it exists, the state of an older
    /// program is deleted.
    fn save(&mut self, storage: &mut dyn Storage) {
        let Self { stage, memory } = self;
        match (memory, stage) {
            (Some(memory), _) if memory.slot.path("state").exists() => {
                let old = [KEY, UNREADABLE_KEY].into_iter().filter(|key| storage.get_string(key).is_some());
                old.collect::<Vec<_>>().into_iter().for_each(|key| storage.remove_string(key));
            }
            (None, Stage::Running(app)) => app.save(storage),
            _ => {}
        }
    }

    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        let Self { stage: Stage::Running(_), memory: Some(memory) } = self else { return };
        memory.keeper.kept().save();
        // A panic of a thread that has not ended the program was no crash.
        std::fs::remove_file(memory.slot.path("crash")).ok();
    }
}

#[cfg(test)]
mod tests;
