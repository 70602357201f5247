//! Several charts in one view.

use egui::Ui;

use super::cells::cells_ui;
use super::chart::Chart;
use super::input::PlotInput;
use crate::request::Request;

/// Fills `ui` with charts, or with the enlarged one. `chart` makes a chart from its number and from whether it is the
/// lowest. Returns the time under the pointer \[s\].
pub(crate) fn charts_ui<'a>(
    ui: &mut Ui,
    count: usize,
    input: &PlotInput<'_>,
    requests: &mut Vec<Request>,
    chart: &dyn Fn(usize, bool) -> Chart<'a>,
) -> Option<f64> {
    let id = ui.scope_id().with("alone");
    let mut alone: Option<usize> = ui.data(|data| data.get_temp(id)).filter(|place| *place < count);
    let (first, shown) = alone.map_or((0, count), |place| (place, 1));
    let mut pointed = None;
    cells_ui(ui, shown, &mut |ui, i, last_row| {
        let response = chart(first + i, last_row).show(ui, input, requests);
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
