//! Lights the settings that a lesson's step is about.

use std::sync::Arc;

use egui::{CornerRadius, Id, Shape, Stroke, StrokeKind, Ui};
use kalmanscope_core::Scenario;

#[derive(Clone)]
struct Highlight {
    paths: Vec<String>,
    scenario: Arc<Scenario>,
}

pub(super) fn set(ui: &Ui, paths: Vec<String>, scenario: &Arc<Scenario>) {
    if paths.is_empty() {
        return ui.data_mut(|data| data.remove::<Highlight>(id()));
    }
    let lit = Highlight { paths, scenario: Arc::clone(scenario) };
    ui.data_mut(|data| data.insert_temp(id(), lit));
}

pub(super) fn highlight_ui<R>(ui: &mut Ui, path: &str, add_contents: impl FnOnce(&mut Ui) -> R) -> R {
    let lit =
        ui.data(|data| data.get_temp::<Highlight>(id())).filter(|lit| lit.paths.iter().any(|lit| concerns(lit, path)));
    let Some(lit) = lit else { return add_contents(ui) };
    // It takes its place below the contents before their size is known.
    let ground = ui.painter().add(Shape::Noop);
    let shown = ui.scope(add_contents);
    let rect = shown.response.rect.expand2(egui::vec2(4.0, 1.0));
    let accent = ui.visuals().selection.bg_fill;
    let (fill, stroke) = (accent.gamma_multiply(0.14), Stroke::new(1.0, accent));
    ui.painter()
        .set(ground, egui::epaint::RectShape::new(rect, CornerRadius::same(4), fill, stroke, StrokeKind::Inside));
    shown.response.ctx.accesskit_node_builder(shown.response.id, |node| {
        let [(x0, y0), (x1, y1)] = [rect.min, rect.max].map(|corner| (f64::from(corner.x), f64::from(corner.y)));
        node.set_role(egui::accesskit::Role::Group);
        node.set_bounds(egui::accesskit::Rect { x0, y0, x1, y1 });
        node.set_label(format!("The step is about {}", lit.scenario.address_by_name(path)));
    });
    shown.inner
}

fn concerns(lit: &str, path: &str) -> bool {
    // The key is split around the id, so that `*` may stand in place of the id.
    let [lit, path] = [lit, path].map(|path| path.replacen("filters#", "filters.#", 1));
    // The shorter one decides: a lit table lights each of its numbers.
    lit.split('.').zip(path.split('.')).all(|(a, b)| a == b || a == "*")
}

fn id() -> Id {
    Id::unique("lit settings")
}

#[cfg(test)]
mod tests {
    use super::concerns;

    #[test]
    fn a_path_concerns_itself_and_what_it_is_in_and_contains() {
        for (lit, path, expected) in [
            ("filters#1.fading", "filters#1.fading", true),
            ("filters#1.fading", "filters#1.eta", false),
            ("filters#1.fading", "filters#2.fading", false),
            ("filters.*.fading", "filters#2.fading", true),
            ("filters#1.process_std", "filters#1.process_std.velocity", true),
            ("filters#1.process_std.velocity", "filters#1", true),
            ("filters#1.process_std.velocity", "filters#1.process_std.displacement", false),
            ("dt", "duration", false),
            ("force", "force", true),
        ] {
            assert_eq!(concerns(lit, path), expected, "{lit} and {path}");
        }
    }
}
