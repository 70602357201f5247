//! The panel of a lesson.

use egui::{Align, Button, Frame, Id, Label, Layout, Panel, RadioButton, RichText, ScrollArea, Sense, Ui};
use kalmanscope_lessons::{Change, Question};

use super::{Catalogue, Tutor};
use crate::drawer::close_ui;
use crate::request::{Answer, Request};
use crate::theme::Palette;
use crate::{probe, theme};

/// Limits the height of a panel that leaves out the lesson's summary, which the menu has too \[points\].
const SHORT: f32 = 450.0;

impl Tutor {
    pub(crate) fn ui(&self, ui: &mut Ui, catalogue: &Catalogue, palette: &Palette, requests: &mut Vec<Request>) {
        // The buttons stay on screen while the text is scrolled.
        Panel::bottom("steps").frame(Frame::new()).show_separator_line(false).show(ui, |ui| {
            self.steps_ui(ui, catalogue, requests);
        });
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
        let is_short = ui.clip_rect().height() < SHORT;
        if *step == 0 && !is_short {
            ui.weak(&lesson.summary);
            ui.add_space(6.0);
        }
        part_ui(ui, "Look", &current.look);
        let revealed = self.is_revealed();
        let (opened, grown) = self.news(ui);
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
        let before = ui.data_mut(|data| {
            let before = data.get_temp(id);
            data.insert_temp(id, state);
            before
        });
        let opened = before.is_none_or(|(step, ..): (usize, bool, bool)| step != state.0);
        (opened, !opened && before != Some(state))
    }

    fn steps_ui(&self, ui: &mut Ui, catalogue: &Catalogue, requests: &mut Vec<Request>) {
        let Self { lesson, place, step, .. } = self;
        let missing = self.missing();
        let button = |ui: &mut Ui, name: &str, text: String| {
            let button = ui.add_enabled(missing.is_none(), Button::new(text));
            probe::remember(ui.ctx(), name, button.rect);
            button.on_disabled_hover_text(missing.as_deref().unwrap_or_default()).clicked()
        };
        ui.add_space(4.0);
        // Above the buttons, which do not move when it disappears.
        if let Some(missing) = &missing {
            ui.label(RichText::new(missing).small().weak());
        }
        let is_last = step + 1 == lesson.steps.len();
        let next = place.map(|place| place + 1).and_then(|next| Some((next, catalogue.at(next)?)));
        if let Some((next, lesson)) = next.filter(|_| is_last)
            && button(ui, "Next lesson", format!("Next: {}", lesson.title))
        {
            requests.extend([Request::FinishLesson, Request::StartLesson(next)]);
        }
        ui.horizontal_wrapped(|ui| {
            if ui.add_enabled(*step > 0, Button::new("Back")).clicked() {
                requests.push(Request::GoToStep(step - 1));
            }
            ui.weak(format!("{} of {}", step + 1, lesson.steps.len()));
            if !is_last {
                if button(ui, "Next", "Next".to_owned()) {
                    requests.push(Request::GoToStep(step + 1));
                }
            } else if button(ui, "Done", "Done".to_owned()) {
                requests.extend([Request::FinishLesson, Request::LeaveLesson]);
            }
        });
    }

    fn missing(&self) -> Option<String> {
        if self.open_question().is_some() {
            return Some("Answer the question first, or press “Show me”.".to_owned());
        }
        let change = self.current()?.change.as_ref().filter(|_| !self.changed)?;
        Some(format!("Press “{}” first.", change.label))
    }
}

fn change_ui(ui: &mut Ui, change: &Change, changed: bool, palette: &Palette, requests: &mut Vec<Request>) {
    let button = if changed {
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
    if answer.is_none() {
        let text = RichText::new("Show me").color(ui.visuals().hyperlink_color);
        if ui.add(Button::new(text).frame(false)).on_hover_text("Go on without an answer").clicked() {
            requests.push(Request::Answer(Answer::Skipped));
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
