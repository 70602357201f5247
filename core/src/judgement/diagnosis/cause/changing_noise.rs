//! The noise of a sensor changes.

use super::{BadFilter, Cause, LikelyCause};
use crate::Quantity;
use crate::judgement::diagnosis::distributions::chi_squared_p;
use crate::judgement::diagnosis::innovations::SensorInnovations;
use crate::judgement::diagnosis::parts::{Chosen, PARTS};
use crate::judgement::diagnosis::words::short;

/// The least ratio of a change of variance.
const RATIO: f64 = 1.5;

/// Limits the correlation at lag 1 of innovations that grew through noise alone.
const WHITE: f64 = 0.2;

/// Limits the probability that chance explains a change, over all divisions that are tried.
const LEVEL: f64 = 1e-4;

pub(super) static CAUSE: Cause = Cause {
    key: "changing_noise",
    name: "R that changes with time",
    hint: "A sensor is noisier for a while: another range, a loose cable, more traffic. Let the filter learn R as it goes, or leave \
           out the noisy part.",
    likely_causes,
};

/// Uses the innovations² of each part of the record. The innovations must stay white: a changing parameter would leave
/// them correlated.
///
/// ```text
/// L = ½ (n ln m - n₁ ln m₁ - n₂ ln m₂),  2 L ~ χ² where nothing changes
/// ```
///
/// Source: Bartlett (1937), Properties of sufficiency and statistical tests, *Proceedings of the Royal Society A* 160.
fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    if bad.filter.adaptation.sensor_noise {
        return;
    }
    let case = bad.case;
    let changes = case.sensors.iter().filter_map(|one| Some((one.sensor, change(one)?)));
    let Some((sensor, change)) = changes.max_by(|a, b| a.1.ratio.total_cmp(&b.1.ratio)) else { return };
    let sentence = sentence(bad, sensor, &change);
    let edits = vec![bad.edit("adaptation.sensor_noise", true)];
    let weight = 1.0 - 1.0 / change.ratio;
    let samples = case.part(change.parts.0).start..case.part(change.parts.1 - 1).end;
    found.push(LikelyCause { samples: Some(samples), ..LikelyCause::new(cause, weight, 1.0, edits, sentence) });
}

/// Successive parts of a record with other innovations² of a sensor than the rest.
struct Change {
    /// The first of these parts, and the first one after them.
    parts: (usize, usize),
    /// The innovations² in the rest and in these parts, relative to their expectation.
    levels: (f64, f64),
    /// The larger one over the smaller one.
    ratio: f64,
}

/// The run of parts that differs most from the rest.
fn change(one: &SensorInnovations) -> Option<Change> {
    let all = [true; PARTS];
    let cost = |chosen: &Chosen| one.count(chosen) * libm::log(one.level(chosen));
    let runs = (0..PARTS).flat_map(|from| (from + 1..=PARTS).map(move |to| (from, to)));
    let mut best: Option<(f64, Change)> = None;
    let mut looked = 0.0;
    for parts in runs.filter(|(from, to)| (1..PARTS).contains(&(to - from)) && (*to == PARTS || *from > 0)) {
        let within: Chosen = std::array::from_fn(|part| (parts.0..parts.1).contains(&part));
        let rest = within.map(|is| !is);
        let gain = cost(&all) - cost(&within) - cost(&rest);
        looked += 1.0;
        if gain.is_finite() && best.as_ref().is_none_or(|(most, _)| gain > *most) {
            let levels = (one.level(&rest), one.level(&within));
            let ratio = (levels.1 / levels.0).max(levels.0 / levels.1);
            let is_white = [&within, &rest].iter().all(|chosen| one.autocorrelation(chosen)[0].abs() < WHITE);
            best = Some((gain, Change { parts, levels, ratio: if is_white { ratio } else { 1.0 } }));
        }
    }
    let (gain, change) = best?;
    let is_chance = looked * chi_squared_p(gain.max(1.0), 1.0) > LEVEL;
    (change.ratio > RATIO && !is_chance).then_some(change)
}

fn sentence(bad: &BadFilter<'_>, sensor: Quantity, change: &Change) -> String {
    let (from, to) = change.parts;
    let time = |part: usize| short(bad.case.record.time(bad.case.part(part).start));
    let (rest, there) = (short(change.levels.0), short(change.levels.1));
    let name = sensor.key();
    if to == PARTS {
        let when = time(from);
        return format!(
            "R of the {name} changes, from {when} s on: innovations² are {rest} times what is expected before and {there} after"
        );
    }
    let (begin, end) = (time(from), time(to));
    format!(
        "R of the {name} changes, from {begin} to {end} s: innovations² are {there} times what is expected there and {rest} \
         elsewhere"
    )
}
