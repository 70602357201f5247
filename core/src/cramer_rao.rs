//! The floor for ±σ: how well any filter could know the state at best.

use crate::estimator::{Surroundings, build_filter, initial_belief};
use crate::filter::{Belief, Correction, Filter, Linearised, Propagation};
use crate::gaussian::Vector;
use crate::model::Model;
use crate::plant::Visitor;
use crate::{Adaptation, Channel, FilterError, FilterSettings, Quantity, Record, Scenario};

/// The posterior Cramér-Rao bound for one filter of a scenario: no unbiased filter that begins with its initial belief and
/// takes its process noise for true has smaller covariances. The sensors' noise is the true one, the plant the truth's, and
/// nothing is forgotten.
///
/// ```text
/// J⁻ₖ₊₁ = (Φₖ Jₖ⁻¹ Φₖᵀ + Q)⁻¹,  Jₖ₊₁ = J⁻ₖ₊₁ + Hₖ₊₁ᵀ R⁻¹ Hₖ₊₁
/// ```
///
/// with Φ and H along the true trajectory, which stands for the mean over all of them. The recursion runs on `J⁻¹`, by the
/// predict and update of a filter that is told the truth at every sample: the same numbers, and a parameter that is known
/// for certain does no harm. For a linear plant with known parameters it is the Kalman filter's own covariance.
///
/// Source: Tichavský, Muravchik and Nehorai (1998), Posterior Cramér-Rao bounds for discrete-time nonlinear filtering,
/// equations 21 and 34.
pub struct CramerRao {
    channels: &'static [Channel],
    recursion: Box<dyn Recursion>,
    std: Vec<f64>,
    /// The number of samples taken in, and of those forgotten since.
    samples: usize,
    forgotten: usize,
    /// Whether the recursion has met a number that is none, or lacks a sample.
    stopped: bool,
}

impl CramerRao {
    /// The bound for the filter at `place` with `dt` \[s\] between samples, before the first one. None if there is no such
    /// filter.
    pub fn new(scenario: &Scenario, place: usize, dt: f64) -> Option<Self> {
        let settings = FilterSettings {
            plant: None,
            log_parameters: false,
            propagation: Propagation::LocalLinearisation,
            adaptation: Adaptation::default(),
            fading: 1.0,
            sensor_std: scenario.true_sensor_std(),
            ..scenario.filters.get(place)?.clone()
        };
        let sensors: Vec<Quantity> = scenario.sensors.iter().map(|s| s.measures).collect();
        let plant = scenario.plant.kind;
        let surroundings = Surroundings { plant, sensors: &sensors, dt, seed: scenario.seed, place };
        let recursion = plant.visit_log(settings.eta, false, Start { settings: &settings, surroundings });
        Some(Self { channels: plant.channels(), recursion, std: Vec::new(), samples: 0, forgotten: 0, stopped: false })
    }

    /// Takes in the samples that a record of this scenario has beyond those seen so far, and forgets those that the record
    /// has forgotten. Without the truth of every channel there is no bound, and none from a sample on that the record has
    /// forgotten before it was seen here.
    pub fn follow(&mut self, record: &Record) {
        let Self { channels, recursion, std, samples, forgotten, stopped } = self;
        let gone = (record.forgotten() - *forgotten) * channels.len();
        std.drain(..gone.min(std.len()));
        *forgotten = record.forgotten();
        let truth: Option<Vec<&[f64]>> = channels.iter().map(|&c| record.truth(c)).collect();
        let Some(truth) = truth else { return };
        while *samples < *forgotten + record.len() && !*stopped {
            let at = |k: usize| -> Vec<f64> { truth.iter().map(|values| values[k]).collect() };
            *stopped = match samples.checked_sub(*forgotten) {
                Some(0) if *samples == 0 => false,
                Some(k @ 1..) => recursion.step(&at(k - 1), &at(k), record, k).is_err(),
                _ => true,
            };
            if !*stopped {
                recursion.append_std(std);
                *samples += 1;
            }
        }
    }

    /// The channels of the bound: all of the truth's.
    pub fn channels(&self) -> &[Channel] {
        self.channels
    }

    /// The place of a channel, if the truth has it.
    pub fn place(&self, channel: Channel) -> Option<usize> {
        self.channels.iter().position(|&c| c == channel)
    }

    /// The number of samples with a bound that are kept.
    pub fn len(&self) -> usize {
        self.std.len() / self.channels.len()
    }

    /// Whether there is no bound yet.
    pub fn is_empty(&self) -> bool {
        self.std.is_empty()
    }

    /// The least standard deviation of a channel at sample `k` of those that the record keeps, in the channel's unit.
    pub fn std(&self, k: usize, place: usize) -> f64 {
        self.std[k * self.channels.len() + place]
    }
}

/// The recursion with its size erased.
trait Recursion: Send {
    /// From one sample to the next, with the true states there.
    fn step(&mut self, before: &[f64], after: &[f64], record: &Record, k: usize) -> Result<(), FilterError>;

    fn append_std(&self, std: &mut Vec<f64>);
}

struct Start<'a> {
    settings: &'a FilterSettings,
    surroundings: Surroundings<'a>,
}

impl Visitor for Start<'_> {
    type Output = Box<dyn Recursion>;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Box<dyn Recursion> {
        let Self { settings, surroundings } = self;
        let belief = Linearised::new(initial_belief(&model, settings), settings.propagation, 1);
        let sensors = surroundings.sensors.to_vec();
        Box::new(Told { filter: build_filter(model, belief, settings, &surroundings), sensors })
    }
}

/// A filter that is told the truth.
struct Told<P, const N: usize> {
    filter: Filter<P, Linearised<N>, N>,
    sensors: Vec<Quantity>,
}

impl<P: Model<N>, const N: usize> Recursion for Told<P, N> {
    fn step(&mut self, before: &[f64], after: &[f64], record: &Record, k: usize) -> Result<(), FilterError> {
        let Self { filter, sensors } = self;
        filter.belief_mut().move_to(Vector::from_column_slice(before));
        filter.predict(record.force()[k - 1])?;
        filter.belief_mut().move_to(Vector::from_column_slice(after));
        filter.update(record.force()[k], &record.sample(k, sensors), &mut Correction::NOTHING.clone())
    }

    fn append_std(&self, std: &mut Vec<f64>) {
        let belief = Belief::<P, N>::gaussian(self.filter.belief());
        std.extend(belief.cov.diagonal().iter().map(|variance| variance.sqrt()));
    }
}
