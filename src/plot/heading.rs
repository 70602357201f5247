//! The line above a chart: its title, and the values at the cursor.

use egui::{Align, Color32, Id, Layout, Response, RichText, Sense, TextStyle, Ui, vec2};

use crate::theme;

/// A value in a heading.
pub(crate) struct Readout {
    pub(crate) text: String,
    /// The colour of its owner; transparent where it has none.
    pub(crate) color: Color32,
    /// The owner of the value.
    pub(crate) hint: String,
}

impl Readout {
    fn has_owner(&self) -> bool {
        self.color != Color32::TRANSPARENT
    }
}

/// Space between the parts of a heading \[points\].
const GAP: f32 = 8.0;
/// Width of the dot in the colour of a value's owner, with the space after it \[points\].
const DOT: f32 = 9.0;
/// Space for the sign of omitted values \[points\].
const ELLIPSIS: f32 = 20.0;

/// Name and unit at the left, values at the cursor or at playback at the right, as many as fit; the values take
/// precedence. Returns the symbol at the very left.
pub(crate) fn heading_ui(ui: &mut Ui, symbol: &str, name: &str, unit: &str, readouts: &[Readout]) -> Response {
    ui.horizontal(|ui| {
        ui.spacing_mut().item_spacing.x = GAP;
        let label = ui.label(RichText::new(symbol).text_style(theme::symbol()));
        let room = ui.available_width();
        let values = Values::new(ui, symbol, readouts, room);
        let unit = if unit.is_empty() { String::new() } else { format!("[{unit}]") };
        let named = format!("{name} {unit}");
        let fits = |text: &&str| width(ui, text, &TextStyle::Body) + GAP <= room - values.total();
        if let Some(text) = [named.trim(), &unit].into_iter().find(fits) {
            ui.weak(text);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| values.ui(ui));
        label
    })
    .inner
}

/// The values that fit, without their ±2σ where space is short.
struct Values<'a> {
    all: &'a [Readout],
    /// Text and width of the values that fit.
    shown: Vec<(&'a str, f32)>,
}

impl<'a> Values<'a> {
    fn new(ui: &Ui, symbol: &str, all: &'a [Readout], room: f32) -> Self {
        // A value keeps the largest width so far, so that nothing moves while it changes.
        let scope = ui.scope_id();
        let sized = |(readout, text): (&Readout, &'a str)| {
            let dot = if readout.has_owner() { DOT } else { 0.0 };
            (text, steady(ui, scope.with((symbol, &readout.hint)), width(ui, text, &theme::readout()) + dot))
        };
        let shown = all.iter().map(|r| (r, r.text.as_str())).map(sized).collect();
        let mut values = Self { all, shown };
        if values.total() > room {
            values.shown = all.iter().map(|r| (r, value(&r.text))).map(|(r, text)| sized((r, text))).collect();
        }
        while values.total() > room && values.shown.pop().is_some() {}
        values
    }

    fn total(&self) -> f32 {
        let left_out = self.shown.len() < self.all.len();
        self.shown.iter().map(|(_, width)| width + GAP).sum::<f32>() + if left_out { ELLIPSIS } else { 0.0 }
    }

    /// From the right; where some are left out, the hint lists all.
    fn ui(&self, ui: &mut Ui) {
        let Self { all, shown } = self;
        if shown.len() < all.len() {
            let lines = all.iter().map(|r| format!("{}: {}", r.hint, r.text));
            ui.label(RichText::new("…").small()).on_hover_text(lines.collect::<Vec<_>>().join("\n"));
        }
        for (readout, (text, width)) in all.iter().zip(shown).rev() {
            let size = vec2(*width, ui.available_height());
            ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = 0.0;
                let label = ui.label(RichText::new(*text).text_style(theme::readout()));
                label.on_hover_text(format!("{}: {}", readout.hint, readout.text));
                // Text in a light colour is hard to read on a light ground: a dot has the colour.
                if readout.has_owner() {
                    let (dot, _) = ui.allocate_exact_size(vec2(DOT, DOT), Sense::hover());
                    ui.painter().circle_filled(dot.left_center() + vec2(0.35 * DOT, 0.0), 0.35 * DOT, readout.color);
                }
            });
        }
    }
}

/// The value without its ±2σ.
fn value(text: &str) -> &str {
    text.split(' ').next().unwrap_or(text)
}

fn width(ui: &Ui, text: &str, style: &TextStyle) -> f32 {
    let font = style.resolve(ui.style());
    ui.painter().layout_no_wrap(text.to_owned(), font, Color32::PLACEHOLDER).size().x
}

/// The largest width so far, unless that was much larger.
fn steady(ui: &Ui, id: Id, width: f32) -> f32 {
    ui.data_mut(|data| {
        let kept = data.get_temp_mut_or(id, width);
        *kept = if *kept > 1.3 * width { width } else { kept.max(width) };
        *kept
    })
}
