//! Several charts in one view.

use egui::Ui;

use super::cells::cells_ui;
use super::chart::Chart;
use super::input::PlotInput;
use crate::request::Request;

/// Fills `ui` with charts, or with the enlarged one. Returns the time under the pointer \[s\].
pub(crate) fn charts_ui(
    ui: &mut Ui,
    charts: Vec<Chart<'_>>,
    input: &PlotInput<'_>,
    requests: &mut Vec<Request>,
) -> Option<f64> {
    let count = charts.len();
    let id = ui.scope_id().with("alone");
    let mut alone: Option<usize> = ui.data(|data| data.get_temp(id)).filter(|place| *place < count);
    let (first, shown) = alone.map_or((0, count), |place| (place, 1));
    let mut pointed = None;
    let mut charts = charts.into_iter().skip(first);
    cells_ui(ui, shown, &mut |ui, i, last_row| {
        let Some(chart) = charts.next() else { return };
        let response = chart.show(ui, input, last_row, requests);
        pointed = response.pointed.or(pointed);
        if response.alone {
            alone = if alone.is_none() { Some(first + i) } else { None };
        }
    });
    ui.data_mut(|data| match alone {
        Some(place) => *data.get_temp_mut_or_default(id) = place,
        None => data.remove::<usize>(id),
    });
    pointed
}
