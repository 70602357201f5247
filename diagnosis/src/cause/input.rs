//! Causes in the recorded input, and in what the settings assume of steps and sensors.

use std::ops::Range;

use kalmanscope_core::import::Mapping;
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Channel, Hold, InputKind, Propagation, Quantity};

use super::{BadFilter, Cause, LikelyCause, rms};
use crate::words::short;

const MOST: i32 = 3;

pub(super) static INPUT_DELAY: Cause = Cause {
    key: "input_delay",
    name: "an input that is late or early",
    hint: "If input and sensors have different filters or clocks, one is late. Shift the input by whole samples.",
    likely_causes: |bad, cause, found| {
        if bad.input_size() == 0.0 {
            return;
        }
        let near = bad.follows_input(-MOST..=MOST);
        for shift in (-MOST..=MOST).filter(|&shift| shift != 0) {
            let delay = bad.filter.input_delay + shift;
            let since = delay - bad.origin.input_delay;
            let (count, word) = (since.abs(), if since < 0 { "late" } else { "early" });
            let plural = if count == 1 { "" } else { "s" };
            let sentence =
                if count == 0 { String::new() } else { format!("the recorded input is {count} sample{plural} {word}") };
            let weight = 2.0 * near / (1.0 + 2.0 * near) / f64::from(shift.abs()).sqrt();
            found.push(LikelyCause::new(cause, weight, 1.0, vec![bad.edit("input_delay", i64::from(delay))], sentence));
        }
    },
};

/// The steps in place of one of a record whose input is a smooth curve.
const FINER: i32 = 4;

pub(super) static INPUT_HOLD: Cause = Cause {
    key: "input_hold",
    name: "the input between samples: linear or held",
    hint: "A digital output holds its value between samples. A measured input is nearer to a straight line, or, with \
           few samples a cycle, to a smooth curve.",
    likely_causes: |bad, cause, found| {
        if bad.input_size() == 0.0 {
            return;
        }
        let (value, sentence) = match bad.scenario.hold {
            Hold::Zero => ("first", "the input is linear between samples, not held"),
            Hold::First => ("zero", "the input is held between samples, not linear"),
        };
        let near = bad.follows_input(-1..=1);
        let weight = 2.0 * near / (1.0 + 2.0 * near);
        found.push(LikelyCause::new(cause, weight, 0.0, vec![Edit::new("hold", value)], sentence.to_owned()));
        let is_coarse = |mapping: &Mapping| mapping.interpolate == 1 && bad.case.record.clocks().is_none();
        if bad.scenario.hold == Hold::First && bad.scenario.record.as_ref().is_some_and(is_coarse) {
            // Process noise adds up over the steps of a sample.
            let share = 1.0 / f64::from(FINER).sqrt();
            let noise = |channel: &Channel| {
                let std = bad.filter.process_std[*channel];
                (std > 0.0).then(|| bad.entry("process_std", *channel, share * std))
            };
            let mut edits = vec![Edit::new("record.interpolate", i64::from(FINER))];
            edits.extend(bad.case.estimates.channels().iter().filter_map(noise));
            let sentence = "the input is a smooth curve between samples, and straight lines cut its peaks".to_owned();
            found.push(LikelyCause::new(cause, weight, 0.0, edits, sentence));
        }
    },
};

pub(super) static INPUT_GAIN: Cause = Cause {
    key: "input_gain",
    name: "the gain of the input",
    hint: "The input is not force over mass: a wrong unit, mass or calibration. Let the filter estimate its gain.",
    likely_causes: |bad, cause, found| {
        if bad.input_size() == 0.0 || bad.filter.augment.contains(&Channel::INPUT_GAIN) {
            return;
        }
        let broad = bad.follows_input(1..=i32::MAX);
        let weight = 1.5 * broad / (1.0 + 1.5 * broad);
        let ratio = load(bad).map_or(1.0, |load| load / bad.input_size());
        let edits = if ratio.is_normal() && !FEW.contains(&ratio) {
            let [mean, std, _] = bad.begins(Channel::INPUT_GAIN.key(), 0.5 * ratio, ratio);
            vec![bad.augmented(Channel::INPUT_GAIN), mean, std]
        } else {
            vec![bad.augmented(Channel::INPUT_GAIN), bad.entry("initial_std", Channel::INPUT_GAIN, 0.5)]
        };
        found.push(LikelyCause::new(cause, weight, 1.0, edits, "the gain of the input is wrong".to_owned()));
    },
};

/// Gains of an input in about its right unit, by the sizes of input and motion. A belief that begins at 1 reaches no others.
const FEW: std::ops::Range<f64> = 0.03..30.0;

/// The size of the force over mass that carries the spring, by the readings \[m/s²\].
fn load(bad: &BadFilter<'_>) -> Option<f64> {
    let (case, wn) = (bad.case, bad.frequency()?);
    let of = |(quantity, by): (Quantity, f64)| Some((case.record.measured_quantity(quantity)?, by));
    let orders = [(Quantity::DISPLACEMENT, wn * wn), (Quantity::VELOCITY, wn), (Quantity::ACCELERATION, 1.0)];
    let (measured, by) = orders.into_iter().find_map(of)?;
    Some(by * rms(&measured[case.samples.clone()]))
}

pub(super) static INPUT_OFFSET: Cause = Cause {
    key: "input_offset",
    name: "an offset of the input",
    hint: "An amplifier's zero is off, or a constant force acts. Let the filter estimate it, or subtract the mean.",
    likely_causes: |bad, cause, found| {
        if bad.filter.augment.contains(&Channel::INPUT_OFFSET) {
            return;
        }
        let case = bad.case;
        let mean = case.sensors.iter().map(|one| one.mean(&case.kept).abs()).fold(0.0, f64::max);
        let weight = 2.0 * mean / (1.0 + 2.0 * mean);
        let stiffness = bad.frequency().map_or(0.0, |wn| wn * wn * bad.size());
        // Input and motion may both be zero, and a σ of zero would keep the offset as it is.
        let std = bad.input_size().max(stiffness).max(1e-9);
        let edits = vec![bad.augmented(Channel::INPUT_OFFSET), bad.entry("initial_std", Channel::INPUT_OFFSET, std)];
        found.push(LikelyCause::new(cause, weight, 1.0, edits, "the record lacks a constant force".to_owned()));
    },
};

/// The least share of the other samples in which the input must change: steps and trains of blows are constant by nature.
const MOVES: f64 = 0.5;

const RISE: f64 = 1.5;

pub(super) static STILL_INPUT: Cause = Cause {
    key: "still_input",
    name: "an input that is not recorded for a while",
    hint: "A cable, an amplifier or a logger stopped. No setting corrects that: leave out that part of the record.",
    likely_causes: |bad, cause, found| {
        let case = bad.case;
        let input = &case.record.input()[case.samples.clone()];
        let Some(still) = still_part(input) else { return };
        let part = case.samples.start + still.start..case.samples.start + still.end;
        let nis = |samples: Range<usize>| case.diagnostics.nis_within(samples);
        let [before, behind] = [nis(case.samples.start..part.start), nis(part.end..case.samples.end)];
        let there = nis(part.clone()).per_degree();
        let elsewhere = (before.sum + behind.sum) / f64::from(before.degrees + behind.degrees);
        // Without readings, there or elsewhere, the level is NaN, which is no evidence.
        let rises = there > RISE && there > RISE * elsewhere;
        if !rises {
            return;
        }
        let time = |sample: usize| short(case.record.time(sample));
        let until = if part.end == case.samples.end { "on".to_owned() } else { format!("to {} s", time(part.end)) };
        let (from, times, others) = (time(part.start), short(there), short(elsewhere));
        let sentence = format!(
            "the input is constant from {from} s {until}, where innovations² are {times} times what is expected ({others} \
             elsewhere): it is not recorded there, and no setting corrects that"
        );
        let likely = LikelyCause::new(cause, 1.0 - 1.0 / there, 0.0, Vec::new(), sentence).of_record();
        found.push(LikelyCause { samples: Some(part), ..likely });
    },
};

/// The longest part of an input that is constant, where the rest moves.
pub fn still_part(input: &[f64]) -> Option<Range<usize>> {
    let mut end = 0;
    let runs = input.chunk_by(|one, next| one.to_bits() == next.to_bits()).map(|run| {
        end += run.len();
        end - run.len()..end
    });
    let longest = runs.reduce(|longest, run| if run.len() > longest.len() { run } else { longest }).unwrap_or(0..0);
    let least = ((0.05 * input.len() as f64) as usize).max(20);
    let elsewhere = input.len() - longest.len();
    // To the bit: a logger that stands still repeats its number, and a slow signal changes in its last digits.
    let changes = input.windows(2).filter(|pair| pair[0].to_bits() != pair[1].to_bits()).count();
    (longest.len() >= least && changes as f64 > MOVES * elsewhere as f64 && elsewhere > 0).then_some(longest)
}

/// The angle of a swing in a step \[rad\] above which a step of a set number of parts is coarse.
const COARSE: f64 = 0.3;

pub(super) static COARSE_PROPAGATION: Cause = Cause {
    key: "coarse_propagation",
    name: "steps of the propagation that are too coarse",
    hint: "Euler's step adds about ωₙ dt/2 to the damping ratio. A Runge-Kutta step is inexact if a sample is a large \
           part of a cycle. Choose automatic steps.",
    likely_causes: coarse_propagation,
};

fn coarse_propagation(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let Some(frequency) = bad.frequency() else { return };
    let (filter, truth) = (bad.filter, &bad.scenario.plant.kind);
    let steps = filter.steps(truth, bad.scenario.input, bad.case.record.dt());
    let turn = frequency * bad.case.record.dt() / steps as f64;
    let sentence = match filter.propagation_for(truth) {
        Propagation::Euler => {
            format!("the steps of Euler's propagation are too coarse: they change ζ by about {}", short(0.5 * turn))
        }
        _ if turn > COARSE && (filter.substeps > 0 || filter.propagation.is_some()) => {
            format!("the steps of the propagation are too coarse: a cycle has {}", short(std::f64::consts::TAU / turn))
        }
        _ => return,
    };
    let edits = vec![bad.edit("propagation", "automatic"), bad.edit("substeps", 0)];
    found.push(LikelyCause::new(cause, 0.5, 0.0, edits, sentence));
}

/// Limits the share of the input in innovations of an accelerometer with the other meaning, and its deviation from 1.
const CLEAR: f64 = 0.3;

pub(super) static ABSOLUTE_ACCELERATION: Cause = Cause {
    key: "absolute_acceleration",
    name: "an accelerometer of the wrong kind: absolute or relative",
    hint: "On moving ground, an absolute accelerometer also reads the ground's acceleration, and a relative one does \
           not. Give its column the other meaning.",
    likely_causes: absolute_acceleration,
};

/// The innovations of an accelerometer with the other meaning contain the ground's acceleration itself, with factor 1 or -1.
fn absolute_acceleration(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let case = bad.case;
    if bad.scenario.input != InputKind::GroundAcceleration {
        return;
    }
    for (place, one) in case.sensors.iter().enumerate() {
        let (is_told, is, factor) = match one.sensor {
            sensor if sensor.aspect() == Quantity::ACCELERATION.aspect() => ("relative", "total_acceleration", 1.0),
            sensor if sensor.aspect() == Quantity::TOTAL_ACCELERATION.aspect() => ("absolute", "acceleration", -1.0),
            _ => continue,
        };
        let pairs = case.samples.clone().map(|k| (case.estimates.innovation(k)[place], case.record.input()[k]));
        let [mut product, mut squares, mut inputs] = [0.0; 3];
        for (innovation, input) in pairs.filter(|(e, f)| (e * f).is_finite()) {
            product += innovation * input;
            squares += innovation * innovation;
            inputs += input * input;
        }
        let (share, correlation) = (factor * product / inputs, factor * product / (squares * inputs).sqrt());
        let is_clear = (share - 1.0).abs() <= CLEAR && correlation >= CLEAR;
        if !is_clear {
            continue;
        }
        let contain =
            format!("the innovations of the {} contain {share:.2} times the ground's acceleration", one.sensor.key());
        let sentence = format!("{contain}: it is not {is_told}, but `{is}`, and no setting of a filter corrects that");
        found.push(LikelyCause::new(cause, correlation, 0.0, Vec::new(), sentence).of_record());
    }
}
