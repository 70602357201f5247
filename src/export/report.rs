//! The report on the run: one page for a browser or a printer.

use kalmanscope_cli::{Parts, day, report};
use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::diagnostics::Depth;
use kalmanscope_core::{Analysis, Estimates};

use crate::figure::Figure;
use crate::layout::Layout;
use crate::request::{FigureFormat, ViewKind};
use crate::session::{Attempt, Session, Wanted};
use crate::view::ViewContext;

/// The views that a report has besides those on screen: innovations, and measurements against predictions.
const ALWAYS: [ViewKind; 2] = [ViewKind::Innovations, ViewKind::Measured];

const TEXT: [ViewKind; 4] = [ViewKind::Matrices, ViewKind::Scores, ViewKind::Filters, ViewKind::Diagnosis];

/// The text of the page. Causes are those that have been found so far.
///
/// # Errors
/// The reason why it cannot be made.
pub(super) fn html(context: &ViewContext<'_>, layout: &Layout) -> Result<String, String> {
    let session = context.session;
    let run = session.run();
    let mut views = layout.in_order();
    views.extend(ALWAYS.into_iter().filter(|kind| !layout.shown().contains(kind)));
    views.retain(|kind| !TEXT.contains(kind));
    let figures: Vec<String> =
        views.into_iter().map(|kind| Figure::new(context, &[vec![kind]], FigureFormat::Page).svg()).collect();
    let attempts = run.estimates().iter().map(|estimates: &Estimates| session.attempt(estimates.id()));
    let causes: Vec<Vec<Remedy>> = attempts
        .map(|attempt| attempt.map_or_else(Vec::new, |attempt: &Attempt| attempt.remedies().to_vec()))
        .collect();
    let title = title(session);
    let records = [(title.as_str(), run.record())];
    let parts = Parts {
        title: &title,
        day: &now().map(day).unwrap_or_default(),
        causes: &causes,
        reasons: session.library().reasons(),
        figures: &figures,
        free_runs: if session.is_measured() { &records } else { &[] },
    };
    let analysis = Analysis::new(run, Wanted::diagnostics(Depth::All));
    report(run, &analysis, &parts).map_err(|error| error.to_string())
}

fn title(session: &Session) -> String {
    let file = session.scenario().record.as_ref().map(|mapping| mapping.file.clone());
    file.filter(|file| !file.is_empty()).unwrap_or_else(|| "A simulated oscillator".to_owned())
}

#[cfg(not(target_arch = "wasm32"))]
fn now() -> Option<f64> {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.ok().map(|now| now.as_secs_f64())
}

#[cfg(target_arch = "wasm32")]
fn now() -> Option<f64> {
    Some(js_sys::Date::now() / 1e3)
}
