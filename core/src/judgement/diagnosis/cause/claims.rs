//! What the settings claim of steps and sensors, and is not so.

use super::{BadFilter, Cause, LikelyCause};
use crate::Quantity;
use crate::filter::Propagation;
use crate::judgement::words::short;
use crate::mathematics::model::InputKind;

/// The angle of a swing in a step \[rad\] above which a step of a set number of parts is coarse.
const COARSE: f64 = 0.3;

pub(super) static COARSE_PROPAGATION: Cause = Cause {
    key: "coarse_propagation",
    name: "steps of the propagation that are too coarse",
    hint: "Euler's step adds about ωₙ dt/2 to the damping ratio, and one Runge-Kutta step errs where a sample is a large part of a \
           swing. Let the propagation and its parts be chosen automatically.",
    likely_causes: coarse_propagation,
};

fn coarse_propagation(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let Some(frequency) = bad.frequency() else { return };
    let (filter, truth) = (bad.filter, bad.scenario.plant.kind);
    let steps = filter.steps(truth, bad.scenario.input, bad.case.record.dt());
    let turn = frequency * bad.case.record.dt() / steps as f64;
    let sentence = match filter.propagation_for(truth) {
        Propagation::Euler => {
            format!("the steps of Euler's propagation are too coarse: they change ζ by about {}", short(0.5 * turn))
        }
        _ if turn > COARSE && (filter.substeps > 0 || filter.propagation.is_some()) => {
            format!("the steps of the propagation are too coarse: a swing has {}", short(std::f64::consts::TAU / turn))
        }
        _ => return,
    };
    let edits = vec![bad.edit("propagation", "automatic"), bad.edit("substeps", 0)];
    found.push(LikelyCause::new(cause, 0.5, 0.0, edits, sentence));
}

/// The share of the input in innovations that tells an absolute accelerometer from a relative one, and its deviation from 1.
const CLEAR: f64 = 0.3;

pub(super) static ABSOLUTE_ACCELERATION: Cause = Cause {
    key: "absolute_acceleration",
    name: "an absolute accelerometer taken for a relative one, or the other way round",
    hint: "On a ground that moves, an accelerometer reads the ground's acceleration besides that against the ground. Give its column \
           the other meaning.",
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
        if (share - 1.0).abs() > CLEAR || correlation < CLEAR {
            continue;
        }
        let sentence = format!(
            "the innovations of the {} contain {share:.2} times the ground's acceleration: it is no {is_told} one, but `{is}`, and no \
             setting of a filter mends that",
            one.sensor.key()
        );
        let likely = LikelyCause::new(cause, correlation, 0.0, Vec::new(), sentence);
        found.push(LikelyCause { certain: true, of_record: true, ..likely });
    }
}
