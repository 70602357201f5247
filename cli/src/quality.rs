//! The consistency of a filter in numbers.

use kalmanscope_core::Summary;
use kalmanscope_core::diagnostics::MeanSquare;

use crate::number::{fixed, scientific, short};

/// Name and value of each measure: mean NIS and NEES with their intervals, the share of the truth inside, whiteness, log
/// likelihood.
pub(crate) fn quality(summary: &Summary, has_innovations: bool) -> Vec<(&'static str, String)> {
    let mut rows = Vec::new();
    match &summary.nis {
        Some(nis) => rows.push(("mean NIS", placed(nis, "interval"))),
        None if has_innovations => rows.push(("mean NIS", "– (no measurement)".to_owned())),
        None => {}
    }
    if let Some(nees) = &summary.nees {
        rows.push(("mean NEES", placed(nees, "interval for one sample")));
    }
    if let Some(share) = summary.share_in_ellipsoid {
        rows.push(("truth", format!("in the 95 % ellipsoid in {} % of the samples", fixed(100.0 * share, 1))));
    }
    let tests = summary.ljung_box.iter().filter_map(|(quantity, test)| {
        let test = test.as_ref()?;
        Some(format!("{} Q = {}, p = {}", quantity.symbol(), short(test.statistic), fixed(test.p_value, 3)))
    });
    let tests: Vec<String> = tests.collect();
    if !tests.is_empty() {
        rows.push(("Ljung-Box", tests.join("; ")));
    }
    match &summary.nis {
        Some(_) => rows.push(("log likelihood", fixed(summary.log_likelihood, 2))),
        None if has_innovations => rows.push(("log likelihood", "–".to_owned())),
        None => {}
    }
    rows
}

/// A mean and its position relative to its interval.
fn placed(square: &MeanSquare, interval: &str) -> String {
    let MeanSquare { mean, interval: range, .. } = square;
    let place = if range.contains(mean) {
        "inside"
    } else if mean < range.start() {
        "below"
    } else {
        "above"
    };
    let [mean, low, high] =
        [mean, range.start(), range.end()].map(|x| if *x < 1e6 { format!("{x:.3}") } else { scientific(*x, 3) });
    format!("{mean}, {place} its χ² 95 % {interval} {low} … {high}")
}
