//! The power of a measurement over time and frequency.

use std::f64::consts::{PI, TAU};

use kalmanscope_filters::fourier::Transform;
use kalmanscope_filters::lists::{mapped, numbers};
use kalmanscope_records::task::pause;
use kalmanscope_records::{Record, Work};

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
    /// The spectrogram of a sensor's first `samples` measurements, window by window. `None` if there are too few.
    ///
    /// Source: Oppenheim and Schafer (2010), *Discrete-Time Signal Processing*, section 10.3.
    pub fn windows(record: &Record, sensor: usize, samples: usize) -> Option<Work<Self>> {
        let filled = record.measured(sensor).iter().take(samples).scan(0.0, |last, &value| {
            *last = if value.is_nan() { *last } else { value };
            Some(*last)
        });
        let values: Vec<f64> = filled.collect();
        let [shortest, longest] = WINDOW;
        let length =
            (0..).map(|i| longest >> i).take_while(|&l| l >= shortest).find(|l| l * WINDOWS <= values.len())?;
        let (start, dt) = (record.time(0), record.dt());
        Some(Work::new(move |progress| async move {
            let hop = (length / 4).max(values.len() / COLUMNS);
            let weight = |k: usize| libm::sin(PI * (k as f64 + 0.5) / length as f64).powi(2);
            let (weights, transform) = (numbers(length, &weight), Transform::new(length));
            let (mut buffer, mut power) = (vec![(0.0, 0.0); length], Vec::<Vec<f64>>::new());
            let windows = values.windows(length).step_by(hop);
            let all = windows.len() as f64;
            for window in windows {
                if !power.is_empty() {
                    progress.set(power.len() as f64 / all);
                    pause().await;
                }
                let mean = window.iter().sum::<f64>() / length as f64;
                for ((slot, value), weight) in buffer.iter_mut().zip(window).zip(&weights) {
                    *slot = (weight * (value - mean), 0.0);
                }
                transform.apply(&mut buffer);
                power.push(mapped(&buffer[..=length / 2], &|(re, im)| re * re + im * im));
            }
            let most = power.iter().flatten().fold(f64::MIN_POSITIVE, |most, &p| most.max(p));
            let decibels = |p: &f64| (10.0 * libm::log10((p / most).max(1e-30))) as f32;
            Self {
                start: start + 0.5 * length as f64 * dt,
                step: hop as f64 * dt,
                resolution: TAU / (length as f64 * dt),
                decibels: mapped(&power, &|column| mapped(column, &decibels)),
            }
        }))
    }
}
