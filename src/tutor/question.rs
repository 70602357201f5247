//! A step's question: the choices, and after the effect is shown, whether the choice was right.

use egui::{Button, RadioButton, RichText, Ui};
use kalmanscope_lessons::Question;

use super::heading::heading_ui;
use crate::request::{Answer, Request};
use crate::theme;

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
