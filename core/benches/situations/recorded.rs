//! The faults that are of the record alone.

use kalmanscope_core::record::Input;
use kalmanscope_core::{Channel, Record, Scenario};

use super::{Draw, Fault};

/// The record with a fault; the same one where the fault is another's.
pub(super) fn disturbed(fault: Fault, record: Record, truth: &Scenario, draw: &mut Draw) -> Record {
    let n = record.len();
    let place = draw.choice(&(0..truth.sensors.len()).collect::<Vec<_>>());
    let noise = truth.sensors[place].noise_std;
    let mut input = record.input().to_vec();
    match fault {
        Fault::NoiseSwings => {
            let (more, period) = (draw.uniform(1.0, 2.5), draw.uniform(0.4, 0.9));
            let turn = |k: usize| std::f64::consts::TAU * k as f64 / (n as f64 * period);
            let size = |k: usize| more * noise * (0.5 + 0.5 * libm::sin(turn(k)));
            let errors: Vec<f64> = (0..n).map(|k| size(k) * draw.normal()).collect();
            return record.with_measured(|sensor, k, value| value + if sensor == place { errors[k] } else { 0.0 });
        }
        Fault::Hum => {
            let (turn, size) = (draw.uniform(0.6, 2.5), draw.uniform(1.0, 3.0) * noise);
            let line = |k: usize| size * libm::sin(turn * k as f64);
            return record.with_measured(|sensor, k, value| value + if sensor == place { line(k) } else { 0.0 });
        }
        Fault::NoisyInput => {
            let rms = (input.iter().map(|force| force * force).sum::<f64>() / n as f64).sqrt();
            let std = draw.uniform(0.2, 0.5) * rms;
            input.iter_mut().for_each(|force| *force += std * draw.normal());
        }
        Fault::DeadInput => input[n * 3 / 4..].fill(0.0),
        _ => return record,
    }
    let columns = record.sensors().iter().enumerate().map(|(i, &q)| (q, record.measured(i).to_vec())).collect();
    let input = Input { kind: record.input_kind(), hold: record.hold(), values: input };
    let known = Channel::all().iter().filter_map(|&channel| Some((channel, record.truth(channel)?.to_vec())));
    let copy = Record::new(record.dt(), input, columns).and_then(|copy| copy.with_truth(known.collect()));
    copy.expect("it is like the one before")
}
