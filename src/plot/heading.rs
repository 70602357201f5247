//! The line above a chart: its title, and the values at the cursor.

use std::sync::Arc;

use egui::emath::GuiRounding as _;
use egui::{Color32, Galley, Id, Rect, Response, Role, Sense, TextStyle, Ui, WidgetInfo, pos2, vec2};

use crate::theme;
use crate::widgets::hover_text;

pub(crate) struct Readout {
    pub(crate) text: String,
    pub(crate) aside: Option<String>,
    pub(crate) color: Color32,
    pub(crate) hint: String,
}

impl Readout {
    pub(crate) fn new(text: String, color: Color32, hint: String) -> Self {
        Self { text, aside: None, color, hint }
    }

    fn in_full(&self) -> String {
        self.aside.as_ref().map_or_else(|| self.text.clone(), |aside| format!("{} ({aside})", self.text))
    }

    fn in_words(&self) -> String {
        format!("{}: {}", self.hint, self.in_full())
    }

    fn has_owner(&self) -> bool {
        self.color != Color32::TRANSPARENT
    }
}

const GAP: f32 = 8.0;
/// Width of the dot in the colour of a value's owner, with the space after it \[points\].
const DOT: f32 = 9.0;
const ELLIPSIS: f32 = 20.0;

/// Values at the right take precedence over the name and its unit. Returns the symbol at the very left.
/// Each frame has many of them, so texts are laid out once and painted in place.
pub(crate) fn heading_ui(ui: &mut Ui, symbol: &str, name: &str, unit: &str, readouts: &[Readout]) -> Response {
    let colors = [ui.visuals().text_color(), ui.visuals().weak_text_color()];
    let symbol_text = text(ui, symbol.to_owned(), &theme::symbol(), colors[0]);
    let before_name = symbol_text.size().x + GAP;
    let room = ui.available_width() - before_name;
    let unit = if unit.is_empty() { String::new() } else { format!("[{unit}]") };
    let titled = |words: String| text(ui, words.trim().to_owned(), &theme::title(), colors[1]);
    let titles = [format!("{name} {unit}"), name.to_owned(), unit].map(titled);
    let values = HeadingValues::new(ui, symbol, readouts, [room, room - titles[0].size().x - GAP]);
    let height = ui.spacing().interact_size.y.max(symbol_text.size().y).max(values.height());
    let (row, _) = ui.allocate_exact_size(vec2(ui.available_width(), height), Sense::hover());
    let response = place(ui, row, row.left(), &symbol_text, (symbol, 0));
    let fits = |text: &Arc<Galley>| text.size().x + GAP <= room - values.total();
    if let Some(text) = titles.into_iter().find(fits) {
        place(ui, row, row.left() + before_name, &text, (symbol, 1));
    }
    values.ui(ui, row, symbol);
    response
}

struct HeadingValues<'a> {
    all: &'a [Readout],
    shown: Vec<(Arc<Galley>, f32)>,
}

impl<'a> HeadingValues<'a> {
    fn new(ui: &Ui, symbol: &str, all: &'a [Readout], [room, beside_name]: [f32; 2]) -> Self {
        let (color, style) = (ui.visuals().text_color(), theme::readout());
        // A value keeps the largest width so far, so that nothing moves while it changes.
        let scope = ui.scope_id();
        let sized = |readout: &Readout, words: String, kind: &str| {
            let dot = if readout.has_owner() { DOT } else { 0.0 };
            let galley = text(ui, words, &style, color);
            let room = steady(ui, scope.with((symbol, &readout.hint, kind)), galley.size().x + dot);
            (galley, room)
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
        self.shown.iter().map(|(_, room)| room + GAP).sum::<f32>() + if left_out { ELLIPSIS } else { 0.0 }
    }

    fn height(&self) -> f32 {
        self.shown.iter().map(|(text, _)| text.size().y).fold(0.0, f32::max)
    }

    fn ui(&self, ui: &Ui, row: Rect, symbol: &str) {
        let Self { all, shown } = self;
        let mut right = row.right();
        if shown.len() < all.len() {
            let dots = text(ui, "…".to_owned(), &TextStyle::Small, ui.visuals().text_color());
            let more = place(ui, row, right - dots.size().x, &dots, (symbol, 2));
            right -= dots.size().x + GAP;
            hover_text(more, &|| all.iter().map(Readout::in_words).collect::<Vec<_>>().join("\n"));
        }
        for (i, (readout, (text, room))) in all.iter().zip(shown).enumerate().rev() {
            let left = right - text.size().x;
            hover_text(place(ui, row, left, text, (symbol, 3 + i)), &|| readout.in_words());
            // Text in a light colour is hard to read on a light ground: a dot has the colour.
            if readout.has_owner() {
                let centre = pos2(left - 0.65 * DOT, row.center().y);
                ui.painter().circle_filled(centre, 0.35 * DOT, readout.color);
            }
            right -= room + GAP;
        }
    }
}

fn place(ui: &Ui, row: Rect, left: f32, text: &Arc<Galley>, of: (&str, usize)) -> Response {
    // Glyphs are drawn texel by texel, so they begin on a whole pixel.
    let at = pos2(left, row.center().y - 0.5 * text.size().y).round_to_pixels(ui.pixels_per_point());
    ui.painter().galley(at, Arc::clone(text), Color32::PLACEHOLDER);
    let response = ui.interact(Rect::from_min_size(at, text.size()), ui.unique_id().with(of), Sense::hover());
    response.widget_info(|| WidgetInfo::labeled(Role::Label, ui.is_enabled(), text.text()));
    response
}

fn text(ui: &Ui, text: String, style: &TextStyle, color: Color32) -> Arc<Galley> {
    ui.painter().layout_no_wrap(text, style.resolve(ui.style()), color)
}

fn value(text: &str) -> &str {
    text.split(' ').next().unwrap_or(text)
}

fn steady(ui: &Ui, id: Id, width: f32) -> f32 {
    ui.data_mut(|data| {
        let kept = data.get_temp_mut_or(id, width);
        // One long number, such as that of a wide first guess, must not keep its room for ever.
        *kept = if *kept > 1.3 * width { width } else { kept.max(width) };
        *kept
    })
}
