//! The Cramér-Rao bound: the smallest standard deviations that any filter can reach.

use std::ops::Range;

use crate::mathematics::filter;
use crate::mathematics::kernel::gaussian::Vector;
use crate::mathematics::kernel::model::Model;
use crate::mathematics::kernel::plant::Visitor;
use crate::mathematics::kernel::{Belief, Correction, Filter, Linearised};
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::kernel::{build_filter, initial_belief, with_model};
use crate::samples::waste::Piecewise;
use crate::{Channel, FilterError, FilterKind, FilterSettings, Quantity, Record, Scenario};

/// The posterior Cramér-Rao bound for one filter of a scenario. No unbiased filter with the same initial belief and
/// process noise has smaller covariances. The bound uses the truth's plant, the true noise of the sensors (with the
/// disturbance that an accelerometer feels) and no fading. It takes an augmentation of the truth that the filter lacks
/// as known.
///
/// ```text
/// J⁻ₖ₊₁ = (Φₖ Jₖ⁻¹ Φₖᵀ + Q)⁻¹,  Jₖ₊₁ = J⁻ₖ₊₁ + Hₖ₊₁ᵀ R⁻¹ Hₖ₊₁
/// ```
///
/// with Φ and H along the true trajectory, in place of the mean over all trajectories. The recursion is that of `J⁻¹`,
/// computed by the predict and update of a filter with its mean set to the truth at every sample. This is algebraically
/// the same, and it allows parameters of variance zero. For a linear plant with known parameters the bound is the
/// Kalman filter's own covariance.
///
/// Source: Tichavský, Muravchik and Nehorai (1998), Posterior Cramér-Rao bounds for discrete-time nonlinear filtering,
/// equations 21 and 34.
pub struct CramerRao {
    settings: FilterSettings,
    channels: Vec<Channel>,
    recursion: Box<dyn Recursion>,
    std: Vec<f64>,
    /// The number of samples that the record had forgotten at the last call.
    forgotten: usize,
    /// Whether the recursion has failed or lacks a sample.
    stopped: bool,
}

impl CramerRao {
    /// The bound for the filter at `place` before the first sample, with `dt` \[s\] between samples. `None` if there is
    /// no such filter.
    pub fn new(scenario: &Scenario, place: usize, dt: f64) -> Option<Self> {
        let settings = bound_settings(scenario, place)?;
        let sensors: Vec<Quantity> = scenario.sensors.iter().map(|s| s.measures).collect();
        let plant = scenario.plant.kind;
        let (input, hold) = (scenario.input, scenario.hold);
        let seed = scenario.seed;
        let context =
            FilterContext { plant, input, hold, sensors: &sensors, dt, seed, stream: 0, is_timed: false, start: 0.0 };
        let channels = context.model(&settings).channels().to_vec();
        let recursion = with_model(&settings, &context, Start { settings: &settings, context })
            .unwrap_or_else(|| Box::new(DynamicBoundFilter::new(&settings, &context)));
        Some(Self { settings, channels, recursion, std: Vec::new(), forgotten: 0, stopped: false })
    }

    /// Reuses the memory of an old bound, before the first sample.
    pub fn recycle(&mut self, old: Self) {
        if self.std.is_empty() {
            self.std = old.std;
            self.std.clear();
        }
    }

    /// Whether this bound also applies to the filter at `place`: the initial belief and the process noise are equal.
    /// The rest of the scenario must be the same.
    pub fn is_for(&self, scenario: &Scenario, place: usize) -> bool {
        bound_settings(scenario, place).is_some_and(|settings| settings == self.settings)
    }

    /// Takes in the new samples of a record of this scenario, and forgets those that the record has forgotten. There is
    /// no bound without the truth of every channel, nor after a sample that the record forgot before it was taken in
    /// here.
    pub fn follow(&mut self, record: &Record) {
        self.follow_to(record.len(), record);
    }

    /// [`Self::follow`] up to sample `end` of those that are kept. Returns whether everything before it is done.
    pub fn follow_to(&mut self, end: usize, record: &Record) -> bool {
        let Self { settings: _, channels, recursion, std, forgotten, stopped } = self;
        let gone = (record.forgotten() - *forgotten) * channels.len();
        std.drain(..gone.min(std.len()));
        *forgotten = record.forgotten();
        let of = |&channel: &Channel| match record.truth(channel) {
            // Without an augmentation, the truth has the usual value.
            None if channel.is_augmentation() => Some(TrueValue::Constant(channel.usual_truth())),
            truth => truth.map(TrueValue::Varying),
        };
        let truth: Option<Vec<TrueValue<'_>>> = channels.iter().map(of).collect();
        let Some(truth) = truth.filter(|_| !*stopped) else { return true };
        // The recursion needs the sample before the first new one, except at the beginning.
        let seen = std.len() / channels.len();
        *stopped = (seen == 0 && *forgotten > 0) || recursion.follow(&truth, record, seen..end, std).is_err();
        *stopped || std.len() / channels.len() >= record.len()
    }

    /// The channels of the bound: those of the truth, then the other augmentations that the filter estimates.
    pub fn channels(&self) -> &[Channel] {
        &self.channels
    }

    /// The place of a channel, if the bound has it.
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

    /// The bound on a channel's standard deviation at sample `k` of those that the record keeps, in the channel's unit.
    pub fn std(&self, k: usize, place: usize) -> f64 {
        self.std[k * self.channels.len() + place]
    }
}

/// The settings of the bound's filter: the initial belief and process noise of the filter at `place`, the truth
/// otherwise.
fn bound_settings(scenario: &Scenario, place: usize) -> Option<FilterSettings> {
    let FilterSettings { kind, augment, mut initial_std, mut process_std, initial_mean, eta, .. } =
        scenario.filters.get(place)?.clone();
    let of_truth: Vec<Channel> = scenario.plant.parameters().filter(|channel| channel.is_augmentation()).collect();
    for &known in of_truth.iter().filter(|channel| !augment.contains(channel)) {
        initial_std[known] = 0.0;
        process_std[known] = 0.0;
    }
    let besides = augment.iter().copied().filter(|channel| !of_truth.contains(channel));
    Some(FilterSettings {
        name: String::new(),
        kind: if kind == FilterKind::KF { kind } else { FilterKind::EKF },
        augment: of_truth.iter().copied().chain(besides).collect(),
        initial_mean,
        initial_std,
        process_std,
        eta,
        sensor_std: scenario.true_noise_for(scenario.filters.get(place)?).0,
        ..FilterSettings::default()
    })
}

/// The true values of a channel.
#[derive(Clone, Copy)]
enum TrueValue<'a> {
    Constant(f64),
    Varying(&'a [f64]),
}

impl TrueValue<'_> {
    fn at(self, k: usize) -> f64 {
        match self {
            Self::Constant(value) => value,
            Self::Varying(values) => values[k],
        }
    }
}

/// The recursion, with its size erased.
trait Recursion: Send {
    /// Runs over samples of a record and appends the standard deviations of every channel. `truth` has the true values
    /// of every channel.
    fn follow(
        &mut self,
        truth: &[TrueValue<'_>],
        record: &Record,
        samples: Range<usize>,
        std: &mut Vec<f64>,
    ) -> Result<(), FilterError>;
}

struct Start<'a> {
    settings: &'a FilterSettings,
    context: FilterContext<'a>,
}

impl Visitor for Start<'_> {
    type Output = Box<dyn Recursion>;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Box<dyn Recursion> {
        let Self { settings, context } = self;
        let belief = Linearised::new(initial_belief::<P, N>(settings), 1);
        let sensors = context.sensors.to_vec();
        Box::new(BoundFilter { filter: build_filter(model, belief, settings, &context), sensors })
    }
}

/// A tuned filter with its mean set to the truth at every sample.
struct BoundFilter<P, const N: usize> {
    filter: Filter<P, Linearised<N>, N>,
    sensors: Vec<Quantity>,
}

impl<P: Model<N>, const N: usize> Recursion for BoundFilter<P, N> {
    fn follow(
        &mut self,
        truth: &[TrueValue<'_>],
        record: &Record,
        samples: Range<usize>,
        std: &mut Vec<f64>,
    ) -> Result<(), FilterError> {
        let Self { filter, sensors } = self;
        let truth = |k: usize| Vector::<N>::from_fn(|channel, _| truth[channel].at(k));
        let measured: Vec<Option<&[f64]>> = sensors.iter().map(|&q| record.measured_quantity(q)).collect();
        let mut sample = vec![f64::NAN; measured.len()];
        let mut correction = Correction::NOTHING.clone();
        for k in samples.start..samples.end.min(record.len()) {
            if let Some(before) = k.checked_sub(1) {
                filter.belief_mut().move_to(truth(before));
                filter.predict(record.force(before))?;
                filter.belief_mut().move_to(truth(k));
                for (value, column) in sample.iter_mut().zip(&measured) {
                    *value = column.map_or(f64::NAN, |column| column[k]);
                }
                filter.update(record.force(k), &sample, &mut correction)?;
            }
            let belief = Belief::<P, N>::gaussian(filter.belief());
            std.extend(belief.cov.diagonal().iter().map(|variance| variance.sqrt()));
        }
        Ok(())
    }
}

/// A filter of any model with its mean set to the truth at every sample.
struct DynamicBoundFilter {
    filter: filter::Filter<filter::Moments>,
    sensors: Vec<Quantity>,
}

impl DynamicBoundFilter {
    fn new(settings: &FilterSettings, context: &FilterContext<'_>) -> Self {
        let initial = crate::samples::estimator::book::initial_gaussian(&context.model(settings), settings);
        let belief = Box::new(filter::Moments::linearised(initial, context.propagation(settings), 1));
        let filter = crate::samples::estimator::book::build_filter(belief, settings, context);
        Self { filter, sensors: context.sensors.to_vec() }
    }
}

impl Recursion for DynamicBoundFilter {
    fn follow(
        &mut self,
        truth: &[TrueValue<'_>],
        record: &Record,
        samples: Range<usize>,
        std: &mut Vec<f64>,
    ) -> Result<(), FilterError> {
        let Self { filter, sensors } = self;
        let truth =
            |k: usize| crate::mathematics::linalg::Vector::from_fn(truth.len(), |channel, _| truth[channel].at(k));
        let mut correction = filter::Correction::default();
        for k in samples {
            if let Some(before) = k.checked_sub(1) {
                filter.belief_mut().move_to(truth(before));
                filter.predict([record.force(before), record.force(k)])?;
                filter.belief_mut().move_to(truth(k));
                filter.update(
                    record.force(k),
                    &record.sample(k, sensors, &crate::record::Delays::default()),
                    &mut correction,
                )?;
            }
            let belief = filter::Belief::gaussian(filter.belief());
            std.extend(belief.cov.diagonal().iter().map(|variance| variance.sqrt()));
        }
        Ok(())
    }
}

impl Piecewise for CramerRao {
    fn free_piece(&mut self) -> bool {
        false
    }
}
