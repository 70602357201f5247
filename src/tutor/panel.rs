//! The panel of a lesson.

use egui::{Align, Button, EventFilter, Frame, Id, Label, Layout, Panel, RadioButton, RichText, ScrollArea, Sense, Ui};
use kalmanscope_lessons::{Adjustment, Question};

use super::{Catalogue, Tutor};
use crate::drawer::close_ui;
use crate::probe::Remembered as _;
use crate::request::{Answer, Request};
use crate::theme;
use crate::theme::Palette;
use crate::widgets::{named, primary};

/// The text of the step. It has the keyboard's focus when a step begins, so that Tab goes to its first control.
pub(crate) fn text_id() -> Id {
    Id::unique("text of the lesson's step")
}

impl Tutor {
    pub(crate) fn ui(&self, ui: &mut Ui, catalogue: &Catalogue, palette: &Palette, requests: &mut Vec<Request>) {
        // The buttons stay on screen while the text is scrolled.
        Panel::bottom("steps").frame(Frame::new()).show_separator_line(false).show(ui, |ui| {
            self.steps_ui(ui, catalogue, palette, requests);
        });
        // Each step has its own place of scrolling, and so begins at its top.
        ScrollArea::vertical().id_salt((&self.lesson.title, self.step)).auto_shrink(false).show(ui, |ui| {
            ui.set_width(ui.available_width() - ui.spacing().scroll.bar_width);
            self.text_ui(ui, palette, requests);
        });
    }

    /// The title, and the button that leaves the lesson. If they are centred, there is room for one line only.
    pub(crate) fn title_ui(&self, ui: &mut Ui, align: Align, requests: &mut Vec<Request>) {
        let is_one_line = align == Align::Center;
        ui.with_layout(Layout::right_to_left(align), |ui| {
            if close_ui(ui, "Leave the lesson") {
                requests.push(Request::LeaveLesson);
            }
            let layout = if is_one_line { Layout::left_to_right(align) } else { Layout::top_down(align) };
            ui.with_layout(layout, |ui| {
                let title = RichText::new(&self.lesson.title).family(theme::strong()).size(15.0);
                // A drag of the title is one of the drawer.
                let title = Label::new(title).selectable(false);
                ui.add(if is_one_line { title.truncate() } else { title });
            });
        });
    }

    fn text_ui(&self, ui: &mut Ui, palette: &Palette, requests: &mut Vec<Request>) {
        let Self { lesson, place: _, step, changed, answer, lit: _ } = self;
        let Some(current) = self.current() else { return };
        let look = ui.scope(|ui| part_ui(ui, "Look", &current.look)).response;
        let revealed = self.is_revealed();
        let (opened, grown) = self.news(ui);
        let text = ui.interact(look.rect, text_id(), Sense::focusable_noninteractive());
        let text = named(text, format!("{}, step {} of {}", lesson.title, step + 1, lesson.steps.len()));
        if opened {
            text.request_focus();
        }
        if text.has_focus() {
            // Arrows and Esc are those of the record and the views, as without a focus.
            let filter =
                EventFilter { horizontal_arrows: true, vertical_arrows: true, escape: true, ..EventFilter::default() };
            ui.memory_mut(|memory| memory.set_focus_lock_filter(text_id(), filter));
        }
        if let Some(question) = &current.question {
            let question = ui.scope(|ui| question_ui(ui, question, *answer, revealed, requests)).response;
            if opened && self.open_question().is_some() {
                // On a phone the choices may be below the visible part.
                ui.scroll_to_rect(question.rect, None);
            }
        }
        if let Some(change) = current.change.as_ref().filter(|_| self.open_question().is_none()) {
            change_ui(ui, change, *changed, palette, requests);
        }
        if grown {
            ui.scroll_to_cursor(Some(Align::Center));
        }
        if revealed {
            part_ui(ui, "What happens", &current.happens);
            if let (Some(question), Some(answer)) = (&current.question, *answer) {
                feedback_ui(ui, question, answer);
            }
            part_ui(ui, "Why", &current.why);
        }
    }

    fn news(&self, ui: &Ui) -> (bool, bool) {
        let state = (self.step, self.open_question().is_some(), self.is_revealed());
        let id = Id::unique(("state of the lesson's step", &self.lesson.title));
        let frame = ui.ctx().cumulative_frame_nr();
        let before = ui.data_mut(|data| {
            let before: Option<((usize, bool, bool), u64)> = data.get_temp(id);
            data.insert_temp(id, (state, frame));
            // Where it was not on screen in the frame before, it opens again.
            before.filter(|(_, last)| last + 1 >= frame).map(|(state, _)| state)
        });
        let opened = before.is_none_or(|(step, ..)| step != state.0);
        (opened, !opened && before != Some(state))
    }

    fn steps_ui(&self, ui: &mut Ui, catalogue: &Catalogue, palette: &Palette, requests: &mut Vec<Request>) {
        let Self { lesson, place, step, .. } = self;
        let missing = self.missing();
        let button = |ui: &mut Ui, name: &str, text: String| {
            let is_next = missing.is_none() && name != "Done";
            let button = if is_next { primary(&text, palette) } else { Button::new(text) };
            let button = ui.add_enabled(missing.is_none(), button).remembered(name);
            button.on_disabled_hover_text(missing.as_deref().unwrap_or_default())
        };
        ui.add_space(4.0);
        // Above the buttons, which do not move when it disappears.
        if let Some(missing) = &missing {
            ui.add(Label::new(RichText::new(missing).small().weak()).selectable(false));
        }
        let is_last = step + 1 == lesson.steps.len();
        let next = place.map(|place| place + 1).and_then(|next| Some((next, catalogue.at(next)?)));
        if let Some((next, lesson)) = next.filter(|_| is_last)
            && button(ui, "Next lesson", format!("Next: {}", lesson.title)).clicked()
        {
            requests.extend([Request::FinishLesson, Request::StartLesson(next)]);
        }
        ui.horizontal_wrapped(|ui| {
            if ui.add_enabled(*step > 0, Button::new("Back")).on_hover_text("Key: Backspace").clicked() {
                requests.extend(self.turn(false));
            }
            let of = RichText::new(format!("{} of {}", step + 1, lesson.steps.len())).weak();
            ui.add(Label::new(of).selectable(false));
            let name = if is_last { "Done" } else { "Next" };
            if button(ui, name, name.to_owned()).on_hover_text("Key: N").clicked() {
                requests.extend(self.turn(true));
            }
            if self.open_question().is_some() {
                let show = ui.button("Show me").on_hover_text("Continue without an answer. Key: N");
                if show.remembered("Show me").clicked() {
                    requests.extend(self.turn(true));
                }
            }
        });
    }

    pub(crate) fn turn(&self, forward: bool) -> Vec<Request> {
        if !forward {
            return self.step.checked_sub(1).map(Request::GoToStep).into_iter().collect();
        }
        if self.open_question().is_some() {
            vec![Request::Answer(Answer::Skipped)]
        } else if !self.is_revealed() {
            vec![Request::ChangeLesson]
        } else if self.step + 1 < self.lesson.steps.len() {
            vec![Request::GoToStep(self.step + 1)]
        } else {
            vec![Request::FinishLesson, Request::LeaveLesson]
        }
    }

    fn missing(&self) -> Option<String> {
        if self.open_question().is_some() {
            return Some("Answer the question first, or press “Show me”.".to_owned());
        }
        let change = self.current()?.change.as_ref().filter(|_| !self.changed)?;
        Some(format!("Press “{}” first.", change.label))
    }
}

fn change_ui(ui: &mut Ui, change: &Adjustment, changed: bool, palette: &Palette, requests: &mut Vec<Request>) {
    let button = if changed {
        Button::new(RichText::new(&change.label).weak()).frame(false).sense(Sense::hover())
    } else {
        primary(&change.label, palette)
    };
    if ui.add(button.wrap()).remembered("Change").clicked() {
        requests.push(Request::ChangeLesson);
    }
    ui.add_space(6.0);
}

fn part_ui(ui: &mut Ui, heading: &str, text: &str) {
    heading_ui(ui, heading);
    ui.label(text);
    ui.add_space(6.0);
}

pub(super) fn question_ui(
    ui: &mut Ui,
    question: &Question,
    answer: Option<Answer>,
    revealed: bool,
    requests: &mut Vec<Request>,
) {
    heading_ui(ui, "Question");
    ui.label(RichText::new(&question.ask).family(theme::strong()));
    for (place, choice) in question.choices.iter().enumerate() {
        let chosen = answer == Some(Answer::Choice(place));
        if revealed {
            revealed_choice_ui(ui, choice, chosen, question.is_right(place));
        } else if ui.add(RadioButton::new(chosen, choice.as_str())).clicked() {
            requests.push(Request::Answer(Answer::Choice(place)));
        }
    }
    ui.add_space(6.0);
}

fn revealed_choice_ui(ui: &mut Ui, choice: &str, chosen: bool, right: bool) {
    let (mark, text) = match (right, chosen) {
        (true, _) => ("✓", RichText::new(choice)),
        (false, true) => ("○", RichText::new(choice)),
        (false, false) => ("", RichText::new(choice).weak()),
    };
    ui.horizontal_top(|ui| {
        let (width, height) = (ui.spacing().icon_width, ui.text_style_height(&egui::TextStyle::Body));
        ui.add_sized([width, height], egui::Label::new(mark));
        let label = ui.add(egui::Label::new(text).wrap());
        let name = match (right, chosen) {
            (true, true) => format!("{choice} (right, your answer)"),
            (true, false) => format!("{choice} (right)"),
            (false, true) => format!("{choice} (your answer)"),
            (false, false) => choice.to_owned(),
        };
        label.ctx.accesskit_node_builder(label.id, |node| node.set_value(name));
    });
}

pub(super) fn feedback_ui(ui: &mut Ui, question: &Question, answer: Answer) {
    heading_ui(ui, "Your answer");
    let right = question.right_choice();
    let verdict = match answer {
        Answer::Choice(choice) if question.is_right(choice) => "That is right.".to_owned(),
        Answer::Choice(_) => format!("Not this time, and many would say so. The answer is: “{right}”"),
        Answer::Skipped => format!("The answer is: “{right}”"),
    };
    ui.label(RichText::new(verdict).family(theme::strong()));
    ui.label(&question.because);
    ui.add_space(6.0);
}

pub(super) fn heading_ui(ui: &mut Ui, heading: &str) {
    ui.label(RichText::new(heading).small().weak());
}
