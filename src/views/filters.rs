//! The numbers of all filters side by side.

use egui::{Grid, Id, RichText, ScrollArea, Ui, vec2};
use kalmanscope_core::sorting::sort_short_by_key;
use kalmanscope_core::{Channel, FilterSettings, InputKind, Scenario};

use crate::controls::color::color_of;
use crate::controls::number::{Named, field};
use crate::request::Request;
use crate::theme::{self, Palette};
use crate::view::{View, ViewContext};

/// The width of a number \[points\].
const CELL: f32 = 72.0;

/// A number under way from one filter to another.
struct Dragged {
    /// The name of its row.
    row: String,
    value: f64,
}

/// Rows are numbers, columns filters.
pub(super) struct Filters;

impl View for Filters {
    fn name(&self) -> &'static str {
        "Filter settings"
    }

    fn help(&self) -> [&'static str; 3] {
        [
            "What the filters are told, side by side: rows are numbers, columns filters; each number can be dragged or typed.",
            "Numbers that differ from the first filter's are tinted, so that it is plain in what two filters differ.",
            "The sign = beside a number can be dragged onto another filter's number of that row, and the name of a filter onto another: that is then the same.",
        ]
    }

    fn ui(&self, ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
        let mut scenario = context.session.scenario().clone();
        if scenario.filters.is_empty() {
            ui.weak("There is no filter: add one in the settings.");
        }
        ScrollArea::both().auto_shrink(false).show(ui, |ui| {
            Grid::new("filter settings").striped(true).spacing([10.0, 3.0]).show(ui, |ui| {
                ui.label("");
                names_ui(ui, &mut scenario, context.palette);
                ui.end_row();
                for row in rows(&scenario) {
                    ui.label(RichText::new(&row.symbol).weak()).on_hover_text(row.name.as_str());
                    row_ui(ui, &row, &mut scenario.filters, context.palette);
                    ui.end_row();
                }
            });
        });
        if &scenario != context.session.scenario() {
            requests.push(Request::Edit(Box::new(scenario)));
        }
        None
    }
}

/// The filters' names. Dropping one on another copies its settings to that one.
fn names_ui(ui: &mut Ui, scenario: &mut Scenario, palette: &Palette) {
    let mut same = None;
    for (place, filter) in scenario.filters.iter().enumerate() {
        let color = palette.shade(color_of(filter));
        let source = ui.dnd_drag_source(Id::unique(("numbers of", filter.id)), filter.id, |ui| {
            ui.label(RichText::new(&filter.name).family(theme::strong()).color(color));
        });
        let name = source.response.on_hover_text("Drag it onto another filter, which then has the same numbers");
        if let Some(id) = name.dnd_release_payload::<u32>() {
            same = Some((*id, place));
        }
    }
    if let Some((id, place)) = same
        && let Some(from) = scenario.filters.iter().find(|filter| filter.id == id).cloned()
    {
        let FilterSettings { id, name, color, .. } = scenario.filters[place].clone();
        scenario.filters[place] = FilterSettings { id, name, color, kind: scenario.filters[place].kind, ..from };
    }
}

/// A number of a filter, if the filter has it.
type Of = Box<dyn Fn(&mut FilterSettings) -> Option<&mut f64>>;

/// A number that each filter has, or may have.
struct Row {
    symbol: String,
    name: String,
    least: f64,
    scale: f64,
    of: Of,
}

fn rows(scenario: &Scenario) -> Vec<Row> {
    let mut rows = Vec::new();
    let mut add = |symbol: String, name: &str, least, scale, of: Of| {
        rows.push(Row { symbol, name: name.to_owned(), least, scale, of });
    };
    add("λ".into(), "fading factor", 1.0, 1.0, Box::new(|filter| Some(&mut filter.fading)));
    add("η [1/s]".into(), "decay", 0.0, 0.1, Box::new(|filter| Some(&mut filter.eta)));
    for (i, sensor) in scenario.sensors.iter().enumerate() {
        let quantity = sensor.measures;
        let name = format!("sensor std of {}", quantity.key());
        add(
            format!("√R {}", quantity.symbol()),
            &name,
            1e-9,
            1.0,
            Box::new(move |filter| filter.sensor_std.get_mut(i)),
        );
    }
    let mut channels: Vec<Channel> = Vec::new();
    for filter in &scenario.filters {
        let model = filter.model(scenario.plant.kind, InputKind::Force);
        channels
            .extend(model.channels().iter().filter(|channel| !channels.contains(channel)).copied().collect::<Vec<_>>());
    }
    sort_short_by_key(&mut channels, |channel| !channel.is_parameter());
    for channel in channels {
        let (symbol, scale) = (channel.symbol(), channel.usual().std.max(1e-3));
        let of = |what: &str| format!("{what} of {}", channel.name());
        add(
            format!("guess {symbol}"),
            &of("initial guess"),
            f64::NEG_INFINITY,
            scale,
            Box::new(move |filter| Some(&mut filter.initial_mean[channel])),
        );
        add(
            format!("± σ {symbol}"),
            &of("initial std"),
            0.0,
            scale,
            Box::new(move |filter| (!filter.knows(channel)).then(|| &mut filter.initial_std[channel])),
        );
        add(
            format!("√Q {symbol}"),
            &of("process std"),
            0.0,
            scale,
            Box::new(move |filter| (!filter.knows(channel)).then(|| &mut filter.process_std[channel])),
        );
    }
    rows
}

fn row_ui(ui: &mut Ui, row: &Row, filters: &mut [FilterSettings], palette: &Palette) {
    let first = filters.first_mut().and_then(|filter| (row.of)(filter).copied());
    for filter in filters {
        let name = format!("{}: {}", filter.name, row.name);
        let id = filter.id;
        ui.horizontal(|ui| {
            let Some(value) = (row.of)(filter) else {
                ui.weak("known");
                return;
            };
            ui.spacing_mut().item_spacing.x = 3.0;
            same_ui(ui, id, row, *value, &name);
            let size = vec2(CELL, ui.spacing().interact_size.y);
            let cell = ui.allocate_ui(size, |ui| {
                ui.set_width(CELL);
                if first.is_some_and(|first| first != *value) {
                    let tint = palette.accent.gamma_multiply(0.3);
                    ui.visuals_mut().widgets.inactive.weak_bg_fill = tint;
                    ui.visuals_mut().widgets.inactive.bg_fill = tint;
                }
                let key = format!("filters#{id}: {}", row.name);
                field(ui, value, row.least, row.scale, Named { text: &name, key: &key }, &row.name)
            });
            if let Some(dragged) = cell.inner.dnd_release_payload::<Dragged>().filter(|dragged| dragged.row == row.name)
            {
                *value = dragged.value.max(row.least);
            }
        });
    }
}

/// The handle for dragging a number to another filter.
fn same_ui(ui: &mut Ui, filter: u32, row: &Row, value: f64, name: &str) {
    let dragged = Dragged { row: row.name.clone(), value };
    let source = ui.dnd_drag_source(Id::unique(("same as", filter, &row.name)), dragged, |ui| ui.weak("="));
    let (sign, grip) = (source.inner, source.response);
    sign.ctx.accesskit_node_builder(sign.id, |node| node.set_value(format!("Same as {name}")));
    grip.on_hover_text("Drag it onto another filter's number of this row, which is then the same");
}
