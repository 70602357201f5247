//! What the app does when it is asked to.

use super::{App, LARGE};
use crate::command::Command;
use crate::controls::number;
use crate::tutor::Tutor;
use crate::views::{Layout, Shown, TimeAxis};

impl App {
    /// Carries out what a view, a menu or a key has asked for.
    pub(super) fn apply(&mut self, command: Command, ctx: &egui::Context) {
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
                *shown = Shown::default();
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
                } else if let Some(lesson) = tutor {
                    // The record may be longer now.
                    axis.framed = lesson.frame(session);
                }
            }
            Command::LeaveLesson => {
                *tutor = None;
                axis.framed = None;
                *shown = Shown::default();
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
        let Self { session, axis, shown, layout, tutor, .. } = self;
        let Some(lesson) = tutor else { return };
        if lesson.go_to(step, session).is_err() {
            *tutor = None;
            return;
        }
        *axis = TimeAxis { framed: lesson.frame(session), ..TimeAxis::default() };
        lesson.choose(shown);
        let views = lesson.views();
        if !views.is_empty() {
            *layout = Layout::column(&views);
        }
    }
}
