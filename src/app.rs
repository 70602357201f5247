//! The app: one session, its controls and its views.

mod commands;

use egui::util::undoer::Undoer;
use egui::{CentralPanel, Color32, Frame, Margin, Panel, ThemePreference, Ui};
use kalmanscope_core::{RunError, Scenario};
use kalmanscope_lessons::Lesson;

use crate::bar::Bar;
use crate::command::Command;
use crate::controls::controls_ui;
use crate::keys;
use crate::saved::Saved;
use crate::session::{Mode, Session};
use crate::summary::Summary;
use crate::theme::{self, Palette};
use crate::tutor::{self, Tutor};
use crate::views::{Layout, Shown, TimeAxis, ViewContext, legend};

/// Below this width the settings are a drawer under the plots \[points\].
const NARROW: f32 = 720.0;

/// Below this width a lesson has the settings' room, unless someone wants to see them \[points\].
const WIDE: f32 = 1500.0;

/// How much larger everything is in presenter mode.
const LARGE: f32 = 1.4;

/// The explorer.
pub struct App {
    session: Session,
    axis: TimeAxis,
    shown: Shown,
    layout: Layout,
    lessons: Vec<Lesson>,
    tutor: Option<Tutor>,
    history: Undoer<Scenario>,
    /// Whether the settings are shown, once someone has decided about it.
    controls_open: Option<bool>,
    presenting: bool,
    keys_open: bool,
    /// Width of the window in the last frame \[points\], and the theme that was chosen then.
    width: f32,
    theme: ThemePreference,
    /// Whether the window is cleared in the colour of the ground, so that no panel need fill itself.
    cleared: bool,
    /// Whether a newcomer is shown where to begin.
    inviting: bool,
    commands: Vec<Command>,
}

impl App {
    /// The explorer as it was left, or playing the default scenario.
    ///
    /// # Errors
    /// [`RunError`] where not even the default scenario can be run.
    pub fn new(creation: &eframe::CreationContext<'_>) -> Result<Self, RunError> {
        let ctx = &creation.egui_ctx;
        theme::install(ctx);
        let saved = Saved::load(creation.storage);
        saved.apply_theme(ctx);
        if saved.presenting {
            ctx.set_zoom_factor(LARGE);
        }
        Self::from_saved(&saved)
    }

    /// The explorer as [`eframe::App::save`] left it in `storage`, without fonts and styles. What cannot be read or run any
    /// more is the default.
    ///
    /// # Errors
    /// [`RunError`] where not even the default scenario can be run.
    pub fn restored(storage: Option<&dyn eframe::Storage>) -> Result<Self, RunError> {
        Self::from_saved(&Saved::load(storage))
    }

    fn from_saved(saved: &Saved) -> Result<Self, RunError> {
        let mut app = Self::with_scenario(Scenario::from_toml(&saved.scenario).unwrap_or_default())?;
        app.session.set_mode(saved.mode);
        app.session.set_speed(saved.speed);
        app.presenting = saved.presenting;
        app.layout = saved.layout();
        app.inviting = saved.new_here;
        Ok(app)
    }

    /// The explorer at the start of a scenario, without fonts and styles.
    ///
    /// # Errors
    /// [`RunError`] where the scenario is impossible.
    pub fn with_scenario(scenario: Scenario) -> Result<Self, RunError> {
        Ok(Self {
            session: Session::new(scenario)?,
            axis: TimeAxis::default(),
            shown: Shown::default(),
            layout: Layout::default(),
            lessons: kalmanscope_lessons::lessons().into_iter().filter_map(Result::ok).collect(),
            tutor: None,
            history: Undoer::default(),
            controls_open: None,
            presenting: false,
            keys_open: false,
            width: WIDE,
            theme: ThemePreference::System,
            cleared: false,
            inviting: false,
            commands: Vec::new(),
        })
    }

    /// For those who do not want things to move by themselves: begins paused with all of the record on screen, and nothing
    /// glides into place.
    pub fn reduce_motion(&mut self, ctx: &egui::Context) {
        ctx.all_styles_mut(|style| style.animation_time = 0.0);
        self.session.set_mode(Mode::Whole);
        self.session.pause();
        self.session.seek(self.session.end());
    }

    /// Relies on the window being cleared in [`eframe::App::clear_color`], so that no pixel is filled twice with the
    /// ground's colour: that takes its time where no graphics card draws.
    #[must_use]
    pub fn on_cleared_window(self) -> Self {
        Self { cleared: true, ..self }
    }

    /// The session on screen.
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// The session on screen, to be set up by tests.
    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    /// The views on screen, to be set up by tests.
    pub fn layout_mut(&mut self) -> &mut Layout {
        &mut self.layout
    }

    /// The time axis that the plots share.
    pub fn axis(&self) -> &TimeAxis {
        &self.axis
    }

    /// What is on screen, as data.
    pub fn summary(&self, ctx: &egui::Context) -> Summary {
        Summary::new(&self.session, ctx)
    }

    fn controls_open(&self) -> bool {
        let room = if self.tutor.is_some() { WIDE } else { NARROW };
        self.controls_open.unwrap_or(self.width >= room && !self.presenting)
    }

    fn keys_ui(&mut self, ctx: &egui::Context) {
        if self.keys_open {
            let window = egui::Window::new("Keys").collapsible(false).resizable(false).open(&mut self.keys_open);
            window.anchor(egui::Align2::CENTER_CENTER, egui::Vec2::ZERO).show(ctx, keys::list_ui);
        }
    }

    fn centre_ui(&mut self, ui: &mut Ui, palette: &Palette, narrow: bool) {
        let Self { session, axis, shown, layout, commands, inviting, .. } = self;
        legend::legend_ui(ui, session, shown, palette, |ui| {
            if *inviting {
                tutor::invitation_ui(ui, commands);
            }
        });
        layout.ui(ui, &ViewContext::new(session, palette, shown, axis), commands, narrow);
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        keys::keys(ctx, &self.session, &mut self.commands);
        for command in std::mem::take(&mut self.commands) {
            self.apply(command, ctx);
        }
        // What is dragged becomes one step of the history once it has come to rest.
        self.history.feed_state(ctx.input(|input| input.time), self.session.scenario());
        self.session.want(self.layout.wanted());
        // A frame that took long (a hidden tab, a breakpoint) must not swallow the story.
        let elapsed = ctx.input(|input| f64::from(input.stable_dt)).min(0.1);
        self.session.advance(elapsed);
        if self.session.playing() || self.session.behind() {
            ctx.request_repaint();
        }
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        let estimates = self.session.run().estimates();
        let colors = estimates.iter().enumerate().map(|(place, estimates)| estimates.color(place));
        let palette = Palette::of(ui.ctx().theme()).with_filters(colors);
        self.width = ui.available_width();
        let narrow = self.width < NARROW;
        self.theme = ui.ctx().options(|options| options.theme_preference);
        let open = self.controls_open();
        let ground = if self.cleared { Color32::TRANSPARENT } else { palette.ground };
        let frame = Frame::new().fill(ground).inner_margin(Margin::symmetric(10, 6));
        let Self { session, layout, lessons, presenting, commands, .. } = self;
        let bar = Bar { session, layout, lessons, controls: open, presenting: *presenting, narrow };
        Panel::top("transport").frame(frame).show(ui, |ui| bar.ui(ui, commands));

        let mut edited = None;
        if open {
            // A drawer leaves the plots in sight, so that one sees what one does.
            let panel = if narrow {
                Panel::bottom("drawer")
                    .default_size(0.46 * ui.available_height())
                    .size_range(120.0..=600.0)
                    .resizable(true)
            } else {
                Panel::left("controls").default_size(340.0).size_range(300.0..=460.0)
            };
            panel.frame(frame).show(ui, |ui| {
                let mut scenario = self.session.scenario().clone();
                if controls_ui(ui, &mut scenario, &palette) {
                    edited = Some(scenario);
                }
            });
        }
        if let Some(tutor) = self.tutor.as_ref().filter(|_| !(open && narrow)) {
            let commands = &mut self.commands;
            let panel = if narrow {
                Panel::bottom("lesson").default_size(260.0)
            } else {
                Panel::right("lesson").default_size(290.0).size_range(240.0..=420.0)
            };
            panel.frame(frame).show(ui, |ui| tutor.ui(ui, &palette, commands));
        }
        CentralPanel::default().frame(frame).show(ui, |ui| self.centre_ui(ui, &palette, narrow));
        self.keys_ui(ui.ctx());
        if let Some(scenario) = edited {
            self.session.set_scenario(scenario);
        }
        if !self.commands.is_empty() {
            ui.ctx().request_repaint();
        }
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        let Self { session, layout, presenting, theme, .. } = self;
        Saved::new(session, layout, *presenting, *theme).save(storage);
    }
}
