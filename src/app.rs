//! The app: one session, its controls and its views.

use egui::util::undoer::Undoer;
use egui::{CentralPanel, Color32, Frame, Margin, Panel, Ui};
use kalmanscope_core::{RunError, Scenario};
use kalmanscope_lessons::Lesson;
use serde::{Deserialize, Serialize};

use crate::bar::Bar;
use crate::command::Command;
use crate::controls::{controls_ui, number};
use crate::keys;
use crate::session::{Mode, Session};
use crate::summary::Summary;
use crate::theme::{self, Palette};
use crate::tutor::{self, Tutor};
use crate::views::{Layout, Shown, TimeAxis, ViewContext, ViewKind, legend};

/// Below this width the settings are a drawer under the plots \[points\].
const NARROW: f32 = 720.0;

/// How much larger everything is in presenter mode.
const LARGE: f32 = 1.4;

/// What survives a restart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Settings {
    /// As a scenario file, which is checked when it is read.
    scenario: String,
    mode: Mode,
    speed: f64,
    presenting: bool,
}

impl Default for Settings {
    fn default() -> Self {
        Self { scenario: String::new(), mode: Mode::default(), speed: Session::DEFAULT_SPEED, presenting: false }
    }
}

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
    /// Whether the window was narrow in the last frame.
    narrow: bool,
    /// Whether the window is cleared in the panels' colour, so that no panel need fill itself.
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
        theme::install(&creation.egui_ctx);
        Self::restored(creation.storage)
    }

    /// The explorer as [`eframe::App::save`] left it in `storage`, without fonts and styles. What cannot be read or run any
    /// more is the default.
    ///
    /// # Errors
    /// [`RunError`] where not even the default scenario can be run.
    pub fn restored(storage: Option<&dyn eframe::Storage>) -> Result<Self, RunError> {
        let stored = storage.and_then(|storage| eframe::get_value(storage, eframe::APP_KEY));
        let inviting = stored.is_none();
        let Settings { scenario, mode, speed, presenting } = stored.unwrap_or_default();
        let mut app = Self::with_scenario(Scenario::from_toml(&scenario).unwrap_or_default())?;
        app.session.set_mode(mode);
        app.session.set_speed(speed);
        app.presenting = presenting;
        app.inviting = inviting;
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
            narrow: false,
            cleared: false,
            inviting: false,
            commands: Vec::new(),
        })
    }

    /// Relies on the window being cleared in [`eframe::App::clear_color`]: where no graphics card draws, filling it once more
    /// takes as long as all that is drawn upon it.
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

    fn apply(&mut self, command: Command, ctx: &egui::Context) {
        let Self { session, axis, shown, layout, lessons, tutor, history, .. } = self;
        match command {
            Command::TogglePlay => session.toggle_play(),
            Command::Step => session.step(),
            Command::StepBack => session.step_back(),
            Command::Restart => {
                session.seek(0.0);
                *axis = TimeAxis::default();
            }
            Command::Seek(time) => session.seek(time),
            Command::SetMode(mode) => {
                session.set_mode(mode);
                *axis = TimeAxis::default();
            }
            Command::SetSpeed(speed) => session.set_speed(speed),
            Command::Open(entry) => {
                if let Ok(scenario) = entry.scenario() {
                    session.set_scenario(scenario);
                    session.play_from_start();
                    *axis = TimeAxis::default();
                    number::begin_anew(ctx);
                }
            }
            Command::Undo => {
                if let Some(scenario) = history.undo(session.scenario()).cloned() {
                    session.set_scenario(scenario);
                }
            }
            Command::Redo => {
                if let Some(scenario) = history.redo(session.scenario()).cloned() {
                    session.set_scenario(scenario);
                }
            }
            Command::StartLesson(place) => {
                self.inviting = false;
                *tutor = lessons.get(place).cloned().map(Tutor::new);
                self.go_to_step(0);
                number::begin_anew(ctx);
            }
            Command::GoToStep(step) => {
                self.go_to_step(step);
                number::begin_anew(ctx);
            }
            Command::ChangeLesson => {
                if let Some(lesson) = tutor
                    && lesson.change(session).is_err()
                {
                    // What the change is about is gone: begin the step again as it should be.
                    let step = lesson.step();
                    self.go_to_step(step);
                }
            }
            Command::LeaveLesson => {
                *tutor = None;
                axis.framed = None;
            }
            Command::ToggleFilter(place) => shown.toggle_filter(place),
            Command::ToggleControls => self.controls_open = Some(!self.controls_open()),
            Command::TogglePresenter => {
                self.presenting = !self.presenting;
                ctx.set_zoom_factor(ctx.zoom_factor() * if self.presenting { LARGE } else { 1.0 / LARGE });
                self.controls_open = None;
            }
            Command::ToggleKeys => self.keys_open = !self.keys_open,
            Command::Leave => {
                if !std::mem::take(&mut self.keys_open) {
                    layout.leave_enlarged();
                }
            }
            Command::ToggleView(view) => layout.toggle(view),
            Command::Arrange(arrangement) => *layout = Layout::of(arrangement),
            // The first time back to what is of interest, then to all.
            Command::Follow if axis.follows => axis.framed = None,
            Command::Follow => axis.follows = true,
            Command::Unfollow => axis.follows = false,
            Command::PointAt(time) => axis.pointed = time,
        }
    }

    /// Goes to a step of the lesson in progress; without one, or to one that cannot be taken, nowhere.
    fn go_to_step(&mut self, step: usize) {
        let Self { session, axis, layout, tutor, .. } = self;
        let Some(lesson) = tutor else { return };
        if lesson.go_to(step, session).is_err() {
            *tutor = None;
            return;
        }
        *axis = TimeAxis { framed: lesson.frame(session), ..TimeAxis::default() };
        let views = lesson.views();
        if !views.is_empty() {
            *layout = Layout::column(&views);
        }
    }

    fn controls_open(&self) -> bool {
        self.controls_open.unwrap_or(!self.narrow && !self.presenting)
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
        self.session.want_bounds(self.layout.shown().contains(&ViewKind::Errors));
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
        let narrow = ui.available_width() < NARROW;
        self.narrow = narrow;
        let open = self.controls_open();
        let ground = if self.cleared { Color32::TRANSPARENT } else { palette.panel };
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
        let settings = Settings {
            scenario: self.session.scenario().to_toml().unwrap_or_default(),
            mode: self.session.mode(),
            speed: self.session.speed(),
            presenting: self.presenting,
        };
        eframe::set_value(storage, eframe::APP_KEY, &settings);
    }
}
