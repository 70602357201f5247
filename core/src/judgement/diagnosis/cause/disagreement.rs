//! Two sensors of one mass do not agree: one has a wrong sign, a wrong scale, or is late.

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

/// The factor on a σ that leaves a sensor out.
const SILENCE: f64 = 1000.0;

pub(super) static SIGN: Cause = Cause {
    key: "sensor_sign",
    name: "the sign of a sensor",
    hint: "One of two sensors counts in the other direction. Give its column the gain -1.",
    likely_causes: |bad, cause, found| likely_causes(bad, cause, found, Fault::Sign),
};

pub(super) static SCALE_OF: Cause = Cause {
    key: "sensor_scale",
    name: "the scale of a sensor",
    hint: "One of two sensors reads too much or too little by a factor: a unit, a gain, a calibration. Give its column the right gain.",
    likely_causes: |bad, cause, found| likely_causes(bad, cause, found, Fault::Scale),
};

pub(super) static LATENESS: Cause = Cause {
    key: "sensor_late",
    name: "a sensor that is late",
    hint: "One of two sensors reads later than the other: a filter of its amplifier, or another clock. Give its column the delay.",
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

/// Compares each sensor with that of its rate, and tries the filter without either: the likelihood tells which one is wrong.
fn likely_causes(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>, fault: Fault) {
    let case = bad.case;
    let sensors = &bad.scenario.sensors;
    for (place, one) in sensors.iter().enumerate() {
        let rate = RATES.iter().find(|(of, _)| *of == one.measures.aspect()).map(|(_, rate)| *rate);
        let Some(rate) = rate else { continue };
        let is_rate = |other: &crate::Sensor| other.measures == Quantity::new(rate, one.measures.mass());
        let Some(other) = sensors.iter().position(is_rate) else { continue };
        // An earlier repair has left one of them out.
        let is_left_out = |place: usize| bad.filter.sensor_std[place] >= SILENCE * bad.origin.sensor_std[place];
        if [place, other].into_iter().any(is_left_out) {
            continue;
        }
        let columns = [place, other].map(|place| case.record.measured_quantity(sensors[place].measures));
        let [Some(values), Some(rates)] = columns else { continue };
        let part = |column: &[f64]| without_ends(&column[case.samples.clone()]);
        let noise = bad.filter.sensor_std[other];
        let Some(agreement) = Agreement::of(&part(values), &part(rates), case.record.dt(), noise) else { continue };
        let Agreement { factor, std, late, late_std } = agreement;
        let names = [place, other].map(|place| sensors[place].measures.name());
        let [name, rate_name] = names.each_ref().map(String::as_str);
        let off = (factor.abs() - 1.0).abs();
        let (is_so, size, sentence) = match fault {
            Fault::Sign => {
                let sentence = format!("the {name} falls where the {rate_name} says that it rises");
                (factor < 0.0, 1.0, sentence)
            }
            Fault::Scale => {
                let sentence =
                    format!("the {name} changes {} times as much as the {rate_name} says", short(factor.abs()));
                (off > SCALE && off > SURE * std, off / (1.0 + off), sentence)
            }
            Fault::Late => {
                let (first, second) = if late > 0.0 { (rate_name, name) } else { (name, rate_name) };
                let time = short(late.abs() * case.record.dt());
                let is_so = late.abs() > LATE && late.abs() > SURE * late_std;
                (is_so, late.abs() / (1.0 + late.abs()), format!("the {first} is {time} s later than the {second}"))
            }
        };
        if !is_so {
            continue;
        }
        for which in [place, other] {
            let mut stds = bad.filter.sensor_std.clone();
            stds[which] *= SILENCE;
            let name = sensors[which].measures.name();
            let sentence = format!("{sentence}; the other readings fit better without the {name}");
            let likely = LikelyCause::new(cause, size, 1.0, vec![bad.edit("sensor_std", stds)], sentence);
            found.push(LikelyCause { certain: true, of_record: true, ..likely });
        }
    }
}

/// The readings without those at the end of a sensor's range.
fn without_ends(values: &[f64]) -> Vec<f64> {
    let ends = clipped_ends(values);
    values.iter().map(|value| if ends.contains(value) { f64::NAN } else { *value }).collect()
}
