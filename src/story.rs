//! The story of the run, in words above the plots. Its bold numbers are dragged in the text.

use egui::{
    Color32, DragValue, FontId, Id, Label, Rect, Response, RichText, Sense, Stroke, TextStyle, Ui, UiBuilder, Vec2,
};
use kalmanscope_core::setting::Address;
use kalmanscope_diagnosis::{Adjustable, Diagnosis, Phrase, Story};

use crate::controls::named::{first_number, name_of};
use crate::request::Request;
use crate::session::Session;
use crate::theme::{self, Palette};
use crate::widgets::named;

const SPACE: f32 = 4.0;

/// Limits the width of a line, in heights of its letters.
const WIDEST: f32 = 64.0;

/// Lines whose room is kept for each story, and the room between them \[points\].
const LINES: f32 = 3.0;
const BETWEEN: f32 = 3.0;

const WAY: f64 = 400.0;

pub(crate) fn story_of(session: &Session) -> Story {
    if session.missing_record().is_some() {
        return Story::default();
    }
    if session.shows_another_run() {
        let words = Phrase::Words("The run of these settings is being computed.".to_owned());
        return Story { sentences: vec![vec![words]], ..Story::default() };
    }
    let run = session.run();
    let places = 0..run.estimates().len();
    let diagnoses: Vec<Option<&Diagnosis>> = places.map(|place| session.diagnosis(place)).collect();
    let story = Story::of(run, session.diagnostics(), &diagnoses);
    let Some(before) = session.before() else { return story };
    let filters: Vec<_> = (run.estimates().iter().zip(session.diagnostics()))
        .filter_map(|(estimates, now)| {
            let (was, _) = before.diagnostics(estimates.id())?;
            Some((estimates.id(), estimates.name(), was, now))
        })
        .collect();
    story.compared(&before.words, &filters)
}

pub(crate) fn story_ui(
    ui: &mut Ui,
    (story, session): (&Story, &Session),
    palette: &Palette,
    steady: bool,
    requests: &mut Vec<Request>,
) {
    // A shorter text has the room of the longest so far, so that the plots stay where they are.
    let font = theme::story().resolve(ui.style());
    let line = ui.fonts_mut(|fonts| fonts.row_height(&font));
    let width = ui.available_width().min(WIDEST * font.size);
    let key = Id::unique(("story", width as i32));
    let least = if steady { LINES * (line + BETWEEN) - BETWEEN } else { 0.0 };
    let tallest = ui.data(|data| data.get_temp(key)).unwrap_or(0.0_f32).max(least);
    // In a child, so that a long word does not widen all that follows.
    let room = Rect::from_min_size(ui.cursor().min, Vec2::new(width, ui.available_height()));
    let height = {
        let ui = &mut ui.new_child(UiBuilder::new().id_salt("story").max_rect(room));
        let spoken = story.to_string();
        ui.spacing_mut().item_spacing = Vec2::new(0.0, BETWEEN);
        // Lines of text are as high as text, for fingers too.
        ui.spacing_mut().interact_size.y = line;
        let text = ui.horizontal_wrapped(|ui| {
            ui.style_mut().text_styles.insert(TextStyle::Body, font);
            for sentence in &story.sentences {
                for (place, phrase) in sentence.iter().enumerate() {
                    keep_together_ui(ui, phrase, sentence.get(place + 1));
                    phrase_ui(ui, session, phrase, palette, requests);
                }
                // A space that is text could begin a row.
                ui.add_space(SPACE);
            }
        });
        text.response.ctx.accesskit_node_builder(text.response.id, |node| {
            node.set_role(egui::accesskit::Role::Group);
            node.set_label(spoken);
        });
        tallest.max(text.response.rect.height())
    };
    ui.advance_cursor_after_rect(room.with_max_y(room.top() + height));
    ui.data_mut(|data| data.insert_temp(key, height));
}

/// Begins a new line where there is no room for a number, or for a phrase but not for the stop or comma after it.
fn keep_together_ui(ui: &mut Ui, phrase: &Phrase, next: Option<&Phrase>) {
    let stop: String = match next {
        Some(Phrase::Words(next)) => next.chars().take_while(|c| ",.;:)".contains(*c)).collect(),
        _ => String::new(),
    };
    let is_number = matches!(phrase, Phrase::Setting(_));
    if matches!(phrase, Phrase::Words(_)) || (stop.is_empty() && !is_number) {
        return;
    }
    let size = TextStyle::Body.resolve(ui.style()).size;
    let width = |text: String, family: egui::FontFamily| {
        ui.painter().layout_no_wrap(text, FontId::new(size, family), Color32::WHITE).size().x
    };
    let alone = width(phrase.to_string(), theme::strong());
    let (room, needed) = (ui.available_size_before_wrap().x, alone + width(stop, egui::FontFamily::Proportional));
    // Another phrase that has no room wraps by itself.
    if needed > room && needed <= ui.max_rect().width() && (is_number || alone <= room) {
        ui.end_row();
    }
}

fn phrase_ui(ui: &mut Ui, session: &Session, phrase: &Phrase, palette: &Palette, requests: &mut Vec<Request>) {
    let strong = |text: &str, color: Color32| RichText::new(text).family(theme::strong()).color(color);
    match phrase {
        Phrase::Filter { id, name } => {
            let estimates = session.run().estimates().iter().find(|estimates| estimates.id() == *id);
            let color = estimates.map_or(palette.text, |estimates| palette.shade(estimates.color()));
            let name = ui.add(Label::new(strong(name, color)).sense(Sense::click()));
            if name.on_hover_text("Click for the evidence").clicked() {
                requests.push(Request::Diagnose(*id));
            }
        }
        Phrase::Result(text) => _ = ui.label(strong(text, palette.text)),
        Phrase::Setting(setting) => {
            let Ok(address) = Address::parse(session.scenario(), &setting.address) else {
                // The scenario of the controls is ahead of the run on screen.
                ui.label(strong(&setting.to_string(), palette.text));
                return;
            };
            let name = name_of(session.scenario(), setting, &address);
            let setting = setting.at(address.get(session.scenario()));
            if let Some(value) = number_ui(ui, &setting, &name, palette) {
                requests.push(Request::set(address, value));
            }
        }
        other => _ = ui.label(other.to_string()),
    }
}

fn number_ui(ui: &mut Ui, setting: &Adjustable, name: &str, palette: &Palette) -> Option<f64> {
    let mut shown = setting.shown;
    let (low, high) = setting.range;
    let number: Response = ui
        .scope(|ui| {
            let style = ui.style_mut();
            let font = FontId::new(TextStyle::Body.resolve(style).size, theme::strong());
            style.text_styles.insert(TextStyle::Button, font);
            style.drag_value_text_style = TextStyle::Button;
            style.spacing.button_padding = Vec2::ZERO;
            style.spacing.interact_size.x = 0.0;
            for widget in [
                &mut style.visuals.widgets.inactive,
                &mut style.visuals.widgets.hovered,
                &mut style.visuals.widgets.active,
            ] {
                widget.weak_bg_fill = Color32::TRANSPARENT;
                widget.bg_stroke = Stroke::NONE;
                widget.fg_stroke.color = palette.accent;
                widget.expansion = 0.0;
            }
            let of = setting.clone();
            let number = DragValue::new(&mut shown)
                .range(low..=high)
                .clamp_existing_to_range(false)
                .speed((high - low) / WAY)
                .custom_formatter(move |shown, _| of.showing(shown).to_string())
                .custom_parser(first_number);
            ui.add(number)
        })
        .inner;
    let (rect, color) = (number.rect, palette.accent);
    let dots = egui::Shape::dashed_line(&[rect.left_bottom(), rect.right_bottom()], Stroke::new(1.0, color), 2.0, 2.0);
    ui.painter().extend(dots);
    let number = number.on_hover_text(format!("{name}: drag to the sides, or click and type"));
    let number = named(number, format!("{name}, in the text"));
    number.changed().then(|| setting.value(shown))
}
