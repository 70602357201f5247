//! The measurements of one sample, and the columns that they come from.

use kalmanscope_core::internals::kernel::Gaussian;
use kalmanscope_core::internals::kernel::OscillatorFilter;
use kalmanscope_core::internals::kernel::Output;
use kalmanscope_core::{Channel, Record};

use crate::lane::{LANES, Lane};
use crate::plant::Plant;

/// The most sensors with a measurement at a time.
pub(crate) const MOST: usize = 3;

/// A sensor with a measurement: where it reads, its measurement and its variance.
#[derive(Clone, Copy)]
pub(crate) struct Active<T> {
    pub(crate) output: Output,
    pub(crate) value: T,
    pub(crate) variance: T,
}

/// A number of each sample: the same for all lanes, or one a lane.
pub(crate) enum Column<'a> {
    Shared(&'a [f64]),
    Own([&'a [f64]; LANES]),
}

impl<'a> Column<'a> {
    /// From the column of each lane.
    fn new(shared: bool, of: impl Fn(usize) -> &'a [f64]) -> Self {
        if shared { Self::Shared(of(0)) } else { Self::Own(std::array::from_fn(of)) }
    }

    #[inline(always)]
    pub(crate) fn at<T: Lane>(&self, token: T::Token, k: usize) -> T {
        match self {
            Self::Shared(column) => T::splat(token, column[k]),
            Self::Own(columns) => {
                let mut numbers = [0.0; LANES];
                for lane in 0..LANES {
                    numbers[lane] = columns[lane][k];
                }
                T::from_array(token, numbers)
            }
        }
    }

    #[inline(always)]
    pub(crate) fn of_lane(&self, lane: usize, k: usize) -> f64 {
        match self {
            Self::Shared(column) => column[k],
            Self::Own(columns) => columns[lane][k],
        }
    }
}

/// The columns of a sensor.
pub(crate) struct Sensor<'a> {
    pub(crate) output: Output,
    pub(crate) measured: Column<'a>,
    /// R of each lane \[the sensor's unit squared\].
    pub(crate) variance: [f64; LANES],
}

/// One filter and its record.
#[derive(Clone, Copy)]
pub(crate) struct Run<'a, P, const N: usize> {
    pub(crate) filter: &'a OscillatorFilter<P, N>,
    pub(crate) record: &'a Record,
}

impl<P: Plant<N>, const N: usize> Run<'_, P, N> {
    /// The force over mass of each sample \[m/s²\].
    pub(crate) fn forces(self) -> Vec<f64> {
        (0..self.record.len()).map(|k| self.record.delayed_force(k, self.filter.input_delay)).collect()
    }
}

/// The inputs and measurements of a batch of runs.
pub(crate) struct Observations<'a, const N: usize> {
    /// The filter's state.
    pub(crate) channels: [Channel; N],
    pub(crate) samples: usize,
    pub(crate) force: Column<'a>,
    pub(crate) sensors: Vec<Sensor<'a>>,
    /// The truth of each channel, if it is known.
    pub(crate) truth: Option<[Column<'a>; N]>,
}

impl<'a, const N: usize> Observations<'a, N> {
    /// `forces` are those of each lane, or of all if that is one.
    pub(crate) fn new<P: Plant<N>>(runs: &[Run<'a, P, N>; LANES], forces: &'a [Vec<f64>]) -> Self {
        let channels = P::CHANNELS;
        let shared = forces.len() == 1;
        let column = |of: &dyn Fn(Run<'a, P, N>) -> &'a [f64]| Column::new(shared, |lane| of(runs[lane]));
        let outputs = runs[0].filter.outputs.iter().enumerate();
        let sensors = outputs.filter_map(|(place, output)| {
            Some(Sensor {
                output: (*output)?,
                measured: column(&|run| run.record.measured(run.filter.columns[place])),
                variance: std::array::from_fn(|lane| runs[lane].filter.noise.sensors[place]),
            })
        });
        let truth = knows_truth(runs[0].record, &channels)
            .then(|| channels.map(|channel| column(&|run| run.record.truth(channel).unwrap_or_default())));
        Self {
            channels,
            samples: runs[0].record.len(),
            force: Column::new(shared, |lane| &forces[lane]),
            sensors: sensors.collect(),
            truth,
        }
    }

    /// The error of a component of a lane's belief at sample `k`, if the truth is known: in canonical form, and with the signs
    /// of the belief.
    pub(crate) fn error(&self, lane: usize, k: usize, belief: &Gaussian<N>, place: usize) -> Option<[f64; 2]> {
        let truth = self.truth.as_ref()?[place].of_lane(lane, k);
        let sign = if belief.mean[2] < 0.0 { -1.0 } else { 1.0 };
        Some(if self.channels[place].is_mirrored() {
            let error = belief.mean[place] - sign * truth;
            [sign * error, error]
        } else {
            [belief.mean[place] - truth; 2]
        })
    }
}

/// Whether the truth of the filter's channels is known.
pub(crate) fn knows_truth(record: &Record, channels: &[Channel]) -> bool {
    channels.iter().all(|&channel| record.truth(channel).is_some())
}
