//! The faults that are the record's.

use kalmanscope_core::{Channel, Quantity, Record, Scenario};

use super::{Draw, Fault};

/// The record with a fault; the same one where the fault is another's.
pub(super) fn disturbed(fault: Fault, record: &Record, truth: &Scenario, draw: &mut Draw) -> Record {
    let n = record.len();
    let mut input = record.input().to_vec();
    let mut columns: Vec<(Quantity, Vec<f64>)> =
        record.sensors().iter().enumerate().map(|(i, &q)| (q, record.measured(i).to_vec())).collect();
    let noise: Vec<f64> = truth.sensors.iter().map(|sensor| sensor.noise_std).collect();
    let place = draw.choice(&(0..columns.len()).collect::<Vec<_>>());
    match fault {
        Fault::Quantised => {
            for ((_, values), std) in columns.iter_mut().zip(&noise) {
                let step = draw.log_uniform(5.0, 20.0) * std;
                values.iter_mut().for_each(|value| *value = (*value / step).round() * step);
            }
        }
        Fault::Clipped => {
            let limit = draw.uniform(0.9, 1.6) * rms(&columns[place].1);
            columns[place].1.iter_mut().for_each(|value| *value = value.clamp(-limit, limit));
        }
        Fault::Outliers => {
            for ((_, values), std) in columns.iter_mut().zip(&noise) {
                for value in values.iter_mut() {
                    if draw.uniform(0.0, 1.0) < 0.01 {
                        *value += draw.sign() * draw.uniform(8.0, 25.0) * std;
                    }
                }
            }
        }
        Fault::Coloured => {
            let memory = draw.uniform(0.5, 0.9);
            for ((_, values), std) in columns.iter_mut().zip(&noise) {
                let mut last = 0.0;
                for value in values.iter_mut() {
                    last = memory * last + (1.0 - memory * memory).sqrt() * draw.normal();
                    *value += 1.5 * std * last;
                }
            }
        }
        Fault::NoisierLater | Fault::NoiseSwings => {
            let (from, more) = (draw.uniform(0.3, 0.8), draw.uniform(1.0, 2.5));
            let period = draw.uniform(0.4, 0.9);
            let (values, std) = (&mut columns[place].1, noise[place]);
            for (k, value) in values.iter_mut().enumerate() {
                let share = k as f64 / n as f64;
                let swing = 0.5 + 0.5 * libm::sin(std::f64::consts::TAU * share / period);
                let size = if fault == Fault::NoiseSwings { swing } else { f64::from(u8::from(share > from)) };
                *value += more * size * std * draw.normal();
            }
        }
        Fault::Hum => {
            let turn = draw.uniform(0.6, 2.5);
            let (values, std) = (&mut columns[place].1, noise[place]);
            let size = draw.uniform(1.0, 3.0) * std;
            values.iter_mut().enumerate().for_each(|(k, value)| *value += size * libm::sin(turn * k as f64));
        }
        Fault::NoisyInput => {
            let std = draw.uniform(0.2, 0.5) * rms(&input);
            input.iter_mut().for_each(|force| *force += std * draw.normal());
        }
        Fault::Scale => {
            let scale = if draw.sign() > 0.0 { draw.uniform(0.7, 0.9) } else { draw.uniform(1.1, 1.4) };
            columns[place].1.iter_mut().for_each(|value| *value *= scale);
        }
        Fault::DeadInput => input[n * 3 / 4..].fill(0.0),
        _ => {}
    }
    let input = kalmanscope_core::record::Input { kind: record.input_kind(), hold: record.hold(), values: input };
    let known = Channel::all().iter().filter_map(|&c| Some((c, record.truth(c)?.to_vec())));
    let known: Vec<(Channel, Vec<f64>)> = known.collect();
    let copy = Record::new(record.dt(), input, columns).and_then(|copy| copy.with_truth(known));
    copy.expect("it is like the one before")
}

fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len().max(1) as f64).sqrt()
}
