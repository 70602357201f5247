//! The structures of `shader/layout.wgsl` as words of 32 bits.

/// The numbers of a dispatch.
#[derive(Clone, Copy)]
pub(crate) struct Settings {
    pub(crate) begin: u32,
    pub(crate) end: u32,
    pub(crate) runs: u32,
    pub(crate) recent: u32,
    pub(crate) knows_truth: bool,
    pub(crate) dt: f64,
}

impl Settings {
    pub(crate) fn words(self) -> [u32; 8] {
        let Self { begin, end, runs, recent, knows_truth, dt } = self;
        [begin, end, runs, recent, u32::from(knows_truth), bits(dt), 0, 0]
    }
}

/// A sample of a record.
#[derive(Clone, Copy)]
pub(crate) struct Sample {
    pub(crate) truth: [f64; 4],
    /// Displacement, velocity, acceleration; NaN where there is none.
    pub(crate) measured: [f64; 3],
    pub(crate) force: f64,
}

impl Sample {
    /// The number of words.
    pub(crate) const WORDS: usize = 12;

    pub(crate) fn words(self) -> [u32; Self::WORDS] {
        let Self { truth: [x, v, wn, zeta], measured, force } = self;
        let mut present = 0;
        for (place, number) in measured.iter().enumerate() {
            present |= u32::from(!number.is_nan()) << place;
        }
        let [a, b, c] = measured.map(|number| if number.is_nan() { 0.0 } else { number });
        let [x, v, wn, zeta, a, b, c, force] = [x, v, wn, zeta, a, b, c, force].map(bits);
        [x, v, wn, zeta, a, b, c, force, present, 0, 0, 0]
    }
}

/// A filter before its first sample.
#[derive(Clone, Copy)]
pub(crate) struct Cell {
    pub(crate) mean: [f64; 4],
    pub(crate) initial_std: [f64; 4],
    /// The root of Q's diagonal.
    pub(crate) process: [f64; 4],
    /// R of displacement, velocity, acceleration.
    pub(crate) noise: [f64; 3],
    /// The root of the fading factor.
    pub(crate) fading: f64,
    /// The place of its record's first sample.
    pub(crate) first: u32,
}

impl Cell {
    /// The number of words.
    pub(crate) const WORDS: usize = 20;

    pub(crate) fn words(self) -> [u32; Self::WORDS] {
        let Self { mean, initial_std, process, noise, fading, first } = self;
        let mut words = [0; Self::WORDS];
        let numbers = mean.into_iter().chain(initial_std).chain(process).chain(noise).chain([fading]);
        for (word, number) in words.iter_mut().zip(numbers) {
            *word = bits(number);
        }
        words[16] = first;
        words
    }
}

/// A filter with its sums.
#[derive(Clone, Copy, Debug)]
pub(crate) struct State {
    pub(crate) mean: [f64; 4],
    pub(crate) variance: [f64; 4],
    pub(crate) squares: [f64; 4],
    pub(crate) recent: [f64; 4],
    pub(crate) inside: [u32; 4],
    pub(crate) settled: [u32; 4],
    pub(crate) nis: f64,
    pub(crate) nees: f64,
    pub(crate) ln_determinants: f64,
    pub(crate) nees_degrees: u32,
    pub(crate) nees_samples: u32,
    /// The sample at which the filter stopped, 0 if it has not, and why.
    pub(crate) stopped: u32,
    pub(crate) reason: u32,
}

impl State {
    /// The number of words.
    pub(crate) const WORDS: usize = 56;

    /// From as many words.
    pub(crate) fn read(words: &[u32]) -> Self {
        let number = |at: usize| f64::from(f32::from_bits(words[at]));
        let numbers = |at: usize| [0, 1, 2, 3].map(|i| number(at + i));
        // The sum of a number in two parts.
        let both = |at: usize, other: usize| [0, 1, 2, 3].map(|i| number(at + i) + number(other + i));
        let counts = |at: usize| [0, 1, 2, 3].map(|i| words[at + i]);
        let square = |row: &[usize]| row.iter().map(|&at| number(at) * number(at)).sum::<f64>();
        let sums = numbers(44);
        Self {
            mean: both(0, 4),
            // The rows of L.
            variance: [square(&[8]), square(&[9, 12]), square(&[10, 13, 15]), square(&[11, 14, 16, 17])],
            squares: both(20, 24),
            recent: both(28, 32),
            inside: counts(36),
            settled: counts(40),
            nis: sums[0] + sums[2],
            nees: sums[1] + sums[3],
            ln_determinants: number(48).ln() + f64::from(words[49].cast_signed()) * std::f64::consts::LN_2,
            nees_degrees: words[50],
            nees_samples: words[51],
            stopped: words[52],
            reason: words[53],
        }
    }
}

fn bits(number: f64) -> u32 {
    (number as f32).to_bits()
}
