//! The picture that outlasts the program, and the explorer that begins with it.

use eframe::Storage;
use egui::{Context, ThemePreference};
use kalmanscope_core::RunError;

use super::{App, LARGE};
use crate::session::Budget;
use crate::share::{Habits, PictureError, SavedPicture};
use crate::theme::{self, Palette};
use crate::visibility::Visibility;

pub const KEY: &str = "kalmanscope";

/// The storage key of the last text under [`KEY`] that could not be read; the next save would overwrite it.
pub const UNREADABLE_KEY: &str = "kalmanscope-unreadable";

/// The picture of the last use, if there was one, or the sentence why it cannot be opened.
pub type LastPicture = Result<Option<SavedPicture>, String>;

impl App {
    pub fn stored(ctx: &Context, storage: Option<&dyn Storage>) -> Result<Self, RunError> {
        let (last, unreadable) = read(storage);
        Ok(Self { unreadable, ..Self::resumed(ctx, last)? })
    }

    pub fn resumed(ctx: &Context, last: LastPicture) -> Result<Self, RunError> {
        theme::install(ctx);
        let is_first = matches!(last, Ok(None));
        let (picture, problem) = match last {
            Ok(picture) => (picture.unwrap_or_default(), None),
            Err(problem) => (SavedPicture::default(), Some(problem)),
        };
        let layout = picture.layout();
        let SavedPicture { scenario, laboratory, mode, speed, ruler, hidden, habits, .. } = picture;
        let mut app = Self::with_scenario(scenario)?;
        // The first frame is drawn before any long computation.
        app.session.set_budget(Budget::FRAME);
        app.session.set_mode(mode);
        app.session.set_speed(speed);
        app.layout = layout;
        app.ruler = ruler;
        app.visible = Visibility::without(&hidden);
        app.laboratory.restore(laboratory);
        app.inviting = is_first;
        app.take_up(habits.unwrap_or_default(), ctx);
        if let Some(problem) = problem {
            app.report(&problem);
        }
        Ok(app)
    }

    /// The explorer for the frame of another page: plots and transport, and no saved session, neither read nor written.
    pub fn embedded(creation: &eframe::CreationContext<'_>) -> Result<Self, RunError> {
        let app = Self::resumed(&creation.egui_ctx, Ok(None))?;
        Ok(Self { embedded: true, inviting: false, ..app })
    }

    pub(super) fn take_up(&mut self, habits: Habits, ctx: &Context) {
        let Habits { presenting, dark, all_settings, lessons } = habits;
        if let Some(dark) = dark {
            ctx.set_theme(if dark { ThemePreference::Dark } else { ThemePreference::Light });
        }
        if presenting != self.presenting {
            ctx.set_zoom_factor(if presenting { LARGE * self.usual_zoom } else { self.usual_zoom });
        }
        self.presenting = presenting;
        self.all_settings = all_settings;
        self.resume(lessons);
    }

    pub fn last_picture(&self) -> SavedPicture {
        let habits = Habits {
            presenting: self.presenting,
            dark: match self.theme {
                ThemePreference::Dark => Some(true),
                ThemePreference::Light => Some(false),
                ThemePreference::System => None,
            },
            all_settings: self.all_settings,
            lessons: self.studies(),
        };
        let palette = Palette::of(egui::Theme::Light);
        let picture = self.figure_context(&palette).picture(&self.layout);
        SavedPicture { time: 0.0, habits: Some(habits), ..picture }
    }

    pub(super) fn store(&mut self, storage: &mut dyn Storage) -> Result<(), PictureError> {
        if let Some(text) = self.unreadable.take() {
            storage.set_string(UNREADABLE_KEY, text);
        }
        storage.set_string(KEY, self.last_picture().line()?);
        Ok(())
    }
}

fn read(storage: Option<&dyn Storage>) -> (LastPicture, Option<String>) {
    let Some(text) = storage.and_then(|storage| storage.get_string(KEY)) else { return (Ok(None), None) };
    match SavedPicture::of_text(&text) {
        Ok(picture) => (Ok(Some(picture)), None),
        Err(reason) => {
            let sentence = format!(
                "The last session cannot be opened: {reason}. Its text is kept in this browser's store as “{UNREADABLE_KEY}”."
            );
            (Err(sentence), Some(text))
        }
    }
}
