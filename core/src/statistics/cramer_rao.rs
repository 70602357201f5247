//! The Cramér-Rao bound: the smallest standard deviations that any filter can reach.

use kalmanscope_filters::engine::level::Baseline;
use kalmanscope_filters::engine::wrapper::Span;
use kalmanscope_filters::lists::mapped;
use kalmanscope_filters::{Channel, FilterKind, Quantity};
use kalmanscope_records::Record;
use kalmanscope_records::record::Parts;

use crate::run::estimator::FilterContext;
use crate::run::estimator::setup::{PlantFilter, Setup, filter};
use crate::run::forces::{Forces, PartInputs};
use crate::run::waste::Piecewise;
use crate::scenario::Fault;
use crate::{FilterSettings, Scenario, Sensor};

/// The posterior Cramér-Rao bound for one filter: no unbiased filter with its initial belief and process noise has smaller covariances.
///
/// ```text
/// J⁻ₖ₊₁ = (Φₖ Jₖ⁻¹ Φₖᵀ + Q)⁻¹,  Jₖ₊₁ = J⁻ₖ₊₁ + Hₖ₊₁ᵀ R⁻¹ Hₖ₊₁
/// ```
///
/// with Φ and H along the true trajectory, by a filter of `J⁻¹` with its mean set to the truth: so variances can be zero.
///
/// Source: Tichavský, Muravchik and Nehorai (1998), Posterior Cramér-Rao bounds for discrete-time nonlinear filtering,
/// equations 21 and 34.
pub struct CramerRao {
    settings: FilterSettings,
    /// Those of the truth, then the other augmentations that the filter estimates.
    channels: Vec<Channel>,
    /// Its mean is set to the truth at every sample. With the quantity of each of its sensors; `None` if it cannot begin.
    recursion: Option<(PlantFilter<f64>, Vec<Quantity>)>,
    std: Vec<f64>,
    forgotten: usize,
    stopped: bool,
}

impl CramerRao {
    /// The bound for the filter at `place`, if there is one, before the first sample, with `dt` \[s\] between samples.
    pub fn new(scenario: &Scenario, place: usize, dt: f64) -> Option<Self> {
        Some(Self::with(bound_settings(scenario, place)?, scenario, dt))
    }

    /// The same with the filter's fading factor, `λ Φₖ Jₖ⁻¹ Φₖᵀ + Q`: where λ > 1 no bound, but the σ that the filter says.
    pub fn with_fading(scenario: &Scenario, place: usize, dt: f64) -> Option<Self> {
        let settings = bound_settings(scenario, place)?;
        let fading = scenario.filters[place].fading;
        Some(Self::with(FilterSettings { fading, ..settings }, scenario, dt))
    }

    fn with(settings: FilterSettings, scenario: &Scenario, dt: f64) -> Self {
        let context = FilterContext::new(scenario, dt, &settings);
        let sensors = &context.sensors;
        let channels = context.model(&settings).channels().to_vec();
        let recursion = Setup::of(&settings, &context, (0..sensors.len()).collect()).map(|setup| {
            let sensors = mapped(&setup.columns, &|&place| sensors[place]);
            (filter(&|_| &setup), sensors)
        });
        Self { settings, channels, recursion, std: Vec::new(), forgotten: 0, stopped: false }
    }

    /// Reuses the memory of an old bound, before the first sample.
    pub fn recycle(&mut self, old: Self) {
        if self.std.is_empty() {
            self.std = old.std;
            self.std.clear();
        }
    }

    /// Whether this bound also applies to the filter at `place`, as the rest of the scenario is the same.
    pub fn is_for(&self, scenario: &Scenario, place: usize) -> bool {
        bound_settings(scenario, place).is_some_and(|settings| settings == self.settings)
    }

    /// Takes in the samples up to `end` of those that are kept. No bound without the truth. Returns whether all before `end` is done.
    pub fn follow_to(&mut self, end: usize, record: &Record) -> bool {
        let Self { settings, channels, recursion, std, forgotten, stopped } = self;
        let gone = (record.forgotten() - *forgotten) * channels.len();
        std.drain(..gone.min(std.len()));
        *forgotten = record.forgotten();
        let of = |&channel: &Channel| match record.truth(channel) {
            // Without an augmentation, the truth has the usual value.
            None if channel.is_augmentation() => Some(Err(channel.usual_truth())),
            truth => truth.map(Ok),
        };
        let truth: Option<Vec<Result<&[f64], f64>>> = channels.iter().map(of).collect();
        let Some(truth) = truth.filter(|_| !*stopped) else { return true };
        let seen = std.len() / channels.len();
        let Some((filter, sensors)) = recursion.as_mut().filter(|_| seen > 0 || *forgotten == 0) else {
            *stopped = true;
            return true;
        };
        let measured: Vec<Option<&[f64]>> = mapped(sensors, &|&quantity| record.measured_quantity(quantity));
        let mut sample = vec![f64::NAN; measured.len()];
        let move_to = |mean: &mut [f64], k: usize| {
            mean.iter_mut()
                .zip(&truth)
                .for_each(|(mean, truth)| *mean = truth.map_or_else(|usual| usual, |all| all[k]));
        };
        let columns: Option<Vec<usize>> = sensors.iter().map(|quantity| quantity.place_in(record.sensors())).collect();
        let (delays, mut parts) = (settings.delays(record.dt()), Parts::default());
        let force = |k: usize| record.delayed_force(k, delays.input);
        let (n, mut forces) = (channels.len(), Forces::of(channels, record.forced(), record.hold()));
        for k in seen..end.min(record.len()) {
            if let Some(before) = k.checked_sub(1) {
                move_to(&mut filter.belief.mean, before);
                let has_parts =
                    columns.as_ref().is_some_and(|columns| record.parts_to(k, &delays, columns, &mut parts));
                forces.take(record, k, delays.input);
                let mut holds = true;
                for PartInputs { share, ends, now, readings } in forces.through(&parts).filter(|_| has_parts) {
                    filter.predict(Baseline, Span { share, inputs: ends, times: [0.0; 2] });
                    let truth = filter.belief.mean.clone();
                    holds &= filter.update(Baseline, now, readings).holds;
                    filter.belief.mean = truth;
                }
                if !has_parts {
                    let inputs = forces.over([force(before), force(k)]);
                    filter.predict(Baseline, Span { share: 1.0, inputs, times: [0.0; 2] });
                    move_to(&mut filter.belief.mean, k);
                    for (value, column) in sample.iter_mut().zip(&measured) {
                        *value = column.map_or(f64::NAN, |column| column[k]);
                    }
                    holds = filter.update(Baseline, forces.now(force(k)), &sample).holds;
                }
                if !holds {
                    *stopped = true;
                    return true;
                }
            }
            std.extend((0..n).map(|i| filter.belief.cov[i * (n + 1)].sqrt()));
        }
        std.len() / n >= record.len()
    }

    /// The place of a channel, if the bound has it.
    pub fn place(&self, channel: Channel) -> Option<usize> {
        channel.place_in(&self.channels)
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

fn bound_settings(scenario: &Scenario, place: usize) -> Option<FilterSettings> {
    let FilterSettings { kind, augment, mut initial_std, mut process_std, initial_mean, eta, .. } =
        scenario.filters.get(place)?.clone();
    let of_truth: Vec<Channel> = scenario.plant.parameters().filter(|channel| channel.is_augmentation()).collect();
    for &known in of_truth.iter().filter(|channel| !augment.contains(channel)) {
        initial_std[known] = 0.0;
        process_std[known] = 0.0;
    }
    let besides = augment.iter().copied().filter(|channel| !of_truth.contains(channel));
    // A late reading is that of a whole number of samples before.
    let whole = |late: f64| libm::round(late / scenario.dt) * scenario.dt;
    let late = |sensor: &Sensor| sensor.faults.numbers(Fault::LATE).map_or(0.0, |numbers| whole(numbers[0]));
    Some(FilterSettings {
        input_delay: scenario.plant.input_delay,
        sensor_delay: mapped(&scenario.sensors, &late),
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

impl Piecewise for CramerRao {}
