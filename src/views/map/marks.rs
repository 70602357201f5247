//! Marks on a panel: the truth, the consistent region, and the dot of the present setting, which is dragged.

use egui::{Color32, CursorIcon, EventFilter, Id, InputState, Key, Rect, Sense, Stroke, Ui, Vec2};
use egui_plot::{Line, LineStyle, MarkerShape, PlotUi, Points};
use kalmanscope_core::setting::{Address, INITIAL_MEAN};
use kalmanscope_core::{Axis, Scenario, Signal};
use kalmanscope_diagnosis::Measure;

use super::scale::{CONSISTENT, Graph, spread};
use crate::laboratory::Survey;
use crate::plot::medium::Medium;
use crate::request::Request;
use crate::text::{parse, significant, unit_in};
use crate::theme::Palette;
use crate::view::ViewContext;

/// The radius of the dot, and that of the area to grasp it by pointer or finger \[points\].
const RADIUS: f32 = 6.0;
const GRASP: (f32, f32) = (11.0, 22.0);

pub(super) fn line_on(plot: &mut PlotUi<'_>, points: &[[f64; 2]], style: LineStyle) {
    // Black on a wider white line is seen on every colour of a map.
    for (color, width) in [(Color32::from_white_alpha(200), 3.2), (Color32::BLACK, 1.4)] {
        plot.line(Line::new("line", points.to_vec()).color(color).width(width).style(style).allow_hover(false));
    }
}

pub(super) fn contour_on(plot: &mut PlotUi<'_>, graph: &Graph, counts: [usize; 2], contour: &[Piece]) {
    let at = |[x, y]: [f64; 2]| graph.in_plot([(x + 0.5) / counts[0] as f64, (y + 0.5) / counts[1] as f64]);
    contour.iter().for_each(|piece| line_on(plot, &piece.map(at), LineStyle::Solid));
}

fn truth(axis: &Axis, scenario: &Scenario) -> Option<f64> {
    let guess = Address::parse(scenario, &axis.key).ok().filter(|address| address.table == Some(&INITIAL_MEAN))?;
    match scenario.plant.parameter(guess.channel?)? {
        Signal::Constant(value) => Some(value),
        _ => None,
    }
}

pub(super) fn truths(axes: [&Axis; 2], context: &ViewContext<'_>) -> Vec<(usize, f64)> {
    if !context.visible.truth || context.session.is_measured() {
        return Vec::new();
    }
    let scenario = context.session.scenario();
    let truths = axes.into_iter().enumerate().filter_map(|(at, axis)| Some((at, truth(axis, scenario)?, axis)));
    truths.filter(|(_, value, axis)| axis.place_of(*value).is_some()).map(|(at, value, _)| (at, value)).collect()
}

pub(super) fn truths_on(plot: &mut PlotUi<'_>, graph: &Graph, truths: &[(usize, f64)]) {
    for (at, value) in truths {
        let share = graph.scales[*at].share(*value);
        let end = |along: f64| graph.in_plot(if *at == 0 { [share, along] } else { [along, share] });
        line_on(plot, &[end(0.0), end(1.0)], LineStyle::Dashed { length: 6.0 });
    }
}

/// The dot of the present setting; it is at the edge if the setting is outside the map.
pub(super) fn dot_ui(
    ui: &Ui,
    key: &str,
    graph: &Graph,
    survey: &Survey,
    context: &ViewContext<'_>,
    requests: &mut Vec<Request>,
) {
    let palette = context.palette;
    let scenario = context.session.scenario();
    let present = survey.present(scenario);
    let at = graph.at(present);
    if !at.x.is_finite() || !at.y.is_finite() {
        return;
    }
    let place = graph.rect.clamp(at);
    if Medium::of(ui.ctx()) != Medium::Screen {
        return paint(ui, place, false, place == at, palette);
    }
    let reach = if ui.input(InputState::has_touch_screen) { GRASP.1 } else { GRASP.0 };
    let id = Id::unique(("dot of the map", key));
    let response = ui.interact(Rect::from_center_size(place, Vec2::splat(2.0 * reach)), id, Sense::drag());
    let [x, y] = [0, 1].map(|at| said(survey.axes()[at], present[at], survey));
    let name = format!("Setting on screen, {key}: {x}, {y}");
    response.ctx.accesskit_node_builder(id, |node| node.set_label(name));
    paint(ui, place, response.hovered() || response.dragged() || response.has_focus(), place == at, palette);
    let response = response.on_hover_cursor(CursorIcon::Grab);
    let mut moved = None;
    if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
        let shares = graph.shares(graph.rect.clamp(pointer));
        moved = Some([0, 1].map(|at| dragged(survey, at, shares[at])));
    }
    if response.has_focus() {
        let filter = EventFilter { horizontal_arrows: true, vertical_arrows: true, ..EventFilter::default() };
        ui.memory_mut(|memory| memory.set_focus_lock_filter(id, filter));
        let steps = ui.input(|input| {
            let count = |key: Key| input.num_presses(key) as f64;
            [count(Key::ArrowRight) - count(Key::ArrowLeft), count(Key::ArrowUp) - count(Key::ArrowDown)]
        });
        if steps != [0.0; 2] {
            moved = Some([0, 1].map(|at| stepped(survey.axes()[at], present[at], steps[at])));
        }
    }
    requests.extend(moved.and_then(|values| survey.with(scenario, values)).map(Request::Edit));
}

fn paint(ui: &Ui, at: egui::Pos2, is_lit: bool, is_inside: bool, palette: &Palette) {
    let painter = ui.painter();
    let radius = if is_lit { RADIUS + 1.5 } else { RADIUS };
    let fill = if is_inside { palette.warning } else { Color32::TRANSPARENT };
    painter.circle(at, radius, fill, Stroke::new(2.0, Color32::WHITE));
    painter.circle_stroke(at, radius + 1.4, Stroke::new(1.2, Color32::BLACK));
}

pub(super) fn said(axis: &Axis, value: f64, survey: &Survey) -> String {
    let scenario = survey.ensemble.scenario();
    let Ok(address) = Address::parse(scenario, &axis.key) else { return String::new() };
    let unit = unit_in(scenario, address.unit);
    format!("{} {} {unit}", address.name, significant(value, 4)).trim_end().to_owned()
}

/// The value at a share of an axis' scale: at most three digits, and not beyond the middles of the last cells.
fn dragged(survey: &Survey, at: usize, share: f64) -> f64 {
    let axis = survey.axes()[at];
    let steps = axis.count.saturating_sub(1).max(1) as f64;
    let value = axis.at_share(((share * axis.count as f64 - 0.5) / steps).clamp(0.0, 1.0));
    let rounded = parse(&significant(value, 3)).unwrap_or(value);
    let is_whole = survey.ensemble.settings().get(at).is_some_and(|address| address.is_whole);
    if is_whole { value.round() } else { rounded }
}

fn stepped(axis: &Axis, value: f64, steps: f64) -> f64 {
    if steps == 0.0 {
        return value;
    }
    let last = axis.count.saturating_sub(1);
    let place = (axis.share_of(value).clamp(0.0, 1.0) * last as f64).round() + steps;
    axis.value((place.max(0.0) as usize).min(last))
}

const POINT: f32 = 1.8;
const END: f32 = 4.0;

pub(super) struct TuningPath {
    pub(super) filter: usize,
    pub(super) points: Vec<[f64; 2]>,
}

pub(super) fn path_on(plot: &mut PlotUi<'_>, graph: &Graph, path: &TuningPath) {
    let shares = path.points.iter().map(|[x, y]| [graph.scales[0].share(*x), graph.scales[1].share(*y)]);
    let points: Vec<[f64; 2]> =
        shares.filter(|at| at.iter().all(|share| share.is_finite())).map(|at| graph.in_plot(at)).collect();
    let [first, .., last] = points[..] else { return };
    for (color, width) in [(Color32::from_black_alpha(200), 3.2), (Color32::WHITE, 1.4)] {
        plot.line(Line::new("path", points.clone()).color(color).width(width).allow_hover(false));
    }
    let dots = |at: Vec<[f64; 2]>, color: Color32, radius: f32| {
        Points::new("path", at).color(color).radius(radius).allow_hover(false)
    };
    plot.points(dots(points, Color32::WHITE, POINT));
    plot.points(dots(vec![first], Color32::WHITE, END + 0.8));
    plot.points(dots(vec![first], Color32::BLACK, END - 0.8));
    plot.points(dots(vec![last], Color32::BLACK, END + 1.6).shape(MarkerShape::Square));
    plot.points(dots(vec![last], Color32::WHITE, END).shape(MarkerShape::Square));
}

pub(super) type Piece = [[f64; 2]; 2];

pub(super) fn consistent(survey: &Survey, filter: usize) -> Vec<Piece> {
    let [across, up] = survey.axes().map(|axis| axis.count);
    let Some(column) = survey.column(filter, Measure::CONSISTENCY) else { return Vec::new() };
    let value = |cell: usize| survey.sheet.shown(cell).map_or(f64::NAN, |row| spread(row[column]));
    let values: Vec<f64> = (0..across * up).map(value).collect();
    [-CONSISTENT, CONSISTENT].into_iter().flat_map(|level| edge(&values, across, up, spread(level))).collect()
}

/// The lines on which numbers at the middles of cells, the second axis fastest, have a level: marching squares, after
/// Lorensen and Cline (1987). A square with a NaN at a corner has no line.
fn edge(values: &[f64], across: usize, up: usize, level: f64) -> Vec<Piece> {
    let at = |x: usize, y: usize| values[x * up + y] - level;
    let mut pieces = Vec::new();
    for x in 0..across.saturating_sub(1) {
        for y in 0..up.saturating_sub(1) {
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            let heights = corners.map(|(x, y)| at(x, y));
            if heights.iter().any(|height| height.is_nan()) {
                continue;
            }
            let mut crossings = Vec::with_capacity(4);
            for side in 0..4 {
                let (a, b) = (heights[side], heights[(side + 1) % 4]);
                if (a < 0.0) != (b < 0.0) {
                    let share = a / (a - b);
                    let ((x0, y0), (x1, y1)) = (corners[side], corners[(side + 1) % 4]);
                    let mix = |from: usize, to: usize| from as f64 + share * (to as f64 - from as f64);
                    crossings.push([mix(x0, x1), mix(y0, y1)]);
                }
            }
            // At a saddle there are four crossings, and either way to join them would be right.
            pieces.extend(crossings.chunks_exact(2).map(|pair| [pair[0], pair[1]]));
        }
    }
    pieces
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_around_a_hill_is_a_circle() {
        let n = 41;
        let radius = |x: f64, y: f64| (x - 20.0).hypot(y - 20.0);
        let values: Vec<f64> = (0..n * n).map(|cell| radius((cell / n) as f64, (cell % n) as f64)).collect();
        let pieces = edge(&values, n, n, 12.3);
        assert!(pieces.len() > 60, "{}", pieces.len());
        for [x, y] in pieces.iter().flatten() {
            assert!((radius(*x, *y) - 12.3).abs() < 0.05, "{x} {y}");
        }
        let length: f64 = pieces.iter().map(|[[a, b], [c, d]]| (a - c).hypot(b - d)).sum();
        assert!((length / (std::f64::consts::TAU * 12.3) - 1.0).abs() < 0.02, "{length}");
    }

    #[test]
    fn there_is_no_line_at_cells_without_a_number() {
        let values = [0.0, 1.0, f64::NAN, 1.0];
        assert!(edge(&values, 2, 2, 0.5).is_empty());
        assert_eq!(edge(&[0.0, 1.0, 0.0, 1.0], 2, 2, 0.5), [[[1.0, 0.5], [0.0, 0.5]]]);
    }
}
