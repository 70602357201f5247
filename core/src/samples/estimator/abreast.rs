//! The tuned filter of an oscillator as plain numbers, and a single step of it. Programs that run many filters side by
//! side call it for the steps that they cannot do.

use crate::mathematics::filter::{Adaptation, Rule};
use crate::mathematics::kernel::gaussian::Gaussian;
use crate::mathematics::kernel::model::{Model, Output};
use crate::mathematics::kernel::plant::duffing::Duffing;
use crate::mathematics::kernel::plant::sdof::Sdof;
use crate::mathematics::kernel::{Belief, Correction, Filter, Linearised, Noise, SigmaPoints};
use crate::samples::estimator::FilterContext;
use crate::samples::estimator::kernel::{initial_belief, noise, readings, serves};
use crate::samples::run_error::sensor_places;
use crate::{FilterError, FilterKind, PlantKind, Quantity, Record, RunError, Scenario};

/// The method by which a filter predicts and updates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// KF and EKF.
    Linearised,
    /// UKF.
    SigmaPoints,
}

/// The plants that have such a filter: oscillators with the state `[x, v, parameters]` of N components.
pub trait Oscillator<const N: usize>: Model<N> {
    /// The plant.
    const PLANT: PlantKind;

    /// The model; its parameters decay at the rate `eta` \[1/s\].
    fn with_decay(eta: f64) -> Self;

    /// [`OscillatorFilter::step`]. Each plant implements it here, so that the filter is compiled once: another crate's
    /// call of a generic function would compile it again.
    ///
    /// # Errors
    /// Those of [`Filter::predict`] and [`Filter::update`].
    fn step(
        filter: &OscillatorFilter<Self, N>,
        belief: &mut Gaussian<N>,
        forces: [f64; 2],
        measured: &[f64],
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError>;
}

macro_rules! oscillator {
    ($plant:ident, $size:literal, $kind:expr) => {
        impl Oscillator<$size> for $plant {
            const PLANT: PlantKind = $kind;

            fn with_decay(eta: f64) -> Self {
                Self { eta }
            }

            fn step(
                filter: &OscillatorFilter<Self, $size>,
                belief: &mut Gaussian<$size>,
                forces: [f64; 2],
                measured: &[f64],
                correction: &mut Correction<$size>,
            ) -> Result<(), FilterError> {
                step(filter, belief, forces, measured, correction)
            }
        }
    };
}

oscillator!(Sdof, 4, PlantKind::SDOF);
oscillator!(Duffing, 5, PlantKind::DUFFING);

/// A filter of an oscillator, by default the linear one, before its first sample.
#[derive(Clone, Debug)]
pub struct OscillatorFilter<P = Sdof, const N: usize = 4> {
    /// The plant, with η \[1/s\].
    pub plant: P,
    /// The method of the filter.
    pub method: Method,
    /// The initial belief.
    pub initial: Gaussian<N>,
    /// Q, R and fading.
    pub noise: Noise<N>,
    /// Time between samples \[s\].
    pub dt: f64,
    /// The reading of each sensor, if the model knows it.
    pub outputs: Vec<Option<Output>>,
    /// The record's column for each sensor.
    pub columns: Vec<usize>,
    /// The number of samples after which the plant feels the input.
    pub input_delay: i32,
}

impl<P: Oscillator<N>, const N: usize> OscillatorFilter<P, N> {
    /// The filter at `place` of a scenario, if it is one of the kernels' KF, EKF or UKF of this plant that adapts nothing,
    /// does not jump, has one guess, propagates by local linearisation and can begin.
    ///
    /// # Errors
    /// Those of [`Pass::new`](crate::Pass::new), except for filters of other plants, which give `None`.
    pub fn new(scenario: &Scenario, place: usize, record: &Record) -> Result<Option<Self>, RunError> {
        let settings = scenario.filters.get(place).ok_or(RunError::NoFilter(place))?;
        if settings.plant.unwrap_or(scenario.plant.kind) != P::PLANT {
            return Ok(None);
        }
        scenario.validate()?;
        let columns = sensor_places(scenario, record)?;
        let quantities: Vec<Quantity> = scenario.sensors.iter().map(|s| s.measures).collect();
        let context = FilterContext::new(scenario, &quantities, record.dt(), settings).over(record, settings);
        let method = match settings.kind {
            kind if kind == FilterKind::UKF => Method::SigmaPoints,
            kind if kind == FilterKind::KF || kind == FilterKind::EKF => Method::Linearised,
            _ => return Ok(None),
        };
        let usual = settings.has_plain_update() && !context.is_late(settings) && serves(settings, &context);
        if !usual {
            return Ok(None);
        }
        let plant = P::with_decay(context.model(settings).eta());
        let filter = Self {
            method,
            initial: initial_belief::<P, N>(settings),
            noise: noise::<P, N>(settings),
            plant,
            dt: context.dt,
            outputs: readings(settings, &context),
            columns,
            input_delay: settings.input_delay,
        };
        Ok((filter.noise.is_finite() && filter.initial.is_finite()).then_some(filter))
    }

    /// Takes one step from a belief: predicts under the first force over mass \[m/s²\], updates under the second.
    ///
    /// # Errors
    /// Those of [`Filter::predict`] and [`Filter::update`].
    pub fn step(
        &self,
        belief: &mut Gaussian<N>,
        forces: [f64; 2],
        measured: &[f64],
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        P::step(self, belief, forces, measured, correction)
    }
}

/// [`OscillatorFilter::step`] of any plant.
fn step<P: Oscillator<N>, const N: usize>(
    filter: &OscillatorFilter<P, N>,
    belief: &mut Gaussian<N>,
    forces: [f64; 2],
    measured: &[f64],
    correction: &mut Correction<N>,
) -> Result<(), FilterError> {
    let from = belief.clone();
    *belief = match filter.method {
        Method::Linearised => {
            let start = Linearised::new(from, 1);
            step_of(filter, start, forces, measured, correction)?
        }
        Method::SigmaPoints => step_of(filter, SigmaPoints::new(from, Rule::Unscented), forces, measured, correction)?,
    };
    Ok(())
}

fn step_of<P: Oscillator<N>, B: Belief<P, N>, const N: usize>(
    filter: &OscillatorFilter<P, N>,
    start: B,
    [before, force]: [f64; 2],
    measured: &[f64],
    correction: &mut Correction<N>,
) -> Result<Gaussian<N>, FilterError> {
    let OscillatorFilter { plant, noise, dt, outputs, .. } = filter;
    let mut filter = Filter::new(plant.clone(), start, *dt, noise.clone(), outputs.clone(), Adaptation::default());
    filter.predict(before)?;
    filter.update(force, measured, correction)?;
    Ok(filter.belief().gaussian().into_owned())
}
