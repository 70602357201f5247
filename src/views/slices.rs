//! A score over one setting at a time: the row and the column of the map through the setting on screen.

use egui::{Align2, Pos2, Rect, Sense, Shape, Stroke, TextStyle, Tooltip, Ui, UiBuilder, Vec2, pos2, vec2};
use kalmanscope_core::internals::sort_numbers;
use kalmanscope_core::{Axis, Measure, Spacing, ValueKind};

use super::map::contents;
use crate::controls::color::color_of;
use crate::laboratory::{Survey, measure_label, setting_label};
use crate::plot::graph::{Graph, Scale};
use crate::request::Request;
use crate::view::{View, ViewContext};

/// The slices through the map.
pub(super) struct Slices;

/// Space between the plots \[points\].
const GAP: f32 = 8.0;

/// The least width of plots side by side, and the least height of plots one below the other \[points\].
const LEAST: f32 = 170.0;
const LEAST_HEIGHT: f32 = 240.0;

/// Limits the ratio of height to width above which plots are one below the other.
const UPRIGHT: f32 = 1.1;

/// Limits the range of a scale below the best log likelihood, as a multiple of the median's distance.
const BELOW_BEST: f64 = 3.0;

/// The ratio of the largest to the smallest score beyond which a scale is logarithmic.
const DECADES: f64 = 50.0;

/// The height of a plot's title \[points\].
const TITLE: f32 = 16.0;

impl View for Slices {
    fn name(&self) -> &'static str {
        "Slices"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "The score of the map over one setting, while the other one is as on screen; a line for each filter.",
            "The dashed line is the setting on screen. A flat line: the setting hardly matters there.",
            "A narrow valley far from the line: it is worth while to move the dot of the map.",
        ]
    }

    fn is_of_laboratory(&self) -> bool {
        true
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Request>) -> Option<f64> {
        let (_, choice, survey) = contents(ui, context)?;
        if choice.measure.info().kind.is_of_kinds() {
            ui.weak("It is no number: choose another score above the map.");
            return None;
        }
        let (room, _) = ui.allocate_exact_size(ui.available_size().max(Vec2::splat(1.0)), Sense::hover());
        let present = survey.present(context.session.scenario());
        for (at, room) in rooms(room).into_iter().enumerate() {
            let slice = Slice { survey, measure: choice.measure, present, at };
            let mut child = ui.new_child(UiBuilder::new().id_salt(("slice", at)).max_rect(room));
            slice.ui(&mut child, room, context);
        }
        None
    }
}

/// The rooms of both plots, beside each other or one below the other, so that neither is narrow.
fn rooms(area: Rect) -> [Rect; 2] {
    let beside = 0.5 * (area.width() - GAP);
    let is_high = area.height() > UPRIGHT * area.width();
    if (beside >= LEAST && !is_high) || area.height() < LEAST_HEIGHT {
        let size = vec2(beside, area.height());
        return [0.0, beside + GAP].map(|x| Rect::from_min_size(area.min + vec2(x, 0.0), size));
    }
    let size = vec2(area.width(), 0.5 * (area.height() - GAP));
    [0.0, size.y + GAP].map(|y| Rect::from_min_size(area.min + vec2(0.0, y), size))
}

/// The scores along one axis through the setting on screen.
struct Slice<'a> {
    survey: &'a Survey,
    measure: Measure,
    present: [f64; 2],
    /// 0 along the axis across, 1 along the axis up.
    at: usize,
}

impl Slice<'_> {
    fn ui(&self, ui: &mut Ui, room: Rect, context: &ViewContext<'_>) {
        let Self { survey, measure, present, at } = *self;
        let palette = context.palette;
        let scenario = survey.ensemble().scenario();
        let axis = survey.axes()[at];
        let lines: Vec<Vec<[f64; 2]>> = (0..survey.filters().len()).map(|filter| self.line(filter)).collect();
        let x = Scale::of_cells(axis.from, axis.to, axis.count, axis.spacing == Spacing::Logarithmic);
        let below = room.with_min_y((room.top() + TITLE).min(room.bottom()));
        let graph = Graph::new(below, x, range(measure, lines.iter().flatten().map(|point| point[1])));
        let (name, score) = (setting_label(&axis.key, scenario), measure_label(measure));
        graph.axes_ui(ui, [&name, &score], palette, true);
        let font = TextStyle::Small.resolve(ui.style());
        let other = super::map::said(survey.axes()[1 - at], present[1 - at], survey);
        let title = pos2(graph.rect.left(), room.top() + 0.5 * TITLE);
        ui.painter_at(room).text(title, Align2::LEFT_CENTER, other, font, palette.weak);
        let painter = ui.painter_at(graph.rect.expand(1.0));
        let here = graph.at([present[at], f64::NAN]).x;
        if here.is_finite() {
            let ends = [pos2(here, graph.rect.top()), pos2(here, graph.rect.bottom())];
            painter.extend(Shape::dashed_line(&ends, Stroke::new(1.2, palette.warning), 5.0, 3.0));
        }
        for (filter, line) in lines.iter().enumerate() {
            let id = survey.filters()[filter];
            let own = context.session.scenario().filters.iter().find(|filter| filter.id == id);
            let color = own.map_or(palette.text, |filter| palette.shade(color_of(filter)));
            // The first line is wider, so that a line on top of it does not hide it.
            let width = if filter == 0 && lines.len() > 1 { 4.0 } else { 1.8 };
            for part in line.split(|[_, value]| !value.is_finite()) {
                let points: Vec<Pos2> = part.iter().map(|point| graph.at(*point)).collect();
                match points[..] {
                    [alone] => _ = painter.circle_filled(alone, 1.5, color),
                    _ => _ = painter.add(Shape::line(points, Stroke::new(width, color))),
                }
            }
        }
        let response = ui.interact(graph.rect, ui.scope_id().with("plot"), Sense::hover());
        let label = format!("Slice along {name}: {score}");
        response.ctx.accesskit_node_builder(response.id, |node| node.set_label(label));
        self.point_ui(&response, &graph, &lines);
    }

    /// Value of the setting and score, along the cells nearest to the setting on screen.
    fn line(&self, filter: usize) -> Vec<[f64; 2]> {
        let Self { survey, measure, present, at } = *self;
        let ensemble = survey.ensemble();
        let axes = survey.axes();
        let nearest = |axis: &Axis, value: f64| {
            let last = axis.count.saturating_sub(1);
            ((axis.share_of(value).clamp(0.0, 1.0) * last as f64).round() as usize).min(last)
        };
        let across = nearest(axes[1 - at], present[1 - at]);
        let point = |place: usize| {
            let places = if at == 0 { [place, across] } else { [across, place] };
            let value = survey.value(ensemble.cell(&places), filter, measure).unwrap_or(f64::NAN);
            let is_size = measure.info().kind == ValueKind::Error;
            [axes[at].value(place), if is_size { value.abs() } else { value }]
        };
        (0..axes[at].count).map(point).collect()
    }

    /// The numbers at the pointer.
    fn point_ui(&self, response: &egui::Response, graph: &Graph, lines: &[Vec<[f64; 2]>]) {
        let Self { survey, measure, at, .. } = *self;
        let Some(pointer) = response.hover_pos() else { return };
        let count = survey.axes()[at].count;
        let place = ((graph.shares(pointer)[0] * count as f64).max(0.0) as usize).min(count.saturating_sub(1));
        let Some([value, _]) = lines.first().and_then(|line| line.get(place)) else { return };
        let names = survey.ensemble().scenario().filters.iter().map(|filter| &filter.name);
        if !response.hovered() {
            return;
        }
        Tooltip::for_widget(response).at_pointer().gap(12.0).show(|ui| {
            ui.label(super::map::said(survey.axes()[at], *value, survey));
            for (name, line) in names.zip(lines) {
                ui.label(format!("{name}: {}", super::map::score_text(measure, line[place][1])));
            }
        });
    }
}

/// The scale of the scores: logarithmic where these span decades.
fn range(measure: Measure, values: impl Iterator<Item = f64>) -> Scale {
    let values: Vec<f64> = values.filter(|value| value.is_finite()).collect();
    let ends = values.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), v| (l.min(*v), h.max(*v)));
    let kind = measure.info().kind;
    let ends = if kind == ValueKind::LogLikelihood { (ends.0.max(least_shown(values, ends.1)), ends.1) } else { ends };
    let (low, high) = if ends.0 <= ends.1 { ends } else { (0.0, 1.0) };
    if low > 0.0 && high > DECADES * low {
        return Scale::new(low / 1.3, high * 1.3, true);
    }
    let is_flag = matches!(kind, ValueKind::Flag | ValueKind::Share);
    let (low, high) = if is_flag { (0.0, 1.0) } else { (low, high) };
    let margin = 0.06 * (high - low).max(1e-9 + 0.02 * high.abs());
    Scale::new(low - margin, high + margin, false)
}

/// The least log likelihood on a scale: impossible settings have very small ones, which would hide all differences
/// between the others.
fn least_shown(mut values: Vec<f64>, best: f64) -> f64 {
    sort_numbers(&mut values);
    let median = values.get(values.len() / 2).copied().unwrap_or(best);
    best - BELOW_BEST * (best - median).max(10.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn impossible_settings_do_not_flatten_the_likelihood() {
        let values = (-20..=20).map(|x: i32| 9000.0 - f64::from(x).powi(2) - 1e-9 * f64::from(x.min(0)).powi(12));
        let scale = range(Measure::LOG_LIKELIHOOD, values);
        let share = |value: f64| scale.share(value);
        assert!(share(9000.0) > 0.9 && share(8600.0) > 0.05 && share(8600.0) < 0.8, "{}", share(8600.0));
        assert!(share(-1e6) < 0.0, "out of sight");
    }

    #[test]
    fn plots_stand_beside_each_other_where_there_is_width_for_both() {
        let beside = |width: f32, height: f32| {
            let [a, b] = rooms(Rect::from_min_size(Pos2::ZERO, vec2(width, height)));
            a.top() == b.top()
        };
        assert!(beside(600.0, 300.0) && beside(300.0, 200.0));
        assert!(!beside(370.0, 580.0) && !beside(470.0, 690.0) && !beside(300.0, 300.0));
    }
}
