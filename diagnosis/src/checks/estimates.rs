//! Whether the estimates and their covariance are possible, and follow from the record; whether particles still represent a belief.

use std::f64::consts::PI;

use kalmanscope_core::Channel;
use kalmanscope_core::diagnostics::chi_squared;

use super::{Evidence, Subject, Test};
use crate::VerdictKind;
use crate::case::{Case, chi_squared_p, normal_p};
use crate::sums::{ChannelErrors, Chosen, PARTS};
use crate::words::{percent, short};

/// Limits an error, in standard deviations, if it is larger than the truth and the initial uncertainty.
const LOST: f64 = 10.0;

pub(super) static DIVERGENCE: Test = Test {
    name: "divergence",
    statistic: "root mean square error over the last fifth, over σ",
    distribution: "none",
    source: "Fitzgerald (1971), Divergence of the Kalman filter, IEEE Transactions on Automatic Control 16",
    reading: "more than 10, and an error above the true value and its initial σ: the filter has lost the truth",
    run: divergence,
};

fn divergence(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let all = Evidence::new(test, Subject::All, case);
    if let Some(stop) = case.diagnostics.stop {
        let time = short(case.record.time_of(stop.sample));
        let sentence = format!("{}; the filter stopped at {time} s", stop.reason);
        found.push(all.certain(VerdictKind::Diverged, f64::MAX, f64::MAX, sentence));
    }
    for (channel, in_stds, size) in case.diagnostics.lost(case.estimates, LOST) {
        let unit = channel.unit();
        let space = if unit.is_empty() { "" } else { " " };
        let sentence = format!("the {} is off by {}{space}{unit}, {}σ", channel.name(), short(size), short(in_stds));
        let one = Evidence { samples: case.late(), ..Evidence::new(test, Subject::Channel(channel), case) };
        found.push(one.certain(VerdictKind::Diverged, in_stds / LOST, in_stds / LOST, sentence));
    }
}

/// Limits an estimate, relative to its initial mean and standard deviation.
const FAR: f64 = 1e3;

pub(super) static RANGE: Test = Test {
    name: "size and sign of the estimates",
    statistic: "the last estimates",
    distribution: "none",
    source: "Nyquist (1928), Certain topics in telegraph transmission theory (the limit π/dt)",
    reading: "a frequency above the Nyquist limit, a negative damping, or an impossible number: the filter is lost",
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
        let mut push = |effect: f64, sentence: String| {
            let one = Evidence { samples: late.clone(), ..Evidence::new(test, Subject::Channel(channel), case) };
            found.push(one.certain(VerdictKind::Lost, effect, effect, sentence));
        };
        if !mean.is_finite() {
            push(f64::MAX, format!("the {name} is not a number"));
        } else if start > 0.0 && mean.abs() > FAR * start {
            let sentence = format!("the {name} is {}{space}{unit}, over 1000 times any start", short(mean.abs()));
            push(mean.abs() / (FAR * start), sentence);
        } else if channel == Channel::NATURAL_FREQUENCY {
            let [size, dt, most] = [mean.abs(), case.record.dt(), nyquist].map(short);
            let sentence = format!("the {name} is {size} rad/s; samples {dt} s apart show nothing above {most} rad/s");
            push(mean.abs() / nyquist, sentence);
        }
        if channel.is_positive() && case.estimates.initial_std(place) > 0.0 {
            let below = late.clone().map(|k| -means[k] / case.estimates.std(k, place)).fold(f64::INFINITY, f64::min);
            let mirrored = channel.is_mirrored() && channel != Channel::NATURAL_FREQUENCY;
            let whose = if mirrored { ": the oscillator gains energy" } else { "" };
            let sentence =
                format!("the {name} is negative, {}{space}{unit} ± {}{whose}", short(mean), short(2.0 * std));
            if below > 0.0 {
                push(below / 4.0, sentence);
            }
        }
    }
}

/// Limits the error of a parameter, in standard deviations; its errors over a record count as one.
const OFF: f64 = 4.0;

const TOO_LARGE: f64 = 2.0;

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
    reading: "near 95 % is right; below a half, the truth is outside the filter's ellipsoid most of the time",
    run: |case, test, found| {
        let Some(share) = case.share_in_ellipsoid() else { return };
        let late = case.diagnostics.nees_within(case.part(PARTS / 2).start..case.samples.end);
        let degrees = late.degrees.checked_div(late.samples).unwrap_or(0);
        let all_inside = case.errors.iter().all(|one| one.level(&case.kept) < 1.0);
        let limit = if all_inside { OUTSIDE_ACROSS } else { OUTSIDE };
        let effect = if share > 0.0 { limit / share } else { f64::MAX };
        let sentence = format!("the truth is in the 95 % ellipsoid in {} of the samples", percent(share));
        let one = Evidence::new(test, Subject::All, case).certain(VerdictKind::Overconfident, effect, share, sentence);
        found.push(Evidence { p_value: chi_squared::upper_tail(late.mean(), degrees).unwrap_or(1.0), ..one });
    },
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
            // Errors stay below `OFF` even if linearised filters are slightly overconfident: a larger one is certain.
            let p_value = if off > OFF { 0.0 } else { normal_p(off) };
            let (times, inside) = (short(off), percent(one.coverage(&late)));
            let said =
                format!("the {name} is off by {times} times its σ in the last fifth, and inside ±2σ in {inside} of it");
            let one = evidence.certain(VerdictKind::Overconfident, off / OFF, off * off, said);
            found.push(Evidence { p_value, samples: case.late(), ..one });
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
        let sentence = format!("errors² of the {name} are {} times what the covariance says", short(level));
        let p_value = chi_squared_p(level, one.independent(&case.kept));
        found.push(Evidence { p_value, ..evidence.certain(kind, effect, level, sentence) });
    }
}

/// Limits σ of a parameter, relative to the initial one, if it still grows or is as large as the parameter.
const GROWN: f64 = 3.0;

const GROWS: f64 = 1.2;

pub(super) static WIND_UP: Test = Test {
    name: "growth of P",
    statistic: "last σ of a parameter over its initial σ",
    distribution: "none: it is below 1 if the filter learns anything",
    source: "Parkum, Poulsen and Holst (1992), Recursive forgetting algorithms, International Journal of Control 55",
    reading: "above 1 and growing: the filter forgets faster than it learns",
    run: |case, test, found| {
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
                let sentence = format!("σ of the {} is {} times its first value{grows}", channel.name(), short(growth));
                let one = Evidence::new(test, Subject::Channel(channel), case);
                found.push(one.certain(VerdictKind::WoundUp, effect, growth, sentence));
            }
        }
    },
};

pub(super) static UNLEARNT: Test = Test {
    name: "information on a parameter",
    statistic: "last σ of a parameter over its initial σ",
    distribution: "none: it is below 1 if the filter learns anything",
    source: "Söderström and Stoica (1989), System Identification, section 2.4",
    reading: "near 1: the record has no information on the parameter, because nothing excites its effect",
    run: |case, test, found| {
        let Some(last) = case.last() else { return };
        let is_considered = |channel| case.estimates.considers(channel);
        let of = |channel: Channel| channel.is_parameter() && !channel.is_augmentation() && !is_considered(channel);
        let known = |place: usize| case.estimates.initial_std(place) <= 0.0;
        let channels = case.estimates.channels().iter().enumerate();
        for (place, &channel) in channels.filter(|(place, c)| of(**c) && !known(*place)) {
            let share = case.estimates.std(last, place) / case.estimates.initial_std(place);
            let at = |part: usize| case.estimates.std(case.part(part).end.max(1) - 1, place);
            let learnt = (1..PARTS).rev().find(|&part| at(part) < 0.98 * at(part - 1));
            let since = learnt.map_or(case.samples.start, |part| case.part(part).end.min(last));
            let time = case.record.time(since);
            let when =
                if learnt.is_some() { format!(", and does not fall after {} s", short(time)) } else { String::new() };
            let sentence = format!("σ of the {} is still {} times its first value{when}", channel.name(), short(share));
            let samples = since..case.samples.end;
            let one = Evidence { samples, ..Evidence::new(test, Subject::Channel(channel), case) };
            found.push(one.certain(VerdictKind::NotIdentifiable, share / 0.9, share, sentence));
        }
    },
};

pub(super) static RECOVERY: Test = Test {
    name: "recovery",
    statistic: "the parts of the record whose errors are too large, or innovations too large or too small, if the last part is good",
    distribution: "none",
    source: "Basseville and Nikiforov (1993), Detection of Abrupt Changes",
    reading: "too large for a while only: something changed, and the filter followed",
    run: |case, test, found| {
        let forgiven = case.ranges(|part| case.forgiven[part]);
        let (Some(first), Some(last)) = (forgiven.first(), forgiven.last()) else { return };
        let samples = first.start..last.end;
        let [from, to] = [samples.start, samples.end].map(|k| short(case.record.time(k.min(case.samples.end - 1))));
        let (level, of_innovations) = level_of_innovations(case);
        let (off, of_errors) = largest_error(case);
        let is_error = off > 2.0 && (0.8..1.25).contains(&level);
        let (statistic, what) = if is_error { (off, of_errors) } else { (level, of_innovations) };
        if !statistic.is_finite() {
            return;
        }
        let sentence = format!("between {from} s and {to} s {what}; it has recovered");
        let one = Evidence { samples, ..Evidence::new(test, Subject::All, case) };
        found.push(one.certain(VerdictKind::Recovered, 1.0, statistic, sentence));
    },
};

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
    (off, format!("the {name} is off by {} times its σ", short(off)))
}

pub(super) static SAMPLE: Test = Test {
    name: "the sample of particles",
    statistic: "the largest fall of a σ from one sample to the next; the least effective sample size",
    distribution: "none",
    source: "Kong, Liu and Wong (1994), Sequential imputations and Bayesian missing data problems",
    reading: "above 100 times, or fewer than 2 particles for a while: one has all the weight, and σ means nothing",
    run: |case, test, found| {
        if case.estimates.effective_samples().is_empty() {
            return;
        }
        let sizes = &case.estimates.effective_samples()[case.samples.clone()];
        let fall_of = |(place, channel): (usize, &Channel)| {
            let variances = &case.estimates.variances(place)[case.samples.clone()];
            let falls = variances.windows(2).map(|pair| pair[0] / pair[1]).enumerate();
            let (k, fall) = falls.filter(|(_, fall)| !fall.is_nan()).max_by(|a, b| a.1.total_cmp(&b.1))?;
            Some((fall.sqrt(), k + 1, *channel))
        };
        let falls = case.estimates.channels().iter().enumerate().filter_map(fall_of);
        if let Some((fall, k, channel)) = falls.max_by(|a, b| a.0.total_cmp(&b.0)) {
            let at = case.samples.start + k;
            let time = short(case.record.time(at));
            let with = match sizes[k] {
                size if size.is_nan() => "where nothing is measured".to_owned(),
                size => format!("with {} effective particles", short(size)),
            };
            let sentence = format!("σ of the {} falls {} times at {time} s, {with}", channel.name(), short(fall));
            let samples = at..case.samples.end;
            let one = Evidence { samples, ..Evidence::new(test, Subject::Channel(channel), case) };
            found.push(one.certain(VerdictKind::Collapsed, fall / 100.0, fall, sentence));
        }
        let (mut longest, mut present, mut least) = (0, 0, f64::INFINITY);
        for &size in sizes.iter().filter(|size| !size.is_nan()) {
            present = if size < 2.0 { present + 1 } else { 0 };
            longest = longest.max(present);
            least = size.min(least);
        }
        let sentence =
            format!("the effective sample size falls to {}, and stays below 2 for {longest} samples", short(least));
        let one = Evidence::new(test, Subject::All, case);
        found.push(one.certain(VerdictKind::Collapsed, f64::from(longest) / 10.0, least, sentence));
    },
};

pub(super) static DIVERSITY: Test = Test {
    name: "diversity of the particles",
    statistic: "D = Σ -½ ln(1 - 1/N_eff) over all resamplings, as a share of D + Σ -½ ln(1 - K S Kᵀ / P) over all updates",
    distribution: "none: D is 0 for infinitely many particles",
    source: "Kong, Liu and Wong (1994), Sequential imputations and Bayesian missing data problems; Liu and West (2001)",
    reading: "drawing N_eff particles loses, on average, 1/N_eff of the variance; if these losses explain a quarter of \
              the shrinking of σ, then σ shows the lack of particles, not knowledge",
    run: |case, test, found| {
        let estimates = case.estimates;
        if estimates.effective_samples().is_empty() {
            return;
        }
        let resamples = |size: &&f64| **size < 0.5 * estimates.particles as f64;
        let sizes = &estimates.effective_samples()[case.samples.clone()];
        let lost: f64 = sizes.iter().filter(resamples).map(|size| shrinks_by(1.0 / size)).sum();
        for (place, &channel) in estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
            let learnt: f64 =
                (case.samples.start + 1..case.samples.end).map(|k| shrinks_by(learnt_share(case, k, place))).sum();
            let share = lost / (lost + learnt);
            if share.is_nan() {
                continue;
            }
            let times = libm::exp(lost.min(700.0));
            let (name, times, part) = (channel.name(), short(times), percent(share));
            let sentence =
                format!("resampling alone makes σ of the {name} {times} times smaller, {part} of all its shrinking");
            let effect = (share / 0.25).min(lost / libm::log(3.0));
            let one = Evidence::new(test, Subject::Channel(channel), case);
            found.push(one.certain(VerdictKind::Collapsed, effect, share, sentence));
        }
    },
};

/// The share by which the measurements of sample `k` reduce the variance of the channel at `place`: K S Kᵀ / P.
fn learnt_share(case: &Case<'_>, k: usize, place: usize) -> f64 {
    let (n, m) = (case.estimates.channels().len(), case.estimates.sensors().len());
    let (gain, cov) = (case.estimates.gain(k), case.estimates.innovation_cov(k));
    let innovation = case.estimates.innovation(k);
    let of = |i: usize| if innovation[i].is_nan() { 0.0 } else { gain[i * n + place] };
    let mut taken = 0.0;
    for i in (0..m).filter(|&i| of(i) != 0.0) {
        for j in (0..m).filter(|&j| of(j) != 0.0) {
            taken += of(i) * cov[i * m + j] * of(j);
        }
    }
    let variance = case.estimates.variances(place)[k - 1];
    if taken > 0.0 { taken / variance } else { 0.0 }
}

fn shrinks_by(share: f64) -> f64 {
    -0.5 * libm::log(1.0 - share.min(1.0 - 1e-6))
}
