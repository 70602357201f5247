//! Two sensors of one mass do not agree: one has a wrong sign, a wrong scale, or is late; or the times of all are wrong.

use super::{BadFilter, Cause, LikelyCause};
use crate::judgement::diagnosis::agreement::Agreement;
use crate::judgement::diagnosis::readings::clipped_ends;
use crate::judgement::diagnosis::words::short;
use crate::mathematics::quantity::{Aspect, Quantity};

/// The least deviation of a factor from 1 that is a fault, and the least lateness in samples.
const SCALE: f64 = 0.04;
const LATE: f64 = 1.0;

/// A fault must be so many of its standard deviations.
const SURE: f64 = 5.0;

/// Factors that differ by less than this share are the same.
const ALIKE: f64 = 0.02;

/// A σ that is so many times its first one leaves a sensor out.
const SILENCE: f64 = 1000.0;

/// A sensor that is late by less than this share of a step is in time.
const IN_TIME: f64 = 0.1;

/// The initial standard deviation of a gain, relative to the gain.
const GAIN_STD: f64 = 0.05;

pub(super) static SIGN: Cause = Cause {
    key: "sensor_sign",
    name: "the sign of a sensor",
    hint: "One of two sensors counts in the other direction. Let the filter estimate its gain, or give its column the gain -1.",
    likely_causes: |bad, cause, found| likely_causes(bad, cause, found, Fault::Sign),
};

pub(super) static SCALE_OF: Cause = Cause {
    key: "sensor_scale",
    name: "the scale of a sensor",
    hint: "One of two sensors reads too much or too little by a factor: a unit, a gain, a calibration. Let the filter estimate its gain, or \
           give its column the right one.",
    likely_causes: |bad, cause, found| likely_causes(bad, cause, found, Fault::Scale),
};

pub(super) static TIMES: Cause = Cause {
    key: "times",
    name: "the time between samples",
    hint: "All sensors agree with each other once the times are stretched: the sample rate or the unit of the times is wrong. Give the \
           record the right one.",
    likely_causes: wrong_times,
};

pub(super) static LATENESS: Cause = Cause {
    key: "sensor_late",
    name: "a sensor that is late",
    hint: "One of two sensors reads later than the other: a filter of its amplifier, or another clock. Give the filter, or its column, the \
           delay.",
    likely_causes: |bad, cause, found| likely_causes(bad, cause, found, Fault::Late),
};

/// Quantities with the quantity that is their rate.
const RATES: [(Aspect, Aspect); 2] =
    [(Aspect::DISPLACEMENT, Aspect::VELOCITY), (Aspect::VELOCITY, Aspect::ACCELERATION)];

#[derive(Clone, Copy, PartialEq)]
enum Fault {
    Sign,
    Scale,
    Late,
}

/// A sensor and that of its rate, by their places, and how they agree.
struct Pair {
    places: [usize; 2],
    agreement: Agreement,
}

/// All pairs of a sensor with that of its rate, unless an earlier repair has left one out.
fn pairs(bad: &BadFilter<'_>) -> Vec<Pair> {
    let case = bad.case;
    let sensors = &bad.scenario.sensors;
    let of = |(place, one): (usize, &crate::Sensor)| {
        let (_, rate) = RATES.iter().find(|(of, _)| *of == one.measures.aspect())?;
        let other = sensors.iter().position(|other| other.measures == Quantity::new(*rate, one.measures.mass()))?;
        let is_left_out = |place: usize| bad.filter.sensor_std[place] >= SILENCE * bad.origin.sensor_std[place];
        if [place, other].into_iter().any(is_left_out) {
            return None;
        }
        let part = |place: usize| {
            let column = case.estimates.measured(case.record, place)?;
            Some(without_ends(&case.samples.clone().map(column).collect::<Vec<f64>>()))
        };
        let (values, rates) = (part(place)?, part(other)?);
        let agreement = Agreement::of(&values, &rates, case.record.dt(), bad.filter.sensor_std[other])?;
        Some(Pair { places: [place, other], agreement })
    };
    sensors.iter().enumerate().filter_map(of).collect()
}

fn is_off(Agreement { factor, std, .. }: &Agreement) -> bool {
    let off = (factor.abs() - 1.0).abs();
    off > SCALE && off > SURE * std
}

/// The factor by which all sensors change more than those of their rates say, where there are two pairs or more and it is the same
/// one: then the times are wrong, and no sensor is.
fn common_factor(pairs: &[Pair]) -> Option<f64> {
    let [first, others @ ..] = pairs else { return None };
    let Agreement { factor, std, .. } = first.agreement;
    let is_same = |pair: &Pair| {
        let Agreement { factor: other, std: other_std, .. } = pair.agreement;
        (other - factor).abs() <= ALIKE * factor.abs() + SURE * libm::hypot(std, other_std)
    };
    let is_common = !others.is_empty() && factor > 0.0 && others.iter().all(is_same);
    (is_common && pairs.iter().all(|pair| is_off(&pair.agreement))).then_some(factor)
}

fn wrong_times(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let Some(factor) = common_factor(&pairs(bad)) else { return };
    let dt = bad.case.record.dt();
    let sentence = format!(
        "each sensor changes {} times as much as the next one says: the time between samples is about {factor:.3} times the {dt} s that \
         are told, and no setting mends that",
        short(factor)
    );
    let off = (factor - 1.0).abs();
    let likely = LikelyCause::new(cause, off / (1.0 + off), 0.0, Vec::new(), sentence);
    found.push(LikelyCause { certain: true, of_record: true, ..likely });
}

/// Compares each sensor with that of its rate, and tries the filter with either one put right: the likelihood tells which one is wrong.
fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>, fault: Fault) {
    let pairs = pairs(bad);
    if fault == Fault::Scale && common_factor(&pairs).is_some() {
        return;
    }
    for pair in pairs {
        let sensors = pair.places.map(|place| bad.scenario.sensors[place].measures);
        // With the gain of either the filter can make them agree.
        if fault != Fault::Late && sensors.iter().any(|sensor| bad.filter.augment.contains(&sensor.gain())) {
            continue;
        }
        let Some((size, sentence)) = disagreement(&pair, sensors, fault, bad.case.record.dt()) else { continue };
        let Agreement { factor, late, .. } = pair.agreement;
        // The sensor itself reads so much more, or later; or its rate so much less, or earlier.
        for (which, gain, steps) in [(0, factor, -late), (1, 1.0 / factor, late)] {
            let name = sensors[which].name();
            let (edits, end) = match fault {
                Fault::Sign | Fault::Scale => {
                    let channel = sensors[which].gain();
                    let edit = |table: &str, value: f64| bad.edit(&format!("{table}.{}", channel.key()), value);
                    let (mean, std) = (edit("initial_mean", gain), edit("initial_std", GAIN_STD * gain.abs()));
                    let end = match fault {
                        Fault::Sign => format!("so it is if the {name} counts in the other direction"),
                        _ => format!("so it is if the {name} reads {} times what it should", short(gain.abs())),
                    };
                    (vec![bad.augmented(channel), mean, std], end)
                }
                Fault::Late => {
                    let (own, other) = (pair.places[which], pair.places[1 - which]);
                    let delay = delay_of(bad, own, other, steps);
                    let mut delays = bad.filter.sensor_delay.clone();
                    delays.resize(bad.scenario.sensors.len(), 0.0);
                    delays[own] = delay;
                    let end = match delay {
                        0.0 => format!("so it is if the {name} is in time"),
                        late if late > 0.0 => format!("so it is if the {name} is {} s late", short(late)),
                        early => format!("so it is if the {name} is {} s early", short(-early)),
                    };
                    (vec![bad.edit("sensor_delay", delays)], end)
                }
            };
            let likely = LikelyCause::new(cause, size, 1.0, edits, format!("{sentence}: {end}"));
            found.push(LikelyCause { certain: true, of_record: true, ..likely });
        }
    }
}

/// How large a fault of a pair of sensors is, and what is seen of it. `None` if they do not have it.
fn disagreement(pair: &Pair, sensors: [Quantity; 2], fault: Fault, dt: f64) -> Option<(f64, String)> {
    let Agreement { factor, late, late_std, .. } = pair.agreement;
    let [name, rate_name] = sensors.map(Quantity::name);
    let off = (factor.abs() - 1.0).abs();
    let (is_so, size, sentence) = match fault {
        Fault::Sign => (factor < 0.0, 1.0, format!("the {name} falls where the {rate_name} says that it rises")),
        Fault::Scale => {
            let times = short(factor.abs());
            let sentence = format!("the {name} changes {times} times as much as the {rate_name} says");
            (is_off(&pair.agreement), off / (1.0 + off), sentence)
        }
        Fault::Late => {
            let (first, second) = if late > 0.0 { (&rate_name, &name) } else { (&name, &rate_name) };
            let sentence = format!("the {first} comes {} s after the {second}", short(late.abs() * dt));
            let is_so = late.abs() > LATE && late.abs() > SURE * late_std;
            (is_so, late.abs() / (1.0 + late.abs()), sentence)
        }
    };
    is_so.then_some((size, sentence))
}

/// The delay with which a sensor agrees with another one \[s\]. It is `steps` later than the filter takes it to be.
fn delay_of(bad: &BadFilter<'_>, own: usize, other: usize, steps: f64) -> f64 {
    let dt = bad.case.record.dt();
    let delays = bad.filter.delays(dt);
    // The two were compared at whole steps of each.
    let between = libm::round(delays.of(own)) - libm::round(delays.of(other));
    let delay = delays.of(other) + between + steps;
    if delay.abs() < IN_TIME { 0.0 } else { delay * dt }
}

/// The readings without those at the end of a sensor's range.
fn without_ends(values: &[f64]) -> Vec<f64> {
    let ends = clipped_ends(values);
    values.iter().map(|value| if ends.contains(value) { f64::NAN } else { *value }).collect()
}
