//! One panel: its title, the cells, the axes, the bar of colours, and its gestures.

use egui::{Pos2, Rect, RichText, Sense, Shape, Stroke, TextStyle, Tooltip, Ui, UiBuilder, Vec2, pos2, vec2};
use kalmanscope_core::{Axis, Scenario, Spacing};
use kalmanscope_diagnosis::CAUSES;
use kalmanscope_diagnosis::{Measure, ValueKind, VerdictKind};

use super::marks::{TuningPath, contour_on, dot_ui, path_on, said, truths, truths_on};
use super::picture::{Contents, MapPanel};
use super::scale::{CONSISTENT, Graph, bar_room, bar_ui};
use crate::controls::filter::color_of;
use crate::laboratory::{Survey, measure_label, setting_label};
use crate::plot::axes::ValueScale;
use crate::plot::medium::{Medium, Y_AXIS};
use crate::plot::plane::Plane;
use crate::request::Request;
use crate::text::{significant, unit_in};
use crate::theme::{self, Palette};
use crate::view::ViewContext;

const TITLE: f32 = 17.0;

const OLD: f32 = 0.55;

pub(super) struct PanelView<'a> {
    pub(super) panel: &'a MapPanel,
    pub(super) survey: &'a Survey,
    pub(super) measure: Measure,
    pub(super) path: Option<&'a TuningPath>,
    pub(super) is_old: bool,
    pub(super) has_bar: bool,
}

impl PanelView<'_> {
    pub(super) fn ui(&self, ui: &mut Ui, room: Rect, context: &ViewContext<'_>, requests: &mut Vec<Request>) {
        let Self { panel, survey, measure: _, path, is_old, has_bar } = *self;
        let axes = survey.axes();
        let mut ui = ui.new_child(UiBuilder::new().id_salt(self.key()).max_rect(room));
        let ui = &mut ui;
        self.title_ui(ui, room, context);
        let bar = if has_bar { bar_room(&panel.colors) } else { 0.0 };
        let below = Rect::from_min_max(room.min + vec2(0.0, TITLE), room.max - vec2(bar, 0.0));
        let strip = profile_room(below.size(), self.measure);
        let below = Rect::from_min_max(below.min + vec2(0.0, strip), below.max - vec2(strip, 0.0));
        let cells = ui.painter().add(Shape::Noop);
        let path = path.filter(|path| panel.contents == Contents::Filter(path.filter));
        let graph = self.plot_ui(ui, below, context.palette, (&truths(axes, context), path));
        ui.painter().set(cells, Shape::Vec(panel.shapes(&graph, if is_old { OLD } else { 1.0 })));
        if strip > 0.0 {
            profiles_ui(ui, &graph, panel, survey, context);
        }
        if has_bar {
            let beside = graph.rect.with_max_x(graph.rect.right() + strip);
            bar_ui(ui, beside, &panel.colors, context.palette);
        }
        if Medium::of(ui.ctx()) == Medium::Screen {
            self.gestures(ui, &graph, context, requests);
        }
        dot_ui(ui, &self.key(), &graph, survey, context, requests);
    }

    fn plot_ui(
        &self,
        ui: &mut Ui,
        room: Rect,
        palette: &Palette,
        (truths, path): (&[(usize, f64)], Option<&TuningPath>),
    ) -> Graph {
        let axes = self.survey.axes();
        let scales =
            axes.map(|axis| ValueScale::of_cells(axis.from, axis.to, axis.count, axis.spacing == Spacing::Logarithmic));
        let names = axes.map(|axis| setting_label(&axis.key, self.survey.ensemble.scenario()));
        let [[left, right], [low, high]] = scales.map(|scale| [scale.ends.0, scale.ends.1]);
        let plane = Plane {
            logarithmic: scales.map(|scale| scale.is_logarithmic),
            ..Plane::linear("map", names.each_ref().map(String::as_str))
        };
        let mut child = ui.new_child(UiBuilder::new().id_salt("axes").max_rect(room));
        let plot = plane.plot(&mut child, palette).show_grid(false).sense(Sense::hover()).allow_drag(false);
        let plot = plot.allow_zoom(false).allow_boxed_zoom(false).invert_x(left > right).invert_y(low > high);
        let plot = plot.show(&mut child, |plot| {
            plot.set_plot_bounds_x(left.min(right)..=left.max(right));
            plot.set_plot_bounds_y(low.min(high)..=low.max(high));
            let graph = Graph { rect: Rect::NOTHING, scales };
            contour_on(plot, &graph, self.panel.counts, &self.panel.contour);
            truths_on(plot, &graph, truths);
            path.iter().for_each(|path| path_on(plot, &graph, path));
        });
        Graph { rect: *plot.transform.frame(), scales }
    }

    fn key(&self) -> String {
        match self.panel.contents {
            Contents::Filter(at) => self.survey.ensemble.scenario().filters[at].name.clone(),
            Contents::Comparison => "comparison".to_owned(),
        }
    }

    fn title_ui(&self, ui: &Ui, room: Rect, context: &ViewContext<'_>) {
        let Self { panel, survey, measure, .. } = self;
        let filters = &survey.ensemble.scenario().filters;
        let label = measure_label(*measure, survey.ensemble.scenario());
        let text = match (panel.contents, &filters[..]) {
            (Contents::Comparison, [a, b, ..]) if measure.info().kind.is_ratio() => format!("{} ÷ {}", a.name, b.name),
            (Contents::Comparison, [a, b, ..]) => format!("{} − {}", a.name, b.name),
            (Contents::Filter(at), _) if filters.len() > 1 => format!("{}: {label}", filters[at].name),
            _ => label,
        };
        let left = pos2(room.left() + Y_AXIS, room.top() + 0.5 * TITLE);
        let mut start = left;
        if let (Contents::Filter(at), true) = (panel.contents, filters.len() > 1) {
            let own = context.session.scenario().filters.iter().find(|filter| filter.id == survey.filters[at]);
            if let Some(own) = own {
                ui.painter().circle_filled(left + vec2(4.0, 0.0), 4.0, context.palette.shade(color_of(own)));
                start.x += 13.0;
            }
        }
        let font = TextStyle::Small.resolve(ui.style());
        let galley = |text: String| ui.painter().layout_no_wrap(text, font.clone(), context.palette.text);
        let whole = galley(text);
        // The score may lack room here: the menu above names it too.
        let text = match (panel.contents, &filters[..]) {
            (Contents::Filter(at), [_, _, ..]) if start.x + whole.size().x > room.right() => {
                galley(filters[at].name.clone())
            }
            _ => whole,
        };
        let corner = start - vec2(0.0, 0.5 * text.size().y);
        ui.painter().galley(corner, text, context.palette.text);
    }

    fn gestures(&self, ui: &Ui, graph: &Graph, context: &ViewContext<'_>, requests: &mut Vec<Request>) {
        let Self { survey, measure, .. } = self;
        let id = egui::Id::unique(("cells of the map", self.key()));
        let response = ui.interact(graph.rect, id, Sense::click());
        let name = format!("Map of {}, {}", self.key(), measure_label(*measure, survey.ensemble.scenario()));
        response.ctx.accesskit_node_builder(id, |node| node.set_label(name));
        let Some(pointer) = response.hover_pos().or(response.interact_pointer_pos()) else { return };
        let shares = graph.shares(graph.rect.clamp(pointer));
        let ensemble = &survey.ensemble;
        let counts = ensemble.counts();
        let place = |at: usize| ((shares[at] * counts[at] as f64) as usize).min(counts[at] - 1);
        let cell = ensemble.cell(&[place(0), place(1)]);
        let values = ensemble.values(cell);
        if response.clicked() {
            let scenario = context.session.scenario();
            requests.extend(survey.with(scenario, [values[0], values[1]]).map(Request::Edit));
        }
        if response.hovered() {
            Tooltip::for_widget(&response).at_pointer().gap(12.0).show(|ui| self.cell_ui(ui, cell, &values));
        }
    }

    fn cell_ui(&self, ui: &mut Ui, cell: usize, values: &[f64]) {
        let Self { survey, measure, .. } = self;
        ui.style_mut().override_text_style = Some(TextStyle::Small);
        ui.spacing_mut().item_spacing.y = 1.0;
        for (axis, value) in survey.axes().into_iter().zip(values) {
            ui.label(said(axis, *value, survey));
        }
        for (at, filter) in survey.ensemble.scenario().filters.iter().enumerate() {
            let value = |measure: Measure| survey.value(cell, at, measure).unwrap_or(f64::NAN);
            ui.label(RichText::new(&filter.name).family(theme::strong()));
            let score = score_text(*measure, value(*measure), survey.ensemble.scenario());
            ui.label(format!("{}: {score}", measure.name()));
            let is_inside = value(Measure::CONSISTENCY).abs() < CONSISTENT;
            let end = if value(Measure::STOPPED) == 1.0 {
                "it stopped".to_owned()
            } else if value(Measure::DIVERGED) == 1.0 {
                "it lost the truth".to_owned()
            } else {
                let nis = significant(value(Measure::NIS), 3);
                format!("mean NIS {nis}, {} its 99 % interval", if is_inside { "inside" } else { "outside" })
            };
            ui.label(end);
        }
        ui.weak("Click: this setting");
    }
}

/// The height of a curve, and its distance from the cells \[points\].
const HEIGHT: f32 = 40.0;
const APART: f32 = 6.0;

/// The least size of a panel with curves beside its cells \[points\].
const LEAST: Vec2 = Vec2::new(380.0, 190.0);

/// Zero if the cells need the room, or if the score is no number.
pub(super) fn profile_room(size: Vec2, measure: Measure) -> f32 {
    let has_room = size.x >= LEAST.x && size.y >= LEAST.y;
    if has_room && !measure.info().kind.is_of_kinds() { HEIGHT + APART } else { 0.0 }
}

pub(super) fn profiles_ui(ui: &Ui, graph: &Graph, panel: &MapPanel, survey: &Survey, context: &ViewContext<'_>) {
    let palette = context.palette;
    let axes = survey.axes();
    let present = survey.present(context.session.scenario());
    let color = match panel.contents {
        Contents::Filter(at) => {
            let id = survey.filters[at];
            let own = context.session.scenario().filters.iter().find(|filter| filter.id == id);
            own.map_or(palette.text, |filter| palette.shade(color_of(filter)))
        }
        Contents::Comparison => palette.text,
    };
    let cells = graph.rect;
    let above = Rect::from_x_y_ranges(cells.x_range(), cells.top() - APART - HEIGHT..=cells.top() - APART);
    let beside = Rect::from_x_y_ranges(cells.right() + APART..=cells.right() + APART + HEIGHT, cells.y_range());
    let [across, up] = [0, 1].map(|at| nearest(axes[at], present[at]));
    for (at, rect) in [above, beside].into_iter().enumerate() {
        let place = |along: f64, score: f64| match at {
            0 => pos2(graph.at_shares([along, 0.0]).x, rect.bottom() - score as f32 * HEIGHT),
            _ => pos2(rect.left() + score as f32 * HEIGHT, graph.at_shares([0.0, along]).y),
        };
        let painter = ui.painter();
        painter.line_segment([place(0.0, 0.0), place(1.0, 0.0)], Stroke::new(1.0, palette.grid));
        let count = panel.counts[at];
        let point = |step: usize| {
            let cell = if at == 0 { step * panel.counts[1] + up } else { across * panel.counts[1] + step };
            let share = panel.colors.share(panel.cells[cell].value).clamp(0.0, 1.0);
            share.is_finite().then(|| place((step as f64 + 0.5) / count as f64, share))
        };
        let points: Vec<Option<Pos2>> = (0..count).map(point).collect();
        for part in points.split(Option::is_none) {
            let part: Vec<Pos2> = part.iter().flatten().copied().collect();
            match part[..] {
                [alone] => _ = painter.circle_filled(alone, 1.5, color),
                _ => _ = painter.add(Shape::line(part, Stroke::new(1.8, color))),
            }
        }
        let response = ui.interact(rect, ui.scope_id().with(("profile", at)), Sense::hover());
        let name = ["Score across", "Score up"][at];
        response.ctx.accesskit_node_builder(response.id, |node| {
            node.set_label(format!("{name}, through the dot"));
            let [x0, y0, x1, y1] = [rect.left(), rect.top(), rect.right(), rect.bottom()].map(f64::from);
            node.set_bounds(egui::accesskit::Rect { x0, y0, x1, y1 });
        });
    }
}

fn nearest(axis: &Axis, value: f64) -> usize {
    let last = axis.count.saturating_sub(1);
    ((axis.share_of(value).clamp(0.0, 1.0) * last as f64).round() as usize).min(last)
}

fn score_text(measure: Measure, value: f64, scenario: &Scenario) -> String {
    match measure.info().kind {
        ValueKind::Flag if !value.is_nan() => if value == 0.0 { "no" } else { "yes" }.to_owned(),
        ValueKind::Verdict => {
            let kind = (value >= 0.0).then(|| VerdictKind::ALL.get(value as usize)).flatten();
            kind.map_or("not known", |kind| kind.name()).to_owned()
        }
        ValueKind::Cause => {
            let cause = (value >= 0.0).then(|| CAUSES.get(value as usize)).flatten();
            cause.map_or("none", |cause| cause.name).to_owned()
        }
        ValueKind::Time if value == f64::INFINITY => "never".to_owned(),
        _ => format!("{} {}", significant(value, 4), unit_in(scenario, measure.unit())).trim_end().to_owned(),
    }
}
