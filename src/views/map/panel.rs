//! One panel: its title, the cells, the axes, the bar of colours, and its gestures.

use egui::{Rect, RichText, Sense, TextStyle, Tooltip, Ui, UiBuilder, pos2, vec2};
use kalmanscope_core::{Measure, Spacing};

use super::bar::{self, bar_ui};
use super::marks::{contour_ui, dot_ui, hatching_ui, said, truth_ui, truths};
use super::path::{Path, path_ui};
use super::picture::{Contents, Panel};
use super::profile;
use super::scale::CONSISTENT;
use crate::controls::filter::color_of;
use crate::laboratory::{Survey, measure_label, setting_label};
use crate::plot::graph::{Graph, Scale};
use crate::plot::medium::Medium;
use crate::request::Request;
use crate::text::significant;
use crate::theme;
use crate::view::ViewContext;

/// The height of a panel's title \[points\].
const TITLE: f32 = 17.0;

const OLD: f32 = 0.55;

pub(super) struct PanelView<'a> {
    pub(super) panel: &'a Panel,
    pub(super) survey: &'a Survey,
    pub(super) measure: Measure,
    pub(super) path: Option<&'a Path>,
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
        let bar = if has_bar { bar::room(&panel.colors) } else { 0.0 };
        let below = Rect::from_min_max(room.min + vec2(0.0, TITLE), room.max - vec2(bar, 0.0));
        let strip = profile::room(below.size(), self.measure);
        let below = Rect::from_min_max(below.min + vec2(0.0, strip), below.max - vec2(strip, 0.0));
        let [x, y] =
            axes.map(|axis| Scale::of_cells(axis.from, axis.to, axis.count, axis.spacing == Spacing::Logarithmic));
        let graph = Graph::new(below, x, y);
        let scenario = survey.ensemble.scenario();
        let names = axes.map(|axis| setting_label(&axis.key, scenario));
        ui.painter().extend(panel.shapes(&graph, if is_old { OLD } else { 1.0 }));
        hatching_ui(ui, &graph, &panel.hatching(&graph));
        graph.axes_ui(ui, names.each_ref().map(String::as_str), context.palette, false);
        contour_ui(ui, &graph, axes, &panel.contour);
        truth_ui(ui, &graph, &truths(axes, context));
        if let Some(path) = path.filter(|path| panel.contents == Contents::Filter(path.filter)) {
            path_ui(ui, &graph, path);
        }
        if strip > 0.0 {
            profile::profiles_ui(ui, &graph, panel, survey, context);
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
        let left = pos2(room.left() + 58.0, room.top() + 0.5 * TITLE);
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
            let chosen = survey.with(scenario, [values[0], values[1]]);
            requests.extend(chosen.and_then(|chosen| Request::edit(scenario, &chosen)));
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
            let score = super::legend::score_text(*measure, value(*measure), survey.ensemble.scenario());
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
