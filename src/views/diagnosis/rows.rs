//! The rows of causes, which do not move under the pointer.

use std::sync::Arc;

use egui::Ui;
use kalmanscope_core::diagnosis::Finding;

use crate::session::Attempt;

/// The rows of the last frame, and the number of their picture.
#[derive(Clone)]
struct Rows {
    picture: u64,
    findings: Arc<Vec<Finding>>,
}

/// The rows to show: the findings in their order, or, while the pointer is on the view, the rows of the last frame with
/// new findings after them.
pub(super) fn on_screen(ui: &Ui, attempt: &Attempt, is_held: bool) -> Arc<Vec<Finding>> {
    let id = ui.scope_id().with("rows of causes");
    let before = ui.data(|data| data.get_temp::<Rows>(id));
    // Rows of other settings are dropped.
    let before = before.filter(|rows| is_held && rows.picture == attempt.picture());
    let findings = match before {
        Some(before) => with_new(before.findings, attempt.findings()),
        None => Arc::new(attempt.findings().to_vec()),
    };
    let rows = Rows { picture: attempt.picture(), findings: Arc::clone(&findings) };
    ui.data_mut(|data| data.insert_temp(id, rows));
    findings
}

/// Whether rows are the findings in their order.
pub(super) fn is_in_order(rows: &[Finding], attempt: &Attempt) -> bool {
    let same = |(row, finding): (&Finding, &Finding)| row.knobs == finding.knobs && key(row) == key(finding);
    rows.len() == attempt.findings().len() && rows.iter().zip(attempt.findings()).all(same)
}

/// The rows in their order, then the findings that begin with a new cause.
fn with_new(mut rows: Arc<Vec<Finding>>, findings: &[Finding]) -> Arc<Vec<Finding>> {
    for finding in findings {
        if rows.iter().all(|row| key(row) != key(finding)) {
            Arc::make_mut(&mut rows).push(finding.clone());
        }
    }
    rows
}

/// The key of a finding's first cause; no two findings share it.
fn key(finding: &Finding) -> &'static str {
    finding.suspect.cause.key
}
