//! The app: one session, its controls and its views.

use egui::util::undoer::Undoer;
use egui::{CentralPanel, Frame, Margin, Panel, RichText, Ui};
use kalmanscope_core::{RunError, Scenario};
use kalmanscope_lessons::Lesson;
use serde::{Deserialize, Serialize};

use crate::command::Command;
use crate::controls::controls_ui;
use crate::library;
use crate::session::{Mode, Session};
use crate::summary::Summary;
use crate::theme::{self, Palette};
use crate::transport;
use crate::tutor::{self, Tutor};
use crate::views::{Arrangement, Layout, Shown, TimeAxis, ViewContext, ViewKind, legend};

/// Below this width the controls and the plots take turns \[points\].
const NARROW: f32 = 720.0;

/// What survives a restart.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
struct Settings {
    /// As a scenario file, which is checked when it is read.
    scenario: String,
    mode: Mode,
    speed: f64,
}

impl Default for Settings {
    fn default() -> Self {
        Self { scenario: String::new(), mode: Mode::default(), speed: Session::DEFAULT_SPEED }
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
    controls_open: Option<bool>,
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
        let Settings { scenario, mode, speed } =
            storage.and_then(|storage| eframe::get_value(storage, eframe::APP_KEY)).unwrap_or_default();
        let mut app = Self::with_scenario(Scenario::from_toml(&scenario).unwrap_or_default())?;
        app.session.set_mode(mode);
        app.session.set_speed(speed);
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
            commands: Vec::new(),
        })
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

    fn apply(&mut self, command: Command) {
        let Self { session, axis, layout, lessons, tutor, history, .. } = self;
        match command {
            Command::TogglePlay => session.toggle_play(),
            Command::Step => session.step(),
            Command::Restart => {
                session.seek(0.0);
                axis.follows = true;
            }
            Command::Seek(time) => session.seek(time),
            Command::SetMode(mode) => {
                session.set_mode(mode);
                axis.follows = true;
            }
            Command::SetSpeed(speed) => session.set_speed(speed),
            Command::Open(entry) => {
                if let Ok(scenario) = entry.scenario() {
                    session.set_scenario(scenario);
                    session.play_from_start();
                    axis.follows = true;
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
                *tutor = lessons.get(place).cloned().map(Tutor::new);
                self.go_to_step(0);
            }
            Command::GoToStep(step) => self.go_to_step(step),
            Command::ChangeLesson => {
                if let Some(lesson) = tutor
                    && lesson.change(session).is_err()
                {
                    // What the change is about is gone: begin the step again as it should be.
                    let step = lesson.step();
                    self.go_to_step(step);
                }
            }
            Command::LeaveLesson => *tutor = None,
            Command::ToggleView(view) => layout.toggle(view),
            Command::Arrange(arrangement) => *layout = Layout::of(arrangement),
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
        axis.follows = true;
        let views = lesson.views();
        if !views.is_empty() {
            *layout = Layout::column(&views);
        }
    }

    fn top_bar_ui(&mut self, ui: &mut Ui, narrow: bool) {
        let Self { session, controls_open, commands, layout, lessons, .. } = self;
        ui.horizontal_wrapped(|ui| {
            let open = controls_open.unwrap_or(!narrow);
            let toggle = ui.selectable_label(open, RichText::new("☰").size(16.0)).on_hover_text("Show the settings");
            toggle.ctx.accesskit_node_builder(toggle.id, |node| node.set_label("Settings"));
            if toggle.clicked() {
                *controls_open = Some(!open);
            }
            if !narrow {
                ui.label(RichText::new("Kalmanscope").family(theme::strong()).size(17.0));
            }
            scenario_menu_ui(ui, session, commands);
            views_menu_ui(ui, layout, commands);
            tutor::menu_ui(ui, lessons, commands);
            theme_ui(ui);
            ui.separator();
            transport::transport_ui(ui, session, narrow, commands);
        });
    }

    fn centre_ui(&mut self, ui: &mut Ui, palette: &Palette, narrow: bool) {
        let Self { session, axis, shown, layout, commands, .. } = self;
        legend::legend_ui(ui, session, shown, palette);
        layout.ui(ui, &ViewContext { session, palette, shown, axis }, commands, narrow);
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        transport::keys(ctx, &mut self.commands);
        for command in std::mem::take(&mut self.commands) {
            self.apply(command);
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
        let palette = Palette::of(ui.ctx().theme());
        let narrow = ui.available_width() < NARROW;
        let bar = Frame::new().fill(palette.panel).inner_margin(Margin::symmetric(10, 6));
        Panel::top("transport").frame(bar).show(ui, |ui| self.top_bar_ui(ui, narrow));

        let open = self.controls_open.unwrap_or(!narrow);
        let frame = Frame::new().fill(palette.panel).inner_margin(Margin::symmetric(10, 6));
        let mut edited = None;
        let mut controls = |ui: &mut Ui, session: &Session| {
            let mut scenario = session.scenario().clone();
            if controls_ui(ui, &mut scenario, &palette) {
                edited = Some(scenario);
            }
        };
        if open && !narrow {
            let panel = Panel::left("controls").frame(frame).default_size(340.0).size_range(300.0..=460.0);
            panel.show(ui, |ui| controls(ui, &self.session));
        }
        if let Some(tutor) = &self.tutor {
            let commands = &mut self.commands;
            if narrow {
                let panel = Panel::bottom("lesson").frame(frame).default_size(260.0);
                panel.show(ui, |ui| tutor.ui(ui, &palette, commands));
            } else {
                let panel = Panel::right("lesson").frame(frame).default_size(290.0).size_range(240.0..=420.0);
                panel.show(ui, |ui| tutor.ui(ui, &palette, commands));
            }
        }
        CentralPanel::default().frame(frame).show(ui, |ui| {
            if open && narrow {
                controls(ui, &self.session);
            } else {
                self.centre_ui(ui, &palette, narrow);
            }
        });
        if let Some(scenario) = edited {
            self.session.set_scenario(scenario);
        }
        if !self.commands.is_empty() {
            ui.ctx().request_repaint();
        }
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        let settings = Settings {
            scenario: self.session.scenario().to_toml().unwrap_or_default(),
            mode: self.session.mode(),
            speed: self.session.speed(),
        };
        eframe::set_value(storage, eframe::APP_KEY, &settings);
    }
}

fn scenario_menu_ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    ui.menu_button("Scenario", |ui| {
        for entry in library::ENTRIES {
            if ui.button(entry.name).on_hover_text(entry.description()).clicked() {
                commands.push(Command::Open(entry));
                ui.close();
            }
        }
        ui.separator();
        if ui.button("Copy as TOML").on_hover_text("For the command line, or to keep").clicked() {
            if let Ok(toml) = session.scenario().to_toml() {
                ui.ctx().copy_text(toml);
            }
            ui.close();
        }
    });
}

fn views_menu_ui(ui: &mut Ui, layout: &Layout, commands: &mut Vec<Command>) {
    ui.menu_button("Views", |ui| {
        for arrangement in Arrangement::ALL {
            if ui.button(arrangement.name()).clicked() {
                commands.push(Command::Arrange(arrangement));
                ui.close();
            }
        }
        ui.separator();
        let shown = layout.shown();
        for view in ViewKind::ALL {
            let mut on = shown.contains(&view);
            if ui.checkbox(&mut on, view.view().name()).changed() {
                commands.push(Command::ToggleView(view));
            }
        }
    });
}

fn theme_ui(ui: &mut Ui) {
    let dark = ui.ctx().theme() == egui::Theme::Dark;
    let (icon, name) = if dark { ("☀", "Light theme") } else { ("☾", "Dark theme") };
    let button = ui.button(RichText::new(icon).size(15.0)).on_hover_text(name);
    button.ctx.accesskit_node_builder(button.id, |node| node.set_label(name));
    if button.clicked() {
        let next = if dark { egui::Theme::Light } else { egui::Theme::Dark };
        ui.ctx().set_theme(next);
    }
}
