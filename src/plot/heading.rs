//! The line above a chart: its title, and the values at the cursor.

use egui::{Align, Color32, Id, Layout, Response, RichText, Sense, TextStyle, Ui, vec2};

use crate::theme;

/// A value in a heading.
pub(crate) struct Readout {
    pub(crate) text: String,
    /// The same in another unit, shown where there is room.
    pub(crate) aside: Option<String>,
    /// The colour of its owner; transparent where it has none.
    pub(crate) color: Color32,
    /// The owner of the value.
    pub(crate) hint: String,
}

impl Readout {
    /// A value of an owner with a colour.
    pub(crate) fn new(text: String, color: Color32, hint: String) -> Self {
        Self { text, aside: None, color, hint }
    }

    /// The value, and the same in another unit if it has one.
    fn in_full(&self) -> String {
        self.aside.as_ref().map_or_else(|| self.text.clone(), |aside| format!("{} ({aside})", self.text))
    }

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
        let unit = if unit.is_empty() { String::new() } else { format!("[{unit}]") };
        let named = format!("{name} {unit}");
        let name_width = width(ui, named.trim(), &TextStyle::Body) + GAP;
        let values = Values::new(ui, symbol, readouts, [room, room - name_width]);
        let fits = |text: &&str| width(ui, text, &TextStyle::Body) + GAP <= room - values.total();
        if let Some(text) = [named.trim(), &unit].into_iter().find(fits) {
            ui.weak(text);
        }
        ui.with_layout(Layout::right_to_left(Align::Center), |ui| values.ui(ui));
        label
    })
    .inner
}

/// The values that fit: in a second unit where there is room beside the name, and without their ±2σ where space is short.
struct Values<'a> {
    all: &'a [Readout],
    /// Text and width of the values that fit.
    shown: Vec<(String, f32)>,
}

impl<'a> Values<'a> {
    /// `room` is the width for values alone, and beside the name.
    fn new(ui: &Ui, symbol: &str, all: &'a [Readout], [room, beside_name]: [f32; 2]) -> Self {
        // A value keeps the largest width so far, so that nothing moves while it changes.
        let scope = ui.scope_id();
        let sized = |readout: &Readout, text: String, kind: &str| {
            let dot = if readout.has_owner() { DOT } else { 0.0 };
            let width = width(ui, &text, &theme::readout()) + dot;
            (text, steady(ui, scope.with((symbol, &readout.hint, kind)), width))
        };
        let mut values = Self { all, shown: Vec::new() };
        if all.iter().any(|readout| readout.aside.is_some()) {
            values.shown = all.iter().map(|readout| sized(readout, readout.in_full(), "in full")).collect();
        }
        if values.shown.is_empty() || values.total() > beside_name {
            values.shown = all.iter().map(|readout| sized(readout, readout.text.clone(), "")).collect();
        }
        if values.total() > room {
            values.shown = all.iter().map(|readout| sized(readout, value(&readout.text).to_owned(), "")).collect();
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
            let lines = all.iter().map(|r| format!("{}: {}", r.hint, r.in_full()));
            ui.label(RichText::new("…").small()).on_hover_text(lines.collect::<Vec<_>>().join("\n"));
        }
        for (readout, (text, width)) in all.iter().zip(shown).rev() {
            let size = vec2(*width, ui.available_height());
            ui.allocate_ui_with_layout(size, Layout::right_to_left(Align::Center), |ui| {
                ui.spacing_mut().item_spacing.x = 0.0;
                let label = ui.label(RichText::new(text).text_style(theme::readout()));
                label.on_hover_text(format!("{}: {}", readout.hint, readout.in_full()));
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
