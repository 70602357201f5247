//! Noises that are not as large as a filter takes them to be, and what fading and particles make of them.

use kalmanscope_core::internals::{mapped, numbers, places};
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Channel, FilterSettings, Quantity};

use super::{BadFilter, Cause, LikelyCause};
use crate::VerdictKind;
use crate::case::chi_squared_p;
use crate::checks::Subject;
use crate::sums::{Chosen, PARTS, SensorInnovations};
use crate::words::short;

/// Limits the factors on a variance that may come first: a larger one silences the sensor.
const SILENCE: f64 = 100.0;

/// If a variance was given in place of σ, innovations² are about 1/σ times what is expected; from this share of it on it is one.
const MISTAKEN: f64 = 0.3;

const LEAST_R: f64 = 1e-4;

pub(super) static SENSOR_NOISE: Cause = Cause {
    key: "sensor_noise",
    name: "R of a sensor",
    hint: "R is the variance of a sensor's noise. If innovations² are larger or smaller than S, and S is mostly R, set \
           R to their size.",
    likely_causes: sensor_noise,
};

/// The mean square of e is H P Hᵀ + R for any assumed R. Source: Mehra (1972), Approaches to adaptive filtering, section IV.
fn sensor_noise(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let (case, assumed) = (bad.case, &bad.filter.sensor_std);
    let m = assumed.len();
    let mut factors = vec![(1.0, 1.0); m];
    for (i, (factors, std)) in factors.iter_mut().zip(assumed).enumerate() {
        let (mut square, mut expected, mut count) = (0.0, 0.0, 0.0);
        for k in (0..PARTS).filter(|&part| case.kept[part]).flat_map(|part| case.part(part)) {
            let innovation = case.estimates.innovation(k)[i];
            if !innovation.is_nan() {
                square += innovation * innovation;
                expected += case.estimates.innovation_cov(k)[i * (m + 1)];
                count += 1.0;
            }
        }
        if count > 0.0 {
            let matched = (square - expected) / (count * std * std) + 1.0;
            // Where R is a small part of S, the first may be negative by chance; the second takes all of S for R.
            *factors = (matched.max(LEAST_R), (square / expected).max(LEAST_R));
        }
    }
    let level = |i: usize| case.sensors[i].level(&case.kept);
    let taken = places(m, &|i| assumed[i] < 1.0 && level(i) > MISTAKEN / assumed[i].max(LEAST_R));
    if !taken.is_empty() {
        let turned = numbers(m, &|i| if taken.contains(&i) { assumed[i].sqrt() } else { assumed[i] });
        let of = |&i: &usize| {
            let (name, std) = (case.sensors[i].sensor.key(), short(assumed[i]));
            format!("R of the {name} is {} times too small: {std} may be a variance, not σ", short(1.0 / assumed[i]))
        };
        let sentence = mapped(&taken, &of).join(", ");
        found.push(LikelyCause::new(cause, 0.9, 0.0, vec![bad.edit("sensor_std", turned)], sentence));
    }
    let mut propose = |which: &dyn Fn(usize) -> f64| {
        let turned = numbers(m, &|i| assumed[i] * which(i).sqrt());
        let changed = places(m, &|i| far(which(i)));
        if changed.is_empty() {
            return;
        }
        let turned_since = |i: usize| assumed[i] / bad.origin.sensor_std.get(i).unwrap_or(&assumed[i]);
        let since = |i: usize| which(i) * turned_since(i) * turned_since(i);
        let of = |i: usize| {
            let (name, factor) = (case.sensors[i].sensor.key(), since(i));
            let (word, factor) = if factor > 1.0 { ("small", factor) } else { ("large", 1.0 / factor) };
            format!("R of the {name} is {} times too {word}", short(factor))
        };
        let told = (0..m).filter(|&i| far(since(i)));
        let sentence = told.map(of).collect::<Vec<_>>().join(", ");
        let sizes = changed.iter().map(|&i| libm::log(level(i)).abs());
        let weight = sizes.map(|size| size / (1.0 + size)).fold(0.0, f64::max);
        let edits = vec![bad.edit("sensor_std", turned)];
        let silences = (0..m).any(|i| since(i) > SILENCE);
        found.push(LikelyCause { silences, ..LikelyCause::new(cause, weight, changed.len() as f64, edits, sentence) });
    };
    if m > 1 {
        propose(&|i| factors[i].0);
        propose(&|i| factors[i].1);
    }
    for place in 0..m {
        propose(&|i| if i == place { factors[i].0 } else { 1.0 });
        propose(&|i| if i == place { factors[i].1 } else { 1.0 });
    }
}

fn far(factor: f64) -> bool {
    factor.is_finite() && libm::log(factor).abs() > libm::log(1.15)
}

pub(super) static CHANGING_NOISE: Cause = Cause {
    key: "changing_noise",
    name: "R that changes with time",
    hint: "A sensor is noisier for a while: another range, a loose cable, more traffic. Let the filter learn R, or \
           leave out the noisy part.",
    likely_causes: |bad, cause, found| {
        // The innovations must stay white: a changing parameter would leave them correlated.
        // L = ½ (n ln m - n₁ ln m₁ - n₂ ln m₂),  2 L ~ χ² where nothing changes
        // Source: Bartlett (1937), Properties of sufficiency and statistical tests, *Proceedings of the Royal Society A* 160.
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
    },
};

struct NoiseChange {
    parts: (usize, usize),
    levels: (f64, f64),
    ratio: f64,
}

fn change(one: &SensorInnovations) -> Option<NoiseChange> {
    let all = [true; PARTS];
    let cost = |chosen: &Chosen| one.count(chosen) * libm::log(one.level(chosen));
    let runs = (0..PARTS).flat_map(|from| (from + 1..=PARTS).map(move |to| (from, to)));
    let mut best: Option<(f64, NoiseChange)> = None;
    let mut looked = 0.0;
    for parts in runs.filter(|(from, to)| (1..PARTS).contains(&(to - from)) && (*to == PARTS || *from > 0)) {
        let within: Chosen = std::array::from_fn(|part| (parts.0..parts.1).contains(&part));
        let rest = within.map(|is| !is);
        let gain = cost(&all) - cost(&within) - cost(&rest);
        looked += 1.0;
        if gain.is_finite() && best.as_ref().is_none_or(|(most, _)| gain > *most) {
            let levels = (one.level(&rest), one.level(&within));
            let ratio = (levels.1 / levels.0).max(levels.0 / levels.1);
            let is_white = [&within, &rest].iter().all(|chosen| one.autocorrelation(chosen)[0].abs() < 0.2);
            best = Some((gain, NoiseChange { parts, levels, ratio: if is_white { ratio } else { 1.0 } }));
        }
    }
    let (gain, change) = best?;
    let is_chance = looked * chi_squared_p(gain.max(1.0), 1.0) > 1e-4;
    (change.ratio > 1.5 && !is_chance).then_some(change)
}

fn sentence(bad: &BadFilter<'_>, sensor: Quantity, change: &NoiseChange) -> String {
    let (from, to) = change.parts;
    let time = |part: usize| short(bad.case.record.time(bad.case.part(part).start));
    let (name, rest, there) = (sensor.key(), short(change.levels.0), short(change.levels.1));
    let (when, levels) = if to == PARTS {
        (format!("from {} s on", time(from)), format!("{rest} times what is expected before and {there} after"))
    } else {
        let when = format!("from {} to {} s", time(from), time(to));
        (when, format!("{there} times what is expected there and {rest} elsewhere"))
    };
    format!("R of the {name} changes, {when}: innovations² are {levels}")
}

pub(super) static FELT_DISTURBANCE: Cause = Cause {
    key: "felt_disturbance",
    name: "a disturbance felt by an accelerometer",
    hint: "An accelerometer also reads the disturbance. Add the disturbance² to its R, or let the filter model the \
           disturbance as a white force.",
    likely_causes: |bad, cause, found| {
        let (case, filter) = (bad.case, bad.filter);
        let model = filter.model(&bad.scenario.plant.kind, bad.scenario.input);
        // The process noise of a velocity in a step is the disturbance times dt.
        let disturbance = filter.process_std[Channel::VELOCITY] / case.record.dt();
        let at_rest = model.at_rest(|quantity| filter.initial_mean[quantity.gain()]);
        let felt = |i: usize| {
            let reading = model.reading(case.sensors[i].sensor)?;
            let read = |force| model.read_disturbed(&reading, &at_rest, 0.0.into(), force);
            Some((read(1.0) - read(0.0)) * disturbance).filter(|felt| *felt != 0.0)
        };
        let places = places(filter.sensor_std.len(), &|i| felt(i).is_some());
        if places.is_empty() || places.iter().all(|&i| filter.sensor_std[i] > 0.9 * felt(i).unwrap_or(0.0).abs()) {
            return;
        }
        let turned: Vec<f64> =
            filter.sensor_std.iter().enumerate().map(|(i, std)| libm::hypot(*std, felt(i).unwrap_or(0.0))).collect();
        let of = |subject: Subject| places.iter().any(|&i| subject == Subject::Sensor(case.sensors[i].sensor));
        let weight = bad.effect_of(|one| of(one.subject));
        let sentence =
            format!("Q contains a disturbance of {} m/s², which the accelerometer reads too", short(disturbance));
        found.push(LikelyCause::new(cause, weight, 0.0, vec![bad.edit("sensor_std", turned)], sentence.clone()));
        // A white force of the same size also models the accelerometer's reading of it; a larger R does not.
        if let Some(edits) = with_white_force(bad) {
            found.push(LikelyCause::new(cause, weight, 0.0, edits, sentence));
        }
    },
};

fn with_white_force(bad: &BadFilter<'_>) -> Option<Vec<Edit>> {
    let (velocity, white) = (Channel::VELOCITY, Channel::WHITE_FORCE);
    let std = bad.filter.process_std[velocity];
    let edits = || {
        let size = bad.entry("process_std", white, std / bad.case.record.dt());
        vec![bad.augmented(white), size, bad.entry("process_std", velocity, 0.0)]
    };
    (std > 0.0 && !bad.filter.augment.contains(&white)).then(edits)
}

/// The least correlation of two sensors within a sample that is a noise of both, and the most that is left at any other lag.
const COMMON: f64 = 0.12;
const ALONE: f64 = 0.08;

pub(super) static COMMON_NOISE: Cause = Cause {
    key: "common_noise",
    name: "noise that is common to two sensors",
    hint: "One supply, amplifier or mount disturbs both sensors, but R assumes independent noise: the filter counts \
           the same error twice. Leave one sensor out.",
    likely_causes: |bad, cause, found| {
        let case = bad.case;
        let is_white = |place: usize| case.sensors[place].autocorrelation(&case.kept).iter().all(|r| r.abs() < ALONE);
        for pair in &case.pairs {
            let r = pair.correlation[0][0] - case.expected_correlation(pair.places);
            let is_alone = pair.correlation.iter().all(|side| side[1..].iter().all(|other| other.abs() < ALONE));
            if r.abs() < COMMON || !is_alone || !pair.places.iter().all(|&place| is_white(place)) {
                continue;
            }
            let (one, other) = (case.sensors[pair.places[0]].sensor.key(), case.sensors[pair.places[1]].sensor.key());
            let sentence = format!(
                "the {one} and the {other} share noise: their innovations are white, but have a correlation of {r:.2} \
             within a sample, and no setting corrects that"
            );
            let likely = LikelyCause::new(cause, r.abs(), 0.0, Vec::new(), sentence);
            found.push(LikelyCause { certain: true, ..likely });
        }
    },
};

pub(super) static WHITE_FORCE: Cause = Cause {
    key: "white_force",
    name: "a white force in place of Q",
    hint: "An unrecorded force also moves the plant within a step. Q of the velocity alone leaves that out, and with \
           fast sampling the parameters are off. Let the filter model a white force.",
    likely_causes: |bad, cause, found| {
        if let Some(edits) = with_white_force(bad) {
            let sentence = "Q of the velocity stands for a force that also moves the plant within a step".to_owned();
            found.push(LikelyCause::new(cause, 0.2, 0.0, edits, sentence));
        }
    },
};

pub(super) static PROCESS_NOISE: Cause = Cause {
    key: "process_noise",
    name: "Q of the motion",
    hint: "Q of the motion stands for unrecorded forces. If Q is too small, each innovation resembles the one before; \
           if it is too large, their signs alternate.",
    likely_causes: process_noise,
};

/// Source: Mehra (1970), On the identification of variances and adaptive Kalman filtering.
fn process_noise(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let (case, filter) = (bad.case, bad.filter);
    let first = case.largest_first_correlation();
    // If a white force drives the motion, it is the motion's only process noise.
    let is_white = filter.augment.contains(&Channel::WHITE_FORCE) && filter.process_std[Channel::WHITE_FORCE] > 0.0;
    let moves = |channel: &Channel| if is_white { *channel == Channel::WHITE_FORCE } else { !channel.is_parameter() };
    let motions = || case.estimates.channels().iter().copied().filter(moves);
    for factor in [0.03, 0.1, 0.3, 3.0, 10.0, 30.0] {
        let edits =
            motions().map(|channel| bad.entry("process_std", channel, factor * process_std(bad, filter, channel)));
        let agrees = (first > 0.0) == (factor > 1.0);
        let weight = if agrees { 2.0 * first.abs() / (1.0 + 2.0 * first.abs()) } else { 0.05 };
        let turned = |channel| process_std(bad, filter, channel) / process_std(bad, bad.origin, channel);
        let turned = motions().next().map(turned).filter(|turned| *turned > 0.0 && turned.is_finite());
        let since = factor * turned.unwrap_or(1.0);
        let (word, by) = if since > 1.0 { ("small", since) } else { ("large", 1.0 / since) };
        let sentence = format!(
            "Q of the motion is about {} times too {word}; the innovations are correlated by {first:.2} at lag 1",
            short(by * by)
        );
        let sentence = if libm::log(by) < 0.1 { String::new() } else { sentence };
        found.push(LikelyCause::new(cause, weight, 1.0, edits.collect(), sentence));
    }
}

/// A channel without process noise has a thousandth of its initial standard deviation.
fn process_std(bad: &BadFilter<'_>, of: &FilterSettings, channel: Channel) -> f64 {
    let std = of.process_std[channel];
    if std > 0.0 { std } else { 1e-3 * bad.filter.initial_std[channel] }
}

pub(super) static WIND_UP: Cause = Cause {
    key: "wind_up",
    name: "wind-up by fading",
    hint: "Fading forgets even while nothing is learnt. Switch it off, or give the parameters process noise instead.",
    likely_causes: |bad, cause, found| {
        if bad.filter.fading <= 1.0 {
            return;
        }
        let weight = bad.effect_of(|one| one.speaks_for == VerdictKind::WoundUp);
        let fading = bad.filter.fading;
        let fading = if fading < 1e6 { fading.to_string() } else { short(fading) };
        let sentence = format!("the filter forgets by λ = {fading} a sample while it learns little");
        let edits = vec![bad.edit("fading", 1.0)];
        found.push(LikelyCause { certain: weight > 0.0, ..LikelyCause::new(cause, weight, 0.0, edits, sentence) });
    },
};

pub(super) static COLLAPSED_SAMPLE: Cause = Cause {
    key: "collapsed_sample",
    name: "a collapsed sample",
    hint: "One particle has all the weight: the others do not fit. Use more particles, or more process noise.",
    likely_causes: |bad, cause, found| {
        let sizes = bad.case.estimates.effective_samples();
        let least = sizes.iter().copied().filter(|size| !size.is_nan()).fold(f64::INFINITY, f64::min);
        if least == f64::INFINITY {
            return;
        }
        let collapsed = bad.effect_of(|one| one.speaks_for == VerdictKind::Collapsed);
        let particles = bad.filter.ensemble_size;
        let more = (10 * particles).min(20_000);
        let edits = vec![bad.edit("ensemble_size", more as i64)];
        let sentence = format!("of {particles} particles only {} had all the weight at times", short(least));
        let weight = if collapsed > 0.0 || least < 3.0 { 0.9 } else { 0.3 };
        found.push(LikelyCause { certain: weight > 0.5, ..LikelyCause::new(cause, weight, 0.0, edits, sentence) });
    },
};
