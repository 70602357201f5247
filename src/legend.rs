//! The legend of all plots; a click shows or hides an entry.

use egui::{Button, Color32, Painter, Rect, Sense, Stroke, StrokeKind, Ui, Vec2, WidgetInfo};

use crate::request::{LegendEntry, Request, ViewKind};
use crate::session::Session;
use crate::theme::Palette;
use crate::trouble::{Trouble, troubles};
use crate::verdict::chip_ui;
use crate::visibility::Visibility;

/// The sample of an entry.
#[derive(Clone, Copy)]
pub(crate) enum Mark {
    Line,
    Dots,
    Band,
    Chip,
}

/// One row of entries with `add_contents` at its end, and below it the run's problems.
pub(crate) fn legend_ui(
    ui: &mut Ui,
    session: &Session,
    visible: &Visibility,
    palette: &Palette,
    requests: &mut Vec<Request>,
    add_contents: impl FnOnce(&mut Ui, &mut Vec<Request>),
) {
    ui.horizontal_wrapped(|ui| {
        ui.spacing_mut().item_spacing.x = 12.0;
        let entry = |ui: &mut Ui, entry, name: &str, mark, color, on, requests: &mut Vec<Request>| {
            if entry_ui(ui, name, mark, color, on) {
                requests.push(Request::ToggleEntry(entry));
            }
        };
        let run = session.run();
        if run.channels().iter().any(|channel| run.record().truth(*channel).is_some()) {
            entry(ui, LegendEntry::Truth, "truth", Mark::Line, palette.truth, visible.truth, requests);
        }
        entry(ui, LegendEntry::Measured, "measured", Mark::Dots, palette.weak, visible.measured, requests);
        for (place, estimates) in session.run().estimates().iter().enumerate() {
            let (color, on) = (palette.shade(estimates.color()), visible.filter(estimates.id()));
            entry(ui, LegendEntry::Filter(estimates.id()), estimates.name(), Mark::Band, color, on, requests);
            let verdict = session.diagnosis(place).and_then(|diagnosis| diagnosis.verdict.as_ref());
            if let Some(verdict) = verdict.filter(|_| visible.verdicts)
                && chip_ui(ui, estimates.name(), verdict, (color, on), palette).clicked()
            {
                requests.push(Request::ShowView(ViewKind::Diagnosis));
            }
        }
        entry(ui, LegendEntry::Bands, "±2σ", Mark::Band, palette.weak, visible.bands, requests);
        entry(ui, LegendEntry::Verdicts, "verdicts", Mark::Chip, palette.weak, visible.verdicts, requests);
        if let Some(before) = session.before() {
            let text = format!("before: {} ×", before.words());
            let chip = ui.add(Button::new(text).small().stroke(Stroke::new(1.2, palette.weak)));
            if chip
                .on_hover_text("The thin grey lines: the estimates before the last change. Click to forget them")
                .clicked()
            {
                requests.push(Request::ForgetBefore);
            }
        }
        if !visible.only.is_empty() {
            let symbols: Vec<&str> = visible.only.iter().map(|channel| channel.symbol()).collect();
            let all = Button::new(format!("only {} ×", symbols.join(", "))).small();
            if ui.add(all).on_hover_text("Click to show all quantities").clicked() {
                requests.push(Request::ShowAllChannels);
            }
        }
        add_contents(ui, requests);
    });
    troubles_ui(ui, session, palette);
}

fn troubles_ui(ui: &mut Ui, session: &Session, palette: &Palette) {
    for Trouble { sentence, is_failure } in troubles(session) {
        if is_failure {
            ui.colored_label(palette.warning, sentence);
        } else {
            ui.weak(sentence);
        }
    }
}

/// Returns whether it was clicked.
fn entry_ui(ui: &mut Ui, name: &str, mark: Mark, color: Color32, on: bool) -> bool {
    let font = egui::TextStyle::Body.resolve(ui.style());
    let text_color = if on { ui.visuals().text_color() } else { ui.visuals().weak_text_color().gamma_multiply(0.6) };
    let galley = ui.painter().layout_no_wrap(name.to_owned(), font, text_color);
    let size = Vec2::new(galley.size().x + 26.0, 20.0);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, on, format!("Show {name}")));
    let color = if on { color } else { color.gamma_multiply(0.3) };
    let sample = Rect::from_center_size(rect.left_center() + Vec2::new(10.0, 0.0), Vec2::new(20.0, 10.0));
    paint_mark(ui.painter(), sample, mark, color);
    let painter = ui.painter();
    painter.galley(egui::pos2(rect.left() + 26.0, rect.center().y - galley.size().y / 2.0), galley, text_color);
    if response.has_focus() {
        painter.rect_stroke(rect.expand(2.0), 3.0, ui.visuals().selection.stroke, StrokeKind::Outside);
    }
    response.on_hover_text(if on { "Click to hide" } else { "Click to show" }).clicked()
}

/// Paints the sample of an entry.
pub(crate) fn paint_mark(painter: &Painter, sample: Rect, mark: Mark, color: Color32) {
    match mark {
        Mark::Line => {
            painter.hline(sample.x_range(), sample.center().y, Stroke::new(2.0, color));
        }
        Mark::Dots => {
            for (x, y) in [(0.2, 0.7), (0.5, 0.25), (0.8, 0.6)] {
                painter.circle_filled(sample.lerp_inside(egui::vec2(x, y)), 1.6, color);
            }
        }
        Mark::Chip => {
            painter.rect_stroke(sample, 5.0, Stroke::new(1.0, color), StrokeKind::Inside);
        }
        Mark::Band => {
            painter.rect_filled(sample, 2.0, color.gamma_multiply(0.25));
            painter.hline(sample.x_range(), sample.center().y, Stroke::new(2.0, color));
        }
    }
}
