//! The power of a measurement over time and frequency.

use std::f64::consts::{PI, TAU};

use kalmanscope_filters::fourier::Transform;
use kalmanscope_filters::lists::{mapped, numbers};
use kalmanscope_records::{Record, Task};

const WINDOW: [usize; 2] = [64, 1024];
/// The windows that a record should have at least, before they overlap.
const WINDOWS: usize = 24;
const COLUMNS: usize = 400;

/// The power of a measurement in windows that overlap.
#[derive(Clone, Debug, PartialEq)]
pub struct Spectrogram {
    /// The middle of the first window \[s\].
    pub start: f64,
    /// The time between windows \[s\].
    pub step: f64,
    /// The distance between frequencies; the first one is 0 \[rad/s\].
    pub resolution: f64,
    /// The power in each window at each frequency up to the Nyquist frequency, in dB below the highest.
    pub decibels: Vec<Vec<f32>>,
}

impl Spectrogram {
    /// The spectrogram of a sensor's first `samples` measurements, before its first window. `None` if there are too few.
    ///
    /// Source: Oppenheim and Schafer (2010), *Discrete-Time Signal Processing*, section 10.3.
    pub fn windows(record: &Record, sensor: usize, samples: usize) -> Option<Windows> {
        let filled = record.measured(sensor).iter().take(samples).scan(0.0, |last, &value| {
            *last = if value.is_nan() { *last } else { value };
            Some(*last)
        });
        let values: Vec<f64> = filled.collect();
        let [shortest, longest] = WINDOW;
        let length =
            (0..).map(|i| longest >> i).take_while(|&l| l >= shortest).find(|l| l * WINDOWS <= values.len())?;
        let hop = (length / 4).max(values.len() / COLUMNS);
        let weight = |k: usize| libm::sin(PI * (k as f64 + 0.5) / length as f64).powi(2);
        Some(Windows {
            start: record.time(0),
            dt: record.dt(),
            values,
            length,
            hop,
            weights: numbers(length, &weight),
            transform: Transform::new(length),
            buffer: vec![(0.0, 0.0); length],
            power: Vec::new(),
        })
    }
}

/// The power of a measurement in the making, window by window.
#[derive(Debug)]
pub struct Windows {
    /// The first sample's time, and the time between samples \[s\].
    start: f64,
    dt: f64,
    values: Vec<f64>,
    length: usize,
    hop: usize,
    weights: Vec<f64>,
    transform: Transform,
    buffer: Vec<(f64, f64)>,
    power: Vec<Vec<f64>>,
}

impl Task for Windows {
    type Outcome = Spectrogram;

    fn progress(&self) -> f64 {
        let all = self.values.len().saturating_sub(self.length) / self.hop + 1;
        self.power.len() as f64 / all as f64
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self { values, length, hop, weights, transform, buffer, power, .. } = self;
        while let Some(window) = values.get(power.len() * *hop..power.len() * *hop + *length) {
            let mean = window.iter().sum::<f64>() / *length as f64;
            for ((slot, value), weight) in buffer.iter_mut().zip(window).zip(weights.iter()) {
                *slot = (weight * (value - mean), 0.0);
            }
            transform.apply(buffer);
            power.push(mapped(&buffer[..=*length / 2], &|(re, im)| re * re + im * im));
            if !while_time() {
                break;
            }
        }
        power.len() * *hop + *length > values.len()
    }

    fn finish(self) -> Spectrogram {
        let Self { start, dt, length, hop, power, .. } = self;
        let most = power.iter().flatten().fold(f64::MIN_POSITIVE, |most, &p| most.max(p));
        let decibels = |p: &f64| (10.0 * libm::log10((p / most).max(1e-30))) as f32;
        Spectrogram {
            start: start + 0.5 * length as f64 * dt,
            step: hop as f64 * dt,
            resolution: TAU / (length as f64 * dt),
            decibels: mapped(&power, &|column| mapped(column, &decibels)),
        }
    }
}
