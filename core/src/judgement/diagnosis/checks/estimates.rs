//! Whether the estimates and their covariance are possible, and follow from the record.

use std::f64::consts::PI;

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::distributions::{chi_squared_p, normal_p};
use crate::judgement::diagnosis::errors::ChannelErrors;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::parts::{Chosen, PARTS};
use crate::judgement::words::{percent, short};
use crate::numbers::diagnostics::chi_squared;
use crate::{Channel, VerdictKind};

/// Limits an error, in standard deviations, if it is larger than the truth and the initial uncertainty.
const LOST: f64 = 10.0;

pub(super) static DIVERGENCE: Test = Test {
    name: "divergence",
    statistic: "root mean square error over the last fifth, over σ",
    distribution: "none",
    source: "Fitzgerald (1971), Divergence of the Kalman filter, IEEE Transactions on Automatic Control 16",
    reading: "more than 10, and larger than the truth and all doubts at first: nothing is left of the truth",
    run: divergence,
};

fn divergence(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let all = Evidence::new(test, Subject::All, case);
    if let Some(stop) = case.diagnostics.stop() {
        let time = short(case.record.time_of(stop.sample));
        let sentence = format!("{}; the filter stopped at {time} s", stop.reason);
        found.push(all.certain(VerdictKind::Diverged, f64::MAX, sentence));
    }
    for (channel, in_stds, size) in case.diagnostics.lost(case.estimates, LOST) {
        let unit = channel.unit();
        let space = if unit.is_empty() { "" } else { " " };
        let sentence = format!("the {} is off by {}{space}{unit}, {}σ", channel.name(), short(size), short(in_stds));
        let one = Evidence::new(test, Subject::Channel(channel), case).certain(
            VerdictKind::Diverged,
            in_stds / LOST,
            sentence,
        );
        found.push(Evidence { samples: case.late(), ..one });
    }
}

/// Limits an estimate, relative to its initial mean and standard deviation.
const FAR: f64 = 1e3;

/// Limits how far below zero a positive parameter can be, in standard deviations.
const BELOW: f64 = 4.0;

pub(super) static RANGE: Test = Test {
    name: "size and sign of the estimates",
    statistic: "the last estimates",
    distribution: "none",
    source: "Nyquist (1928), Certain topics in telegraph transmission theory (the limit π/dt)",
    reading: "a frequency beyond what the samples can show, a negative damping, or a number far from any start: the filter is lost",
    run: range,
};

fn range(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(last) = case.last() else { return };
    let late = case.late();
    for (place, &channel) in case.estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
        let means = case.estimates.canonical_means(place);
        let (mean, std) = (means[last], case.estimates.std(last, place));
        let (name, unit) = (channel.name(), channel.unit());
        let space = if unit.is_empty() { "" } else { " " };
        let start = case.estimates.initial_mean(place).abs().max(2.0 * case.estimates.initial_std(place));
        let nyquist = PI / case.record.dt();
        let evidence = || Evidence { samples: late.clone(), ..Evidence::new(test, Subject::Channel(channel), case) };
        if !mean.is_finite() {
            found.push(evidence().certain(VerdictKind::Lost, f64::MAX, format!("the {name} is no number")));
        } else if start > 0.0 && mean.abs() > FAR * start {
            let sentence = format!("the {name} is {}{space}{unit}, more than 1000 times any start", short(mean.abs()));
            found.push(evidence().certain(VerdictKind::Lost, mean.abs() / (FAR * start), sentence));
        } else if channel == Channel::NATURAL_FREQUENCY {
            let sentence = format!(
                "the {name} is {} rad/s; samples {} s apart show nothing above {} rad/s",
                short(mean.abs()),
                short(case.record.dt()),
                short(nyquist)
            );
            found.push(evidence().certain(VerdictKind::Lost, mean.abs() / nyquist, sentence));
        }
        if channel.is_positive() && case.estimates.initial_std(place) > 0.0 {
            let below = late.clone().map(|k| -means[k] / case.estimates.std(k, place)).fold(f64::INFINITY, f64::min);
            let mirrored = channel.is_mirrored() && channel != Channel::NATURAL_FREQUENCY;
            let whose = if mirrored { ": the oscillator gains energy" } else { "" };
            let sentence =
                format!("the {name} is negative, {}{space}{unit} ± {}{whose}", short(mean), short(2.0 * std));
            if below > 0.0 {
                found.push(evidence().certain(VerdictKind::Lost, below / BELOW, sentence));
            }
        }
    }
}

/// Limits the error of a parameter, in standard deviations; its errors over a record count as one.
const OFF: f64 = 4.0;

/// Limits the squared errors of a motion from above, relative to the covariance.
const TOO_LARGE: f64 = 2.0;

/// The least squared errors of a motion, relative to the covariance.
const TOO_SMALL: f64 = 0.3;

/// The least share of the samples with the truth in the 95 % ellipsoid.
const OUTSIDE: f64 = 0.5;

/// If each channel alone is inside: errors are then outside only across channels, where linearised filters are overconfident.
const OUTSIDE_ACROSS: f64 = 0.25;

pub(super) static CHANNELS: Test = Test {
    name: "errors of a channel (NEES)",
    statistic: "mean of e² / P over the record for a motion, and over its last fifth for a parameter",
    distribution: "χ² with as many degrees of freedom as errors are independent: one for a parameter",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "1 is right on average; 16 is an error of 4σ",
    run: channels,
};

pub(super) static ELLIPSOID: Test = Test {
    name: "errors of all channels (NEES)",
    statistic: "share of samples with eᵀ P⁻¹ e below the 95 % quantile of χ²",
    distribution: "95 % on average over many runs; errors of one run are much alike from sample to sample",
    source: "Bar-Shalom, Li and Kirubarajan (2001), section 5.4",
    reading: "near 95 % is right; below a half, the truth is outside what the filter holds possible most of the time",
    run: ellipsoid,
};

fn channels(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let late: Chosen = std::array::from_fn(|part| part >= PARTS - 2);
    for one in &case.errors {
        let evidence = Evidence::new(test, Subject::Channel(one.channel), case);
        let name = one.channel.name();
        if one.channel.is_parameter() {
            let off = one.level(&late).sqrt();
            if one.count(&late) == 0.0 {
                continue;
            }
            found.push(Evidence {
                statistic: off * off,
                // Errors stay below `OFF` even if linearised filters are slightly overconfident: a larger one is certain.
                p_value: if off > OFF { 0.0 } else { normal_p(off) },
                effect: off / OFF,
                speaks_for: VerdictKind::Overconfident,
                samples: case.late(),
                sentence: format!(
                    "the {name} is {} times its σ off in the last fifth, and inside ±2σ in {} of it",
                    short(off),
                    percent(one.coverage(&late))
                ),
                ..evidence
            });
            continue;
        }
        let level = one.level(&case.kept);
        if level.is_nan() {
            continue;
        }
        let (effect, kind) = if level > 1.0 {
            (libm::log(level) / libm::log(TOO_LARGE), VerdictKind::Overconfident)
        } else {
            // Small errors by chance, or because nothing moves, come with innovations as large as expected.
            let effect = if case.nis(&case.kept).0 < 0.9 { libm::log(level) / libm::log(TOO_SMALL) } else { 0.0 };
            (effect, VerdictKind::Underconfident)
        };
        found.push(Evidence {
            statistic: level,
            p_value: chi_squared_p(level, one.independent(&case.kept)),
            effect,
            speaks_for: kind,
            sentence: format!("errors² of the {name} are {} times what the covariance says", short(level)),
            ..evidence
        });
    }
}

fn ellipsoid(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(share) = case.share_in_ellipsoid() else { return };
    let late = case.diagnostics.nees_within(case.part(PARTS / 2).start..case.samples.end);
    let degrees = late.degrees.checked_div(late.samples).unwrap_or(0);
    let all_inside = case.errors.iter().all(|one| one.level(&case.kept) < 1.0);
    let limit = if all_inside { OUTSIDE_ACROSS } else { OUTSIDE };
    found.push(Evidence {
        statistic: share,
        // The errors of one record count as a single one.
        p_value: chi_squared::upper_tail(late.mean(), degrees).unwrap_or(1.0),
        effect: if share > 0.0 { limit / share } else { f64::MAX },
        speaks_for: VerdictKind::Overconfident,
        sentence: format!("the truth is in the 95 % ellipsoid in {} of the samples", percent(share)),
        ..Evidence::new(test, Subject::All, case)
    });
}

const BELOW_BOUND: f64 = 3.0;

pub(super) static BOUND: Test = Test {
    name: "σ against the Cramér-Rao bound",
    statistic: "the bound over σ of a parameter, at last",
    distribution: "none: it is at most 1 for a filter that takes no more for true than is so",
    source: "Tichavský, Muravchik and Nehorai (1998)",
    reading: "above 1: the filter claims to know more than the record can tell",
    run: bound,
};

fn bound(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(bound) = case.bound else { return };
    let Some(last) = case.last().filter(|last| *last < bound.len()) else { return };
    for (place, &channel) in case.estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
        let Some(floor) = bound.place(channel).map(|of_bound| bound.std(last, of_bound)) else { continue };
        let std = case.estimates.std(last, place);
        if !(floor > 0.0 && std > 0.0) {
            continue;
        }
        let ratio = floor / std;
        let sentence =
            format!("σ of the {} is {} times the least that any filter can reach", channel.name(), short(1.0 / ratio));
        let one = Evidence::new(test, Subject::Channel(channel), case).certain(
            VerdictKind::Overconfident,
            ratio / BELOW_BOUND,
            sentence,
        );
        found.push(Evidence { statistic: ratio, ..one });
    }
}

/// Limits σ of a parameter, relative to the initial one, if it still grows or is as large as the parameter.
const GROWN: f64 = 3.0;

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
    let is_estimated = |channel: Channel| channel.is_parameter() && !case.estimates.considers(channel);
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
            let one =
                Evidence::new(test, Subject::Channel(channel), case).certain(VerdictKind::WoundUp, effect, sentence);
            found.push(Evidence { statistic: growth, ..one });
        }
    }
}

fn unlearnt(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(last) = case.last() else { return };
    let is_considered = |channel| case.estimates.considers(channel);
    let of = |channel: Channel| channel.is_parameter() && !channel.is_augmentation() && !is_considered(channel);
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
        let one = Evidence::new(test, Subject::Channel(channel), case).certain(
            VerdictKind::NotIdentifiable,
            share / UNLEARNT_SHARE,
            sentence,
        );
        found.push(Evidence { statistic: share, samples: since..case.samples.end, ..one });
    }
}

/// The normal range of innovations², over their expectation.
const CALM: std::ops::Range<f64> = 0.8..1.25;

/// The least error of a channel that is mentioned, in standard deviations.
const MENTIONED: f64 = 2.0;

pub(super) static RECOVERY: Test = Test {
    name: "recovery",
    statistic: "the parts of the record whose errors are too large, or innovations too large or too small, if the last part is good",
    distribution: "none",
    source: "Basseville and Nikiforov (1993), Detection of Abrupt Changes",
    reading: "a run of surprises that ends: something changed, and the filter followed",
    run: recovery,
};

fn recovery(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let Some(samples) = case.forgiven_samples() else { return };
    let [from, to] = [samples.start, samples.end].map(|k| short(case.record.time(k.min(case.samples.end - 1))));
    let (level, of_innovations) = level_of_innovations(case);
    let (off, of_errors) = largest_error(case);
    let is_error = off > MENTIONED && CALM.contains(&level);
    let (statistic, what) = if is_error { (off, of_errors) } else { (level, of_innovations) };
    if !statistic.is_finite() {
        return;
    }
    let sentence = format!("between {from} s and {to} s {what}; it has recovered");
    let one = Evidence::new(test, Subject::All, case).certain(VerdictKind::Recovered, 1.0, sentence);
    found.push(Evidence { statistic, samples, ..one });
}

/// Over their expectation, in the forgiven parts, with words: those of one sensor, if all together are as expected.
fn level_of_innovations(case: &Case<'_>) -> (f64, String) {
    let level = case.nis(&case.forgiven).0;
    let distance = |level: f64| libm::log(level).abs();
    let farthest = case.sensors.iter().map(|one| (one.level(&case.forgiven), one.sensor.key()));
    let farthest = farthest.max_by(|a, b| distance(a.0).total_cmp(&distance(b.0)));
    let (level, whose) = match farthest {
        Some((of_sensor, key)) if (0.9..1.1).contains(&level) => (of_sensor, format!(" of the {key}")),
        _ => (level, String::new()),
    };
    (level, format!("innovations²{whose} are {} times what the filter expects", short(level)))
}

/// The largest root mean square error in the forgiven parts, in standard deviations, with words; 0 without a truth.
fn largest_error(case: &Case<'_>) -> (f64, String) {
    let of = |one: &ChannelErrors| (one.level(&case.forgiven).sqrt(), one.channel.name());
    let known = case.errors.iter().map(of).filter(|(off, _)| !off.is_nan());
    let (off, name) = known.max_by(|a, b| a.0.total_cmp(&b.0)).unwrap_or((0.0, ""));
    (off, format!("the {name} is {} times its σ off", short(off)))
}
