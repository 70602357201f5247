//! Compares the values at the marks A and B.

use egui::{Align2, Context, Grid, RichText, ScrollArea, TextStyle, Ui, vec2};
use kalmanscope_core::Channel;

use crate::request::Request;
use crate::ruler::{Ruler, RulerEnd};
use crate::session::Session;
use crate::text::{decimals, fixed, in_hertz, significant};
use crate::theme::{self, Palette};
use crate::visibility::Visibility;

pub(crate) struct RulerReading {
    pub(crate) times: [f64; 2],
    pub(crate) is_b_set: bool,
    pub(crate) rows: Vec<RulerRow>,
}

pub(crate) struct RulerRow {
    pub(crate) channel: Channel,
    pub(crate) name: String,
    pub(crate) color: egui::Color32,
    pub(crate) values: [f64; 2],
}

impl RulerReading {
    pub(crate) fn of(ruler: &Ruler, session: &Session, visible: &Visibility, palette: &Palette) -> Option<Self> {
        let b = ruler.time(RulerEnd::B);
        let times = [ruler.time(RulerEnd::A)?, b.unwrap_or_else(|| session.time())];
        let record = session.run().record();
        let samples = times.map(|time| session.sample_at(time));
        let mut rows = Vec::new();
        for channel in visible.channels(session.run().channels()) {
            let mut add = |name: &str, color, values: &[f64]| {
                if let [Some(a), Some(b)] = samples.map(|k| values.get(k).copied()) {
                    rows.push(RulerRow { channel, name: name.to_owned(), color, values: [a, b] });
                }
            };
            if let Some(truth) = record.truth(channel).filter(|_| visible.truth) {
                add("truth", palette.truth, truth);
            }
            for estimates in session.run().estimates().iter().filter(|one| visible.filter(one.id())) {
                if let Some(at) = estimates.place(channel) {
                    add(estimates.name(), palette.shade(estimates.color()), estimates.canonical_means(at));
                }
            }
        }
        Some(Self { times, is_b_set: b.is_some(), rows })
    }
}

const HEIGHT: f32 = 220.0;

pub(crate) fn table_ui(ctx: &Context, reading: &RulerReading, requests: &mut Vec<Request>) {
    let mut open = true;
    let window = egui::Window::new("From A to B").id(egui::Id::unique("ruler")).collapsible(true).resizable(false);
    let corner = ctx.content_rect().right_bottom() - vec2(12.0, 12.0);
    let window = window.open(&mut open).pivot(Align2::RIGHT_BOTTOM).default_pos(corner);
    window.show(ctx, |ui| {
        ui.style_mut().override_text_style = Some(TextStyle::Small);
        times_ui(ui, reading);
        ui.separator();
        ScrollArea::vertical().max_height(HEIGHT).show(ui, |ui| rows_ui(ui, reading));
        if !reading.is_b_set {
            ui.small("Shift and a click in a plot, or the key B, sets B.");
        }
    });
    if !open {
        requests.push(Request::ClearMarks);
    }
}

fn times_ui(ui: &mut Ui, reading: &RulerReading) {
    let [a, b] = reading.times;
    let between = b - a;
    let other = if reading.is_b_set { "B" } else { "now" };
    ui.label(format!("A {}   {other} {}   Δt {} s", fixed(a, 3), fixed(b, 3), fixed(between, 3)));
    if between != 0.0 {
        let frequency = 1.0 / between.abs();
        let angular = std::f64::consts::TAU * frequency;
        ui.weak(format!("as one period: {} Hz, {} rad/s", significant(frequency, 4), significant(angular, 4)));
    }
}

fn rows_ui(ui: &mut Ui, reading: &RulerReading) {
    Grid::new("from A to B").num_columns(5).striped(true).spacing([12.0, 1.0]).show(ui, |ui| {
        for heading in ["", "", "A", if reading.is_b_set { "B" } else { "now" }, "Δ"] {
            ui.weak(heading);
        }
        ui.end_row();
        let mut last = None;
        for row in &reading.rows {
            let is_new = last != Some(row.channel);
            last = Some(row.channel);
            let symbol = if is_new { row.channel.symbol() } else { "" };
            ui.label(RichText::new(symbol).family(theme::strong()));
            ui.colored_label(row.color, &row.name);
            let digits = decimals(row.channel);
            let [a, b] = row.values;
            for value in [a, b, b - a] {
                let label = ui.label(fixed(value, digits));
                if let Some(hertz) = in_hertz(value, row.channel.unit()) {
                    label.on_hover_text(hertz);
                }
            }
            ui.end_row();
        }
    });
}
