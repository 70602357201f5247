//! The rows of causes, which do not move under the pointer.

use std::sync::Arc;

use egui::Ui;
use kalmanscope_core::diagnosis::Remedy;

use crate::session::Attempt;

#[derive(Clone)]
struct Rows {
    picture: u64,
    remedies: Arc<Vec<Remedy>>,
}

/// The rows to show: the remedies in their order, or, while the pointer is on the view, the rows of the last frame with
/// new remedies after them.
pub(super) fn on_screen(ui: &Ui, attempt: &Attempt, is_held: bool) -> Arc<Vec<Remedy>> {
    let id = ui.scope_id().with("rows of causes");
    let before = ui.data(|data| data.get_temp::<Rows>(id));
    // Rows of other settings are dropped.
    let before = before.filter(|rows| is_held && rows.picture == attempt.picture());
    let remedies = match before {
        Some(before) => with_new(before.remedies, &attempt.remedies),
        None => Arc::new(attempt.remedies.to_vec()),
    };
    let rows = Rows { picture: attempt.picture(), remedies: Arc::clone(&remedies) };
    ui.data_mut(|data| data.insert_temp(id, rows));
    remedies
}

pub(super) fn is_in_order(rows: &[Remedy], attempt: &Attempt) -> bool {
    let same = |(row, remedy): (&Remedy, &Remedy)| row.edits == remedy.edits && key(row) == key(remedy);
    rows.len() == attempt.remedies.len() && rows.iter().zip(&attempt.remedies).all(same)
}

fn with_new(mut rows: Arc<Vec<Remedy>>, remedies: &[Remedy]) -> Arc<Vec<Remedy>> {
    for remedy in remedies {
        if rows.iter().all(|row| key(row) != key(remedy)) {
            Arc::make_mut(&mut rows).push(remedy.clone());
        }
    }
    rows
}

fn key(remedy: &Remedy) -> &'static str {
    remedy.first.cause.key
}
