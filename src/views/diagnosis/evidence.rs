//! The results of the tests of a filter, each as a bar and a sentence.

use egui::{Color32, Label, Rect, RichText, Sense, Stroke, Ui, Vec2};
use kalmanscope_core::diagnosis::Evidence;

use crate::text::{sentence, significant};
use crate::theme::Palette;

const BAR: Vec2 = Vec2::new(64.0, 9.0);

pub(super) fn evidence_ui(ui: &mut Ui, evidence: &[Evidence], color: Color32, palette: &Palette) {
    let mut sorted: Vec<&Evidence> = evidence.iter().filter(|one| !one.sentence.is_empty()).collect();
    sorted.sort_by(|a, b| b.counts.cmp(&a.counts).then(b.effect.total_cmp(&a.effect)));
    let counting = sorted.iter().filter(|one| one.counts).count();
    if counting > 0 {
        ui.add_space(4.0);
        ui.label(RichText::new("Evidence").small().weak());
    }
    for (i, one) in sorted[..counting].iter().enumerate() {
        ui.push_id(i, |ui| one_ui(ui, one, color, palette));
    }
    let rest = &sorted[counting..];
    if rest.is_empty() {
        return;
    }
    let title = format!("{} results that do not count", rest.len());
    egui::CollapsingHeader::new(RichText::new(title).small().weak()).id_salt("rest").show(ui, |ui| {
        for (i, one) in rest.iter().enumerate() {
            ui.push_id(counting + i, |ui| one_ui(ui, one, palette.weak, palette));
        }
    });
}

fn one_ui(ui: &mut Ui, one: &Evidence, color: Color32, palette: &Palette) {
    let id = ui.scope_id().with(("open", one.test.name));
    let mut open = ui.data(|data| data.get_temp::<bool>(id)).unwrap_or(false);
    ui.horizontal_top(|ui| {
        bar_ui(ui, one.effect, color, palette);
        ui.vertical(|ui| {
            let text = format!("{} {}", sentence(&one.sentence), if open { "▾" } else { "▸" });
            let title = ui.add(Label::new(text).wrap().selectable(false).sense(Sense::click()));
            open ^= title.clicked();
            title.on_hover_ui(|ui| {
                ui.set_max_width(380.0);
                ui.label(format!("How to read it: {}.", one.test.reading));
            });
            if open {
                let test = one.test;
                let numbers = format!("statistic {}, {}", significant(one.statistic, 3), chance(one.p_value));
                for line in [
                    format!("How to read it: {}.", test.reading),
                    format!("Effect: {} times what matters.", significant(one.effect, 2)),
                    format!("{}: {}; {numbers}.", sentence(test.name), test.statistic),
                    format!("If the filter is right: {}.", test.distribution),
                    format!("Source: {}.", test.source),
                ] {
                    ui.add(Label::new(RichText::new(line).small().color(palette.weak)).wrap());
                }
            }
        });
    });
    ui.data_mut(|data| data.insert_temp(id, open));
}

fn chance(p_value: f64) -> String {
    match p_value {
        p if p <= 0.0 => "no chance (p = 0)".to_owned(),
        p if p < 1e-4 => format!("p = {p:.0e}"),
        p => format!("p = {}", significant(p, 2)),
    }
}

fn bar_ui(ui: &mut Ui, effect: f64, color: Color32, palette: &Palette) {
    let (rect, response) = ui.allocate_exact_size(Vec2::new(BAR.x, 17.0), Sense::hover());
    let rect = Rect::from_center_size(rect.center(), BAR);
    let share = if effect.is_finite() { effect / (1.0 + effect) } else { 1.0 };
    let filled = Rect::from_min_size(rect.min, Vec2::new(BAR.x * share.clamp(0.0, 1.0) as f32, BAR.y));
    ui.painter().rect_filled(rect, 1.0, palette.faint);
    ui.painter().rect_filled(filled, 1.0, color.gamma_multiply(0.75));
    ui.painter().vline(rect.center().x, rect.expand(2.0).y_range(), Stroke::new(1.0, palette.text));
    response.on_hover_text(format!("{} times the effect that matters, at the line", significant(effect, 2)));
}
