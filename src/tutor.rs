//! The panel of a lesson: something to look at, a button that changes it, what happens, why.

use std::sync::LazyLock;

use egui::{Button, RichText, ScrollArea, Sense, TextWrapMode, Ui};
use kalmanscope_lessons::{Lesson, LessonError, Presentation, Step, ViewName};

use crate::probe;
use crate::request::{Request, ViewKind};
use crate::session::{Mode, Session};
use crate::theme::{self, Palette};
use crate::visibility::Visibility;

/// A lesson in progress.
pub struct Tutor {
    lesson: Lesson,
    step: usize,
    changed: bool,
}

impl Tutor {
    /// The beginning of a lesson.
    pub fn new(lesson: Lesson) -> Self {
        Self { lesson, step: 0, changed: false }
    }

    /// The number of the step, from 0 on.
    pub fn step(&self) -> usize {
        self.step
    }

    fn current(&self) -> Option<&Step> {
        self.lesson.steps.get(self.step)
    }

    /// The views of the step, the most important first.
    pub fn views(&self) -> Vec<ViewKind> {
        self.current().map_or(vec![], |step| step.views.iter().map(|view| kind(*view)).collect())
    }

    /// Shows the channels and bands of the step.
    pub fn choose(&self, visible: &mut Visibility) {
        if let Some(step) = self.current() {
            visible.only.clone_from(&step.channels);
            visible.bands = step.bands;
        }
    }

    /// The part of the record that the step is about; `None` for all of it \[s\].
    pub fn frame(&self, session: &Session) -> Option<(f64, f64)> {
        let step = self.current().filter(|step| step.mode != Presentation::Live)?;
        let (from, to) = (step.from.unwrap_or(0.0), step.to.unwrap_or(session.end()).min(session.end()));
        ((step.from.is_some() || step.to.is_some()) && from < to).then_some((from, to))
    }

    /// Goes to a step, with the changes of the steps before it, and shows its record.
    ///
    /// # Errors
    /// [`LessonError`] where a change is impossible, which a test rules out for built-in lessons.
    pub fn go_to(&mut self, step: usize, session: &mut Session) -> Result<(), LessonError> {
        self.step = step.min(self.lesson.steps.len().saturating_sub(1));
        self.changed = false;
        let scenario = match self.step.checked_sub(1) {
            Some(before) => self.lesson.scenario_at(before)?,
            None => self.lesson.first_scenario()?,
        };
        session.set_scenario(scenario);
        self.show(session);
        Ok(())
    }

    /// Makes the change of the step.
    ///
    /// # Errors
    /// [`LessonError`] where the scenario no longer has the target of the change.
    pub fn change(&mut self, session: &mut Session) -> Result<(), LessonError> {
        if let Some(change) = self.current().and_then(|step| step.change.as_ref()) {
            session.edit(change.adjustment.apply(session.scenario())?);
            self.changed = true;
            self.show(session);
        }
        Ok(())
    }

    fn show(&self, session: &mut Session) {
        let Some(step) = self.current() else { return };
        match step.mode {
            Presentation::Whole => {
                session.set_mode(Mode::Whole);
                session.pause();
                session.seek(step.to.unwrap_or_else(|| session.end()));
            }
            Presentation::Live => {
                session.set_mode(Mode::Live);
                session.play_from_start();
                session.seek(step.from.unwrap_or(0.0));
            }
            Presentation::Step => {
                session.set_mode(Mode::Live);
                session.pause();
                session.seek(step.from.unwrap_or(0.0));
            }
        }
    }

    /// The panel's contents.
    pub fn ui(&self, ui: &mut Ui, palette: &Palette, requests: &mut Vec<Request>) {
        let Self { lesson, step, changed } = self;
        ui.with_layout(egui::Layout::right_to_left(egui::Align::Min), |ui| {
            let close = ui.add(Button::new("×").frame(false)).on_hover_text("Leave the lesson");
            close.ctx.accesskit_node_builder(close.id, |node| node.set_label("Leave the lesson"));
            if close.clicked() {
                requests.push(Request::LeaveLesson);
            }
            ui.with_layout(egui::Layout::top_down(egui::Align::Min), |ui| {
                ui.label(RichText::new(&lesson.title).family(theme::strong()).size(15.0));
            });
        });
        let Some(current) = self.current() else { return };
        ScrollArea::vertical().max_height((ui.available_height() - 40.0).max(40.0)).show(ui, |ui| {
            ui.set_width(ui.available_width() - ui.spacing().scroll.bar_width);
            if *step == 0 {
                ui.weak(&lesson.summary);
                ui.add_space(6.0);
            }
            part_ui(ui, "Look", &current.look);
            if let Some(change) = &current.change {
                let button = if *changed {
                    // Done: the button remains as text.
                    Button::new(RichText::new(&change.label).weak()).frame(false).sense(Sense::hover())
                } else {
                    Button::new(RichText::new(&change.label).color(palette.on_accent)).fill(palette.accent)
                };
                let button = ui.add(button.wrap());
                probe::remember(ui.ctx(), "Change", button.rect);
                if button.clicked() {
                    requests.push(Request::ChangeLesson);
                }
                ui.add_space(6.0);
            }
            if *changed || current.change.is_none() {
                part_ui(ui, "What happens", &current.happens);
                part_ui(ui, "Why", &current.why);
            }
        });
        ui.horizontal(|ui| {
            if ui.add_enabled(*step > 0, Button::new("Back")).clicked() {
                requests.push(Request::GoToStep(step - 1));
            }
            ui.weak(format!("{} of {}", step + 1, lesson.steps.len()));
            let ready = *changed || current.change.is_none();
            if step + 1 < lesson.steps.len() {
                let next = ui.add_enabled(ready, Button::new("Next"));
                probe::remember(ui.ctx(), "Next", next.rect);
                if next.clicked() {
                    requests.push(Request::GoToStep(step + 1));
                }
            } else {
                let done = ui.add_enabled(ready, Button::new("Done"));
                probe::remember(ui.ctx(), "Done", done.rect);
                if done.clicked() {
                    requests.push(Request::LeaveLesson);
                }
            }
        });
        // The panel is as high as its contents.
        ui.allocate_space(ui.available_size());
    }
}

fn part_ui(ui: &mut Ui, heading: &str, text: &str) {
    ui.label(RichText::new(heading).small().weak());
    ui.label(text);
    ui.add_space(6.0);
}

/// The kind of view that a lesson names.
fn kind(view: ViewName) -> ViewKind {
    match view {
        ViewName::States => ViewKind::States,
        ViewName::Parameters => ViewKind::Parameters,
        ViewName::Errors => ViewKind::Errors,
        ViewName::Innovations => ViewKind::Innovations,
        ViewName::NisNees => ViewKind::Consistency,
        ViewName::Autocorrelation => ViewKind::Autocorrelation,
        ViewName::Gain => ViewKind::Gain,
        ViewName::Phase => ViewKind::Phase,
        ViewName::ParameterPlane => ViewKind::ParameterPlane,
        ViewName::Matrices => ViewKind::Matrices,
        ViewName::Oscillator => ViewKind::Oscillator,
        ViewName::FrequencyResponse => ViewKind::FrequencyResponse,
    }
}

/// An invitation to the first lesson, for new users.
pub(crate) fn invitation_ui(ui: &mut Ui, requests: &mut Vec<Request>) {
    let text = RichText::new("New here? Begin with the first lesson").color(ui.visuals().hyperlink_color);
    let link = ui.add(Button::new(text).frame(false).wrap_mode(TextWrapMode::Extend));
    probe::remember(ui.ctx(), "First lesson", link.rect);
    if link.clicked() {
        requests.push(Request::StartLesson(0));
    }
}

/// The menu of all lessons, by group.
pub fn menu_ui(ui: &mut Ui, lessons: &LazyLock<Vec<Lesson>>, requests: &mut Vec<Request>) {
    let menu = ui.menu_button("Lessons", |ui| {
        // As high as the window allows.
        let height = (ui.ctx().content_rect().height() - 70.0).max(100.0);
        ScrollArea::vertical().max_height(height).min_scrolled_height(height).show(ui, |ui| {
            let mut group = "";
            for (place, lesson) in lessons.iter().enumerate() {
                if lesson.group != group {
                    group = &lesson.group;
                    ui.label(RichText::new(group).small().weak());
                }
                let button = ui.button(&lesson.title).on_hover_text(&lesson.summary);
                probe::remember(ui.ctx(), &lesson.title, button.rect);
                if button.clicked() {
                    requests.push(Request::StartLesson(place));
                    ui.close();
                }
            }
        });
    });
    probe::remember(ui.ctx(), "Lessons", menu.response.rect);
}
