//! The numbers of all filters side by side.

use egui::{Grid, Id, RichText, ScrollArea, Ui, vec2};
use kalmanscope_core::setting::{
    Address, Change, Entry, INITIAL_MEAN, INITIAL_STD, PROCESS_STD, SENSOR_STD, SettingInfo, TableInfo, of_filter,
};
use kalmanscope_core::{FilterSettings, Scenario};
use kalmanscope_lab::channels;

use crate::controls::Edits;
use crate::controls::filter::color_of;
use crate::controls::number::{Named, field_ui};
use crate::request::Request;
use crate::theme::{self, Palette};
use crate::view::{View, ViewContext};

const CELL: f32 = 72.0;

struct Dragged {
    row: String,
    value: f64,
}

pub(super) static VIEW: View = View {
    name: "Filter settings",
    help: [
        "The settings of all filters side by side. Drag a number, or type it.",
        "Numbers that differ from the first filter's are tinted.",
        "Drag the sign = beside a number onto another filter's number of the same row to copy it.",
    ],
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, requests: &mut Vec<Request>) -> Option<f64> {
    let mut edits = Edits { scenario: context.session.shared_scenario(), change: Change::default() };
    let scenario = edits.scenario;
    if scenario.filters.is_empty() {
        ui.weak("There is no filter: add one in the settings.");
    }
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        Grid::new("filter settings").striped(true).spacing([10.0, 3.0]).show(ui, |ui| {
            ui.label("");
            for filter in &scenario.filters {
                let color = context.palette.shade(color_of(filter));
                ui.label(RichText::new(&filter.name).family(theme::strong()).color(color));
            }
            ui.end_row();
            for row in rows(scenario) {
                ui.label(RichText::new(&row.symbol).weak()).on_hover_text(row.name.as_str());
                row_ui(ui, &row, &mut edits, context.palette);
                ui.end_row();
            }
        });
    });
    requests.extend(Request::edit(edits.change));
    None
}

struct ParameterRow {
    key: String,
    symbol: String,
    name: String,
    least: f64,
    scale: f64,
}

fn rows(scenario: &Scenario) -> Vec<ParameterRow> {
    let mut rows = Vec::new();
    for info in of_filter().filter(|info| info.is_varied) {
        let SettingInfo { key, symbol, name, unit, allowed, slider: (_, scale), .. } = *info;
        let symbol = if unit.is_empty() { symbol.to_owned() } else { format!("{symbol} [{unit}]") };
        rows.push(ParameterRow { key: key.to_owned(), symbol, name: name.to_owned(), least: allowed.least(), scale });
    }
    let mut add = |table: &TableInfo, entry: Entry, scale: f64| {
        rows.push(ParameterRow {
            key: format!("{}.{}", table.key, entry.key()),
            symbol: format!("{} {}", table.symbol, entry.symbol()),
            name: format!("{} of {}", table.name, entry.name()),
            least: table.allowed.least(),
            scale,
        });
    };
    scenario.sensors.iter().for_each(|sensor| add(&SENSOR_STD, Entry::Sensor(sensor.measures), 1.0));
    let mut channels = channels(scenario, &(0..scenario.filters.len()).collect::<Vec<_>>());
    channels.sort_by_key(|channel| !channel.is_parameter());
    for channel in channels {
        for table in [&INITIAL_MEAN, &INITIAL_STD, &PROCESS_STD] {
            add(table, Entry::Channel(channel), channel.usual().std.max(1e-3));
        }
    }
    rows
}

fn address(row: &ParameterRow, scenario: &Scenario, filter: &FilterSettings) -> Result<Address, [&'static str; 2]> {
    let address = Address::parse(scenario, &filter.address(&row.key));
    let address = address.map_err(|_| ["–", "This filter does not have the number"])?;
    let is_std = address.table.is_some_and(|table| table.factor.is_some());
    if is_std && address.channel.is_some_and(|channel| filter.knows(channel)) {
        return Err(["known", "This filter takes the number for known"]);
    }
    Ok(address)
}

fn row_ui(ui: &mut Ui, row: &ParameterRow, edits: &mut Edits<'_>, palette: &Palette) {
    let scenario = edits.scenario;
    let mut first = None;
    for place in 0..scenario.filters.len() {
        let filter = &scenario.filters[place];
        let (id, name) = (filter.id, format!("{}: {}", filter.name, row.name));
        let address = address(row, scenario, filter);
        ui.horizontal(|ui| {
            let address = match address {
                Ok(address) => address,
                Err([word, hint]) => {
                    ui.weak(word).on_hover_text(hint);
                    return;
                }
            };
            let mut value = address.get(scenario);
            let is_other = *first.get_or_insert(value) != value;
            ui.spacing_mut().item_spacing.x = 3.0;
            same_ui(ui, id, row, value, &name);
            let size = vec2(CELL, ui.spacing().interact_size.y);
            let cell = ui.allocate_ui(size, |ui| {
                ui.set_width(CELL);
                if is_other {
                    let tint = palette.accent.gamma_multiply(0.3);
                    ui.visuals_mut().widgets.inactive.weak_bg_fill = tint;
                    ui.visuals_mut().widgets.inactive.bg_fill = tint;
                }
                let key = format!("filters#{id}: {}", row.name);
                field_ui(ui, &mut value, row.least, row.scale, Named { text: &name, key: &key }, &row.name)
            });
            if let Some(dragged) = cell.inner.dnd_release_payload::<Dragged>().filter(|dragged| dragged.row == row.name)
            {
                value = dragged.value.max(row.least);
            }
            if value != address.get(scenario) {
                edits.change.set_at(address, value);
            }
        });
    }
}

fn same_ui(ui: &mut Ui, filter: u32, row: &ParameterRow, value: f64, name: &str) {
    let dragged = Dragged { row: row.name.clone(), value };
    let source = ui.dnd_drag_source(Id::unique(("same as", filter, &row.name)), dragged, |ui| ui.weak("="));
    let (sign, grip) = (source.inner, source.response);
    sign.ctx.accesskit_node_builder(sign.id, |node| node.set_value(format!("Same as {name}")));
    grip.on_hover_text("Drag it onto another filter's number to copy it");
}
