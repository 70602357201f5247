//! The power of a measurement over time and frequency.

use std::f64::consts::{PI, TAU};

use crate::Record;
use crate::fourier::Transform;

/// Limits the length of a window.
const WINDOW: [usize; 2] = [64, 1024];
/// The windows that a record should have at least, before they overlap.
const WINDOWS: usize = 24;
/// Limits the columns.
const COLUMNS: usize = 400;

/// The power of a measurement in windows that overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrogram {
    /// The middle of the first window \[s\].
    pub start: f64,
    /// The time between windows \[s\].
    pub step: f64,
    /// The distance of the frequencies, of which the first is 0 \[rad/s\].
    pub resolution: f64,
    /// The power in each window at each frequency up to the Nyquist frequency, in dB below the highest.
    pub decibels: Vec<Vec<f32>>,
}

impl Spectrogram {
    /// The spectrogram of the first `samples` measurements of a sensor; none where there are too few. A missing measurement
    /// repeats the one before it.
    ///
    /// Source: Oppenheim and Schafer (2010), *Discrete-Time Signal Processing*, section 10.3.
    pub fn new(record: &Record, sensor: usize, samples: usize) -> Option<Self> {
        let mut last = 0.0;
        let measured = record.measured(sensor).iter().take(samples);
        let values = measured.map(|&value| {
            if !value.is_nan() {
                last = value;
            }
            last
        });
        let values: Vec<f64> = values.collect();
        let [shortest, longest] = WINDOW;
        let length =
            (0..).map(|i| longest >> i).take_while(|&l| l >= shortest).find(|l| l * WINDOWS <= values.len())?;
        let hop = (length / 4).max(values.len() / COLUMNS);
        let weights: Vec<f64> = (0..length).map(|k| libm::sin(PI * (k as f64 + 0.5) / length as f64)).collect();
        let transform = Transform::new(length);
        let mut buffer = vec![(0.0, 0.0); length];
        let mut power: Vec<Vec<f64>> = Vec::new();
        for begin in (0..=values.len() - length).step_by(hop) {
            let window = &values[begin..begin + length];
            let mean = window.iter().sum::<f64>() / length as f64;
            for ((slot, value), weight) in buffer.iter_mut().zip(window).zip(&weights) {
                *slot = (weight * weight * (value - mean), 0.0);
            }
            transform.apply(&mut buffer);
            power.push(buffer[..=length / 2].iter().map(|(re, im)| re * re + im * im).collect());
        }
        let most = power.iter().flatten().fold(f64::MIN_POSITIVE, |most, &p| most.max(p));
        let decibels = |p: &f64| (10.0 * libm::log10((p / most).max(1e-30))) as f32;
        Some(Self {
            start: record.time(0) + 0.5 * length as f64 * record.dt(),
            step: hop as f64 * record.dt(),
            resolution: TAU / (length as f64 * record.dt()),
            decibels: power.iter().map(|column| column.iter().map(decibels).collect()).collect(),
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::record::Input;
    use crate::{Hold, InputKind, Quantity};

    #[test]
    fn a_tone_that_jumps_is_found_before_and_after() {
        let tone = |k: usize| if k < 4000 { 0.5 } else { 1.5 };
        let measured: Vec<f64> = (0..8000).map(|k| libm::sin(tone(k) * k as f64)).collect();
        let input = Input { kind: InputKind::Force, hold: Hold::Zero, values: vec![0.0; 8000] };
        let record = Record::new(0.01, input, vec![(Quantity::DISPLACEMENT, measured)]).unwrap();
        let spectrogram = Spectrogram::new(&record, 0, 8000).unwrap();
        let peak = |time: f64| {
            let column = &spectrogram.decibels[((time - spectrogram.start) / spectrogram.step) as usize];
            let place = (0..column.len()).max_by(|&a, &b| column[a].total_cmp(&column[b])).unwrap();
            place as f64 * spectrogram.resolution * 0.01
        };
        assert!((peak(20.0) - 0.5).abs() < 0.02 && (peak(60.0) - 1.5).abs() < 0.02, "{} {}", peak(20.0), peak(60.0));
        assert_eq!(Spectrogram::new(&record, 0, 100), None);
    }
}
