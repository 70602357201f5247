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
use super::signals;
use super::slot::Slot;
use super::state_file::StateFile;

/// Makes the explorer from a saved state.
pub(super) type Start = Box<dyn FnOnce(&Context, Option<&dyn Storage>) -> Result<App, RunError>>;

/// The explorer, or the page that tells of a crash before it.
pub(super) struct Desktop {
    stage: Stage,
    memory: Option<Memory>,
}

/// The state of one instance and its place.
pub(super) struct Memory {
    keeper: Keeper,
    slot: Slot,
    /// A sentence for the first frame of the explorer, where the state is not the one that was saved last.
    said: Option<String>,
}

enum Stage {
    /// A crash is told.
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

    /// The explorer, once it is there.
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

    /// The place of the note about a crash that has been told.
    fn told(&self) -> PathBuf {
        self.slot.path("last-crash")
    }

    /// Takes up the state as of a crash, or none.
    fn take_up(&self, choice: Choice, session: Option<String>) {
        let mut file = self.keeper.kept().file();
        match (choice, session) {
            (Choice::Restore, Some(session)) => file.set_string(KEY, session),
            // That which was saved last.
            (Choice::Restore, None) => {}
            (Choice::StartAnew, _) => file.remove_string(KEY),
        }
        drop(file);
        crash::put_aside(&self.slot.path("crash"), &self.told());
    }

    /// The explorer in the state that is kept.
    fn start(&self, ctx: &Context, start: Start) -> Result<App, RunError> {
        let mut app = start(ctx, Some(&*self.keeper.kept().file()))?;
        let Self { slot, said, .. } = self;
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

    /// The toolkit keeps the window's place; the state has a file of its own.
    fn save(&mut self, storage: &mut dyn Storage) {
        let Some(Memory { keeper, .. }) = &self.memory else {
            if let Stage::Running(app) = &mut self.stage {
                app.save(storage);
            }
            return;
        };
        keeper.kept().save();
        if keeper.kept().file().get_string(KEY).is_some() {
            for key in [KEY, UNREADABLE_KEY] {
                if storage.get_string(key).is_some() {
                    storage.remove_string(key);
                }
            }
        }
    }

    /// A panic of a thread that has not ended the program is no crash.
    fn on_exit(&mut self, _: Option<&eframe::glow::Context>) {
        if let Self { stage: Stage::Running(_), memory: Some(memory) } = self {
            std::fs::remove_file(memory.slot.path("crash")).ok();
        }
    }
}

#[cfg(test)]
mod tests {
    use std::path::Path;

    use egui::{Theme, Vec2};
    use egui_kittest::Harness;
    use egui_kittest::kittest::Queryable as _;
    use kalmanscope_core::Scenario;

    use super::*;

    type Screen = Harness<'static, Desktop>;

    /// The program with its state in a folder.
    fn started(folder: &Path) -> Screen {
        let folder = folder.to_owned();
        let builder = Harness::builder().with_size(Vec2::new(1000.0, 700.0)).with_theme(Theme::Light);
        let mut screen = builder.build_eframe(move |creation| {
            let memory = Slot::take(&folder).map(|slot| Memory::new(slot, creation.storage));
            Desktop::new(creation, memory, Box::new(App::stored)).expect("the first scenario can be run")
        });
        screen.run_steps(2);
        screen
    }

    fn seed(screen: &mut Screen) -> u64 {
        app(screen).session().scenario().seed
    }

    fn app(screen: &mut Screen) -> &mut App {
        screen.state_mut().app().expect("it is there")
    }

    fn set_seed(screen: &mut Screen, seed: u64) {
        let session = app(screen).session_mut();
        session.set_scenario(Scenario { seed, ..session.scenario().clone() });
        screen.run_steps(2);
    }

    /// A note about a crash with this seed on screen, and a state with another one.
    fn crashed(folder: &Path) {
        let mut screen = started(folder);
        set_seed(&mut screen, 77);
        let session = app(&mut screen).saved().text().expect("it can be written");
        set_seed(&mut screen, 66);
        drop(screen);
        let note = serde_json::json!({
            "kalmanscope_crash": 1, "version": "0.1.0", "message": "the device is lost", "place": "src/main.rs:1:1",
            "thread": "main", "time": 0, "state": "state.json", "session": session,
        });
        std::fs::write(folder.join("crash.json"), note.to_string()).expect("it can be written");
    }

    #[test]
    fn the_state_comes_back_and_two_windows_have_their_own() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let mut first = started(folder.path());
        assert_eq!(app(&mut first).notice(), None);
        set_seed(&mut first, 5);
        drop(first);
        let mut again = started(folder.path());
        assert_eq!((seed(&mut again), app(&mut again).notice()), (5, None));
        let mut second = started(folder.path());
        let notice = app(&mut second).notice().expect("it is said").to_owned();
        assert!(notice.contains("open in another window") && notice.contains("state-2.json"), "{notice}");
        assert_eq!(seed(&mut second), 5, "it begins with the state of the first");
        set_seed(&mut second, 6);
        drop(second);
        drop(again);
        let mut again = started(folder.path());
        let mut second = started(folder.path());
        assert_eq!((seed(&mut again), seed(&mut second)), (5, 6));
    }

    #[test]
    fn a_crash_is_told_and_its_settings_are_restored() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        crashed(folder.path());
        let mut screen = started(folder.path());
        assert!(screen.state_mut().app().is_none(), "nothing is computed before the user has chosen");
        screen.get_by_label("the device is lost");
        screen.get_by_label_contains("src/main.rs:1:1, version 0.1.0");
        // Closed without a choice, it is told again.
        drop(screen);
        let mut screen = started(folder.path());
        screen.get_by_label("Restore").click();
        screen.run_steps(3);
        assert_eq!(seed(&mut screen), 77);
        drop(screen);
        assert!(folder.path().join("last-crash.json").exists());
        let mut screen = started(folder.path());
        assert_eq!(seed(&mut screen), 77, "it is told once");
    }

    #[test]
    fn a_user_may_start_anew_after_a_crash() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        crashed(folder.path());
        let first = {
            let other = tempfile::tempdir().expect("a folder can be made");
            seed(&mut started(other.path()))
        };
        let mut screen = started(folder.path());
        screen.get_by_label("Start anew").click();
        screen.run_steps(3);
        assert_eq!(seed(&mut screen), first);
        drop(screen);
        crashed(folder.path());
        let screen = started(folder.path());
        screen.get_by_label_contains("at the same place before");
    }

    #[test]
    fn a_note_that_cannot_be_read_restores_the_state_that_was_saved() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        crashed(folder.path());
        std::fs::write(folder.path().join("crash.json"), "{").expect("it can be written");
        let mut screen = started(folder.path());
        screen.get_by_label_contains("The note about the crash cannot be read");
        screen.get_by_label("Restore").click();
        screen.run_steps(3);
        assert_eq!(seed(&mut screen), 66);
    }

    #[test]
    fn a_torn_state_is_said_on_screen() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        for seed in [5, 6] {
            let mut screen = started(folder.path());
            set_seed(&mut screen, seed);
        }
        std::fs::write(folder.path().join("state.json"), "{\"kalmanscope_st").expect("it can be written");
        let mut screen = started(folder.path());
        let notice = app(&mut screen).notice().expect("it is said").to_owned();
        assert!(notice.contains("it is damaged") && notice.contains("The copy before it is taken"), "{notice}");
        assert_eq!(seed(&mut screen), 5);
    }

    #[test]
    fn a_missing_place_is_said_and_the_explorer_starts() {
        let folder = tempfile::tempdir().expect("a folder can be made");
        let file = folder.path().join("file");
        std::fs::write(&file, "").expect("it can be written");
        let mut screen = started(&file);
        assert!(app(&mut screen).notice().is_some_and(|notice| notice.starts_with("Nothing of this session is kept")));
    }

    #[test]
    fn the_state_of_an_older_program_is_taken_over_once() {
        #[derive(Default)]
        struct Older(std::collections::BTreeMap<String, String>);
        impl Storage for Older {
            fn get_string(&self, key: &str) -> Option<String> {
                self.0.get(key).cloned()
            }
            fn set_string(&mut self, key: &str, value: String) {
                self.0.insert(key.to_owned(), value);
            }
            fn remove_string(&mut self, key: &str) {
                self.0.remove(key);
            }
            fn flush(&mut self) {}
        }
        let folder = tempfile::tempdir().expect("a folder can be made");
        let mut older = Older::default();
        let scenario = Scenario { seed: 9, ..Scenario::default() };
        eframe::App::save(&mut App::with_scenario(scenario).expect("it can be run"), &mut older);
        older.set_string("window", "its place".to_owned());
        let slot = Slot::take(folder.path()).expect("there is a place");
        let memory = Memory::new(slot, Some(&older));
        let app = memory.start(&Context::default(), Box::new(App::stored)).expect("it can be run");
        assert_eq!((app.session().scenario().seed, app.notice()), (9, None));
        let mut desktop = Desktop { stage: Stage::Running(Box::new(app)), memory: Some(memory) };
        eframe::App::save(&mut desktop, &mut older);
        assert_eq!(older.0.keys().collect::<Vec<_>>(), ["window"]);
    }
}
