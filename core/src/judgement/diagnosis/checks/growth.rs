//! Whether the filter learns its parameters, or forgets them.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::parts::PARTS;
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

/// Limits σ of a parameter, relative to the initial one, if it still grows or is as large as the parameter.
const GROWN: f64 = 3.0;

/// Limits the growth of σ over the last third of the record.
const GROWS: f64 = 1.2;

/// Limits σ of an identified parameter, relative to the initial one.
const UNLEARNT_SHARE: f64 = 0.9;

pub(super) static WIND_UP: Test = Test {
    name: "growth of P",
    statistic: "σ of a parameter at last over that at first",
    distribution: "none: it is below 1 where anything is learnt",
    source: "Parkum, Poulsen and Holst (1992), Recursive forgetting algorithms, International Journal of Control 55",
    reading: "above 1 and growing: the filter forgets faster than the sensors tell anew",
    run: wind_up,
};

pub(super) static UNLEARNT: Test = Test {
    name: "what is learnt of a parameter",
    statistic: "σ of a parameter at last over that at first",
    distribution: "none: it is below 1 where anything is learnt",
    source: "Söderström and Stoica (1989), System Identification, section 2.4",
    reading: "near 1: the record does not tell, since nothing excites what the parameter does",
    run: unlearnt,
};

fn wind_up(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(last) = case.last() else { return };
    let is_estimated = |channel: crate::Channel| channel.is_parameter() && !case.estimates.considers(channel);
    for (place, &channel) in case.estimates.channels().iter().enumerate().filter(|(_, c)| is_estimated(**c)) {
        let first = case.estimates.initial_std(place);
        let (third, now) =
            (case.estimates.std(case.samples.start + case.len() * 2 / 3, place), case.estimates.std(last, place));
        let growth = now / first;
        let size = case.estimates.canonical_mean(last, place).abs();
        let unbounded = now > GROWS * third || now > 0.5 * size;
        let effect = if unbounded { growth / GROWN } else { 0.0 };
        if first > 0.0 && growth.is_finite() {
            let grows = if now > GROWS * third { " and grows" } else { "" };
            let sentence = format!("σ of the {} is {} times that at first{grows}", channel.name(), short(growth));
            let evidence = Evidence::new(test, Subject::Channel(channel), case);
            let one = evidence.certain(VerdictKind::WoundUp, effect, sentence);
            found.push(Evidence { statistic: growth, ..one });
        }
    }
}

fn unlearnt(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(last) = case.last() else { return };
    let is_considered = |channel| case.estimates.considers(channel);
    let of = |channel: crate::Channel| channel.is_parameter() && !channel.is_augmentation() && !is_considered(channel);
    for (place, &channel) in case.estimates.channels().iter().enumerate().filter(|(_, c)| of(**c)) {
        let first = case.estimates.initial_std(place);
        if first <= 0.0 {
            continue;
        }
        let share = case.estimates.std(last, place) / first;
        // The last part in which the filter learnt anything.
        let at = |part: usize| case.estimates.std(case.part(part).end.max(1) - 1, place);
        let learnt = (1..PARTS).rev().find(|&part| at(part) < 0.98 * at(part - 1));
        let since = learnt.map_or(case.samples.start, |part| case.part(part).end.min(last));
        let time = case.record.time(since);
        let when =
            if learnt.is_some() { format!(", and nothing is learnt since {} s", short(time)) } else { String::new() };
        let sentence = format!("σ of the {} is still {} times that at first{when}", channel.name(), short(share));
        let evidence = Evidence::new(test, Subject::Channel(channel), case);
        let one = evidence.certain(VerdictKind::NotIdentifiable, share / UNLEARNT_SHARE, sentence);
        found.push(Evidence { statistic: share, samples: since..case.samples.end, ..one });
    }
}
