//! The state that outlasts the program, and the explorer that begins with it.

use egui::{Context, ThemePreference};
use kalmanscope_core::{RunError, Scenario};
use kalmanscope_lessons::BuiltIn;

use super::{App, LARGE};
use crate::saved::{Found, Saved};
use crate::session::Budget;
use crate::share::Outline;
use crate::theme;
use crate::visibility::Visibility;

impl App {
    /// The explorer in the state that a storage holds, or playing the default scenario.
    ///
    /// # Errors
    /// [`RunError`] where even the default scenario cannot be run.
    pub fn stored(ctx: &Context, storage: Option<&dyn eframe::Storage>) -> Result<Self, RunError> {
        let found = Self::dress(ctx, storage);
        if found.saved.presenting {
            ctx.set_zoom_factor(LARGE);
            theme::enlarge_readouts(ctx, true);
        }
        Self::from_found(found, Budget::FRAME)
    }

    /// Sets fonts, styles and the theme that a storage holds, before anything is computed.
    pub fn set_theme(ctx: &Context, storage: Option<&dyn eframe::Storage>) {
        Self::dress(ctx, storage);
    }

    fn dress(ctx: &Context, storage: Option<&dyn eframe::Storage>) -> Found {
        theme::install(ctx);
        let found = Saved::load(storage);
        found.saved.apply_theme(ctx);
        found
    }

    /// The explorer in the state that [`eframe::App::save`] left in `storage`, without fonts and styles. A part that
    /// cannot be read gets its default; a message says so, and the next save keeps the text.
    ///
    /// # Errors
    /// [`RunError`] where even the default scenario cannot be run.
    pub fn restored(storage: Option<&dyn eframe::Storage>) -> Result<Self, RunError> {
        Self::from_found(Saved::load(storage), Budget::Unlimited)
    }

    pub(super) fn from_found(Found { saved, new_here, problem }: Found, budget: Budget) -> Result<Self, RunError> {
        let layout = saved.layout();
        let mut app = Self::with_any(saved.scenario)?;
        // The first frame is drawn before any long computation.
        app.session.set_budget(budget);
        app.session.set_mode(saved.mode);
        app.session.set_speed(saved.speed);
        app.presenting = saved.presenting;
        app.layout = layout;
        app.ruler = saved.ruler;
        app.visible = Visibility::without(&saved.hidden);
        app.laboratory.restore(saved.laboratory);
        app.inviting = new_here;
        app.all_settings = saved.all_settings;
        app.resume(saved.studies);
        app.unreadable = saved.unreadable;
        if let Some(reason) = problem {
            app.report(&format!("The last session could not be restored in full, but its text is kept: {reason}."));
        }
        Ok(app)
    }

    /// The state that outlasts the program.
    pub fn saved(&self) -> Saved {
        let Self { session, layout, laboratory, presenting, theme, ruler, visible, all_settings, unreadable, .. } =
            self;
        Saved {
            scenario: session.scenario().clone(),
            mode: session.mode(),
            speed: session.speed(),
            presenting: *presenting,
            dark: match theme {
                ThemePreference::Dark => Some(true),
                ThemePreference::Light => Some(false),
                ThemePreference::System => None,
            },
            views: Outline::of(layout.tree()),
            enlarged: layout.enlarged(),
            ruler: ruler.in_nanoseconds(),
            hidden: visible.hidden(),
            all_settings: *all_settings,
            laboratory: laboratory.choices(),
            studies: self.studies(),
            unreadable: unreadable.clone(),
        }
    }

    /// The explorer at the start of a scenario. If the scenario needs a measured record, the first built-in scenario
    /// stays on screen until the user drops the record's file.
    fn with_any(scenario: Scenario) -> Result<Self, RunError> {
        if scenario.record.is_none() {
            return Self::with_scenario(scenario);
        }
        let mut app = Self::with_scenario(BuiltIn::FIRST.scenario().unwrap_or_default())?;
        app.session.set_scenario(scenario);
        Ok(app)
    }
}
