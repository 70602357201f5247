//! Several charts in one view.

use egui::Ui;

use super::chart::Chart;
use super::{ViewContext, grid};
use crate::command::Command;

/// Fills `ui` with charts, or with the one that the user wants to see alone. `chart` makes one from its number and from
/// whether none is below it. Returns the time that the user points at \[s\].
pub(super) fn charts_ui<'a>(
    ui: &mut Ui,
    count: usize,
    context: &ViewContext<'a>,
    commands: &mut Vec<Command>,
    chart: impl Fn(usize, bool) -> Chart<'a>,
) -> Option<f64> {
    let id = ui.scope_id().with("alone");
    let mut alone: Option<usize> = ui.data(|data| data.get_temp(id)).filter(|place| *place < count);
    let (first, shown) = alone.map_or((0, count), |place| (place, 1));
    let mut pointed = None;
    grid(ui, shown, |ui, i, last_row| {
        let seen = chart(first + i, last_row).show(ui, context, commands);
        pointed = seen.pointed.or(pointed);
        if seen.alone {
            alone = if alone.is_none() { Some(first + i) } else { None };
        }
    });
    ui.data_mut(|data| match alone {
        Some(place) => *data.get_temp_mut_or_default(id) = place,
        None => data.remove::<usize>(id),
    });
    pointed
}
