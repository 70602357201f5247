//! The power spectral density of a force, and the power of a measurement over time and frequency.

use std::f64::consts::{PI, TAU};

use kalmanscope_filters::fourier::Transform;
use kalmanscope_filters::lists::{mapped, numbers};
use kalmanscope_records::task::pause;
use kalmanscope_records::{Record, Work};

type Complex = nalgebra::Complex<f64>;

/// The number of cycles in a window, unless the longest window is shorter.
const CYCLES: f64 = 8.0;
const FEWEST: usize = 4;
/// The number of frequencies that share a window.
const LANES: usize = 8;

/// The one-sided power spectral density of a series at some frequencies, from running sums.
///
/// ```text
/// S(ω) = Δt/(πn) · Σ |Σₖ wₖ fₖ exp(-iωkΔt)|²,  ∫ S dω = mean of fₖ²
/// ```
///
/// over half-sine windows that overlap by half; in the series' unit squared per rad/s. White noise has `S = s² Δt / π`.
///
/// A window is eight cycles long, but at most `longest`; the first one peaks at the first sample. Portions change no bit.
///
/// Source: Welch (1967), The use of fast Fourier transform for the estimation of power spectra; Harris (1978), On the use of
/// windows for harmonic analysis with the discrete Fourier transform, section V.C; Brown (1991), Calculation of a constant Q
/// spectral transform.
#[derive(Clone, Debug)]
pub struct Spectrum {
    /// The frequencies \[rad/s\].
    pub frequencies: Vec<f64>,
    dt: f64,
    samples: usize,
    groups: Vec<Group>,
}

impl Spectrum {
    /// An empty spectrum at ascending `frequencies` \[rad/s\], with `dt` \[s\] between samples, windows of at most `longest` \[s\].
    pub fn new(frequencies: Vec<f64>, dt: f64, longest: f64) -> Self {
        let groups = frequencies.chunks(LANES).map(|chunk| Group::new(chunk, dt, longest)).collect();
        Self { frequencies, dt, samples: 0, groups }
    }

    /// Takes in the next samples.
    pub fn extend(&mut self, samples: &[f64]) {
        for group in &mut self.groups {
            group.extend(samples, self.dt);
        }
        self.samples += samples.len();
    }

    /// The density at every frequency, zero before the first sample; in the samples' unit squared per rad/s.
    pub fn density(&self) -> Vec<f64> {
        let scale = self.dt / (PI * self.samples.max(1) as f64);
        let sums: Vec<f64> = self.groups.iter().flat_map(Group::sums).collect();
        mapped(&sums[..self.frequencies.len()], &|sum| sum * scale)
    }
}

/// Frequencies that share their windows. Each window has a rising and a falling half; while one falls, the next rises.
#[derive(Clone, Debug)]
struct Group {
    frequencies: [f64; LANES],
    turn: [Complex; LANES],
    half: usize,
    halves: usize,
    samples: usize,
    phase: [Complex; LANES],
    /// Cosine and sine of an angle from 0 to π/2 within a half, the falling and rising weights; and of its step.
    window: Complex,
    window_turn: Complex,
    rising: [Complex; LANES],
    falling: [Complex; LANES],
    risen: [Complex; LANES],
    squares: [f64; LANES],
}

fn phasor(angle: f64) -> Complex {
    let (sin, cos) = libm::sincos(angle);
    Complex::new(cos, sin)
}

fn squares(one: &[Complex; LANES], other: &[Complex; LANES]) -> [f64; LANES] {
    std::array::from_fn(|i| (one[i] + other[i]).norm_sqr())
}

/// Samples stand in the middle of their intervals of the window.
fn start_of_half(half: usize) -> Complex {
    phasor(0.25 * PI / half as f64)
}

impl Group {
    fn new(chunk: &[f64], dt: f64, longest: f64) -> Self {
        // The last group may have too few frequencies and repeats one; the result leaves out the repetitions.
        let frequencies = std::array::from_fn(|i| chunk[i.min(chunk.len() - 1)]);
        let length = (CYCLES * TAU / chunk[chunk.len() / 2]).min(longest);
        let half = (libm::round(0.5 * length / dt) as usize).max(FEWEST);
        let nothing = [Complex::ZERO; LANES];
        Self {
            frequencies,
            turn: frequencies.map(|w| phasor(w * dt)),
            half,
            halves: 0,
            samples: 0,
            phase: [Complex::ONE; LANES],
            window: start_of_half(half),
            window_turn: phasor(0.5 * PI / half as f64),
            rising: nothing,
            falling: nothing,
            risen: nothing,
            squares: [0.0; LANES],
        }
    }

    fn extend(&mut self, mut samples: &[f64], dt: f64) {
        while !samples.is_empty() {
            let (now, later) = samples.split_at(samples.len().min(self.half - self.samples));
            self.extend_half(now);
            if self.samples == self.half {
                self.finish_half(dt);
            }
            samples = later;
        }
    }

    fn extend_half(&mut self, samples: &[f64]) {
        let Self { turn, phase, window, window_turn, rising, falling, .. } = self;
        for &sample in samples {
            let Complex { re: falls, im: rises } = *window * sample;
            for i in 0..LANES {
                falling[i] += phase[i] * falls;
                rising[i] += phase[i] * rises;
                phase[i] *= turn[i];
            }
            *window *= *window_turn;
        }
        self.samples += samples.len();
    }

    /// Ends a half. Phases are computed from the time again, so that rounding does not accumulate.
    fn finish_half(&mut self, dt: f64) {
        let ended = squares(&self.risen, &self.falling);
        self.squares.iter_mut().zip(ended).for_each(|(sum, square)| *sum += square);
        self.risen = std::mem::take(&mut self.rising);
        self.falling = [Complex::ZERO; LANES];
        self.samples = 0;
        self.window = start_of_half(self.half);
        self.halves += 1;
        let time = (self.halves * self.half) as f64 * dt;
        self.phase = self.frequencies.map(|w| phasor(w * time));
    }

    fn sums(&self) -> [f64; LANES] {
        let (falling, rising) = (squares(&self.risen, &self.falling), squares(&self.rising, &Default::default()));
        std::array::from_fn(|i| self.squares[i] + falling[i] + rising[i])
    }
}

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
