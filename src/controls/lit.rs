//! Lights the settings that a lesson's step is about.

use egui::{Color32, CornerRadius, Id, Shape, Stroke, StrokeKind, Ui};

/// Lights these settings from now on. Each is a path in a scenario, such as `filters.EKF.fading`; `*` stands for any.
pub(super) fn light(ui: &Ui, paths: Vec<String>) {
    ui.data_mut(|data| data.insert_temp(id(), paths));
}

/// Shows controls, on a lit ground if the setting under this path, a part of it or a table that it is in is lit.
pub(super) fn lit<R>(ui: &mut Ui, path: &str, add_contents: impl FnOnce(&mut Ui) -> R) -> R {
    if !is_lit(ui, path) {
        return add_contents(ui);
    }
    let ground = ui.painter().add(Shape::Noop);
    let shown = ui.scope(add_contents);
    let rect = shown.response.rect.expand2(egui::vec2(4.0, 1.0));
    let accent = ui.visuals().selection.bg_fill;
    let (fill, stroke) = (faint(accent), Stroke::new(1.0, accent));
    ui.painter()
        .set(ground, egui::epaint::RectShape::new(rect, CornerRadius::same(4), fill, stroke, StrokeKind::Inside));
    shown.response.ctx.accesskit_node_builder(shown.response.id, |node| {
        let [(x0, y0), (x1, y1)] = [rect.min, rect.max].map(|corner| (f64::from(corner.x), f64::from(corner.y)));
        node.set_role(egui::accesskit::Role::Group);
        node.set_bounds(egui::accesskit::Rect { x0, y0, x1, y1 });
        node.set_label(format!("The step is about {path}"));
    });
    shown.inner
}

fn is_lit(ui: &Ui, path: &str) -> bool {
    ui.data(|data| data.get_temp::<Vec<String>>(id())).is_some_and(|lit| lit.iter().any(|lit| concerns(lit, path)))
}

/// Whether one of two paths leads to the other, or both are the same.
fn concerns(lit: &str, path: &str) -> bool {
    lit.split('.').zip(path.split('.')).all(|(a, b)| a == b || a == "*")
}

fn faint(accent: Color32) -> Color32 {
    accent.gamma_multiply(0.14)
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
            ("filters.EKF.fading", "filters.EKF.fading", true),
            ("filters.EKF.fading", "filters.EKF.eta", false),
            ("filters.EKF.fading", "filters.UKF.fading", false),
            ("filters.*.fading", "filters.UKF.fading", true),
            ("filters.EKF.process_std", "filters.EKF.process_std.velocity", true),
            ("filters.EKF.process_std.velocity", "filters.EKF", true),
            ("filters.EKF.process_std.velocity", "filters.EKF.process_std.displacement", false),
            ("dt", "duration", false),
            ("force", "force", true),
        ] {
            assert_eq!(concerns(lit, path), expected, "{lit} and {path}");
        }
    }
}
