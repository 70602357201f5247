//! Predict and update, sample after sample: the part that all filters share.

use super::{Adaptation, Belief, Correction, FilterError, Matrix, Noise, Observation, States, Step, System, White};
use crate::Hold;
use crate::engine::columns::factor;
use crate::engine::dynamics::Dynamics;
use crate::engine::model::{Input, Reading, StateModel};
use crate::engine::weights::Innovations;
use crate::engine::wrapper::{Adapting, Jump};
use crate::gaussian_likelihood::part_of;
use crate::lists::mapped;

/// A recursive estimator of a model's state, whose belief is a random sample or your own. The crate's page has an example.
pub struct Filter<B: Belief + ?Sized = dyn Belief> {
    system: Box<dyn System>,
    dt: f64,
    hold: Hold,
    /// The noise that the filter assumes by now.
    pub noise: Noise,
    observation: Observation,
    learning: Adapting<f64>,
    jump: Option<Jump>,
    substeps: usize,
    /// The white force, if the filter has one.
    pub white: Option<White>,
    /// The belief after the last predict or update.
    pub belief: Box<B>,
}

impl<B: Belief + ?Sized> Filter<B> {
    /// A filter at k = 0, with `dt` \[s\] between samples. It ignores a sensor without a reading.
    pub fn new(
        model: StateModel<impl Dynamics>,
        belief: Box<B>,
        dt: f64,
        hold: Hold,
        noise: Noise,
        readings: Vec<Option<Reading>>,
        adaptation: Adaptation,
    ) -> Self {
        let learning = Adapting::new(adaptation, model.size, &noise.sensors, dt);
        let (observation, substeps) = (Observation::of(readings), 1);
        let (system, jump, white) = (Box::new(States::new(model)), None, None);
        Self { system, belief, dt, hold, noise, observation, learning, jump, substeps, white }
    }

    /// The same filter with its predictions divided into this many steps, for plants that are not linear over one: the noise is added in
    /// the last. With a white force, whose row and column of Q are set to zero: each sample draws it again. If it `jumps`, it widens P
    /// once where its innovations grow at once; the belief must be the initial one.
    #[must_use]
    pub fn with_options(mut self, substeps: usize, white: Option<White>, jumps: bool) -> Self {
        white.into_iter().for_each(|white| white.leave_out(&mut self.noise.process));
        let jump = jumps.then(|| Jump::new(self.belief.gaussian().cov.diagonal().as_slice().to_vec()));
        Self { substeps: substeps.max(1), white, jump, ..self }
    }

    /// The variance of each R, where the filter learns R; zero elsewhere.
    pub fn noise_uncertainty(&self) -> &[f64] {
        &self.learning.uncertainty
    }

    /// Whether it learns noise.
    pub fn is_adaptive(&self) -> bool {
        self.learning.adaptation.is_on()
    }

    /// Whether the last prediction has widened P because the innovations had grown at once.
    pub fn has_widened(&self) -> bool {
        self.jump.as_ref().is_some_and(|jump| jump.has_widened)
    }

    /// Carries the belief over one step, with the recorded forces over mass \[m/s²\], or [inputs](Input), at both ends; held, the second does not matter.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where sigma points cannot be drawn,
    /// [`FilterError::UndefinedForce`]. Any other prediction that overflows is found by the update.
    pub fn predict<'a>(&mut self, inputs: [impl Into<Input<'a>>; 2]) -> Result<(), FilterError> {
        let [begin, end] = inputs.map(Into::into);
        let end = match self.hold {
            Hold::Zero => begin,
            Hold::First => end,
        };
        let whole = Step { inputs: [begin, end], hold: self.hold, dt: self.dt };
        if !whole.inputs.iter().all(|input| input.force.is_finite()) {
            return Err(FilterError::UndefinedForce);
        }
        let Self { system, noise, jump, substeps, belief, white, .. } = self;
        let mut wide = None;
        if let Some(widening) = jump.as_mut().and_then(Jump::widening) {
            let Noise { process, .. } = wide.insert(noise.clone());
            // A force that is drawn again at each sample always has its full variance.
            let is_kept = |(i, _): &(usize, f64)| white.is_none_or(|white| white.place != *i);
            widening.enumerate().filter(is_kept).for_each(|(i, variance)| process[(i, i)] += variance);
        }
        let noise = wide.as_ref().unwrap_or(noise);
        let (steps, renewed) = white.map_or((*substeps, 0), |white| white.course.steps(*substeps));
        let silent = Noise { process: Matrix::zeros(system.size(), system.size()), sensors: Vec::new(), fading: 1.0 };
        for &(place, time) in system.forgotten() {
            belief.renew(place, libm::exp(-whole.dt / time), 0.0)?;
        }
        for i in 0..steps {
            belief.predict(&mut **system, whole.part(i, steps), if i + 1 < steps { &silent } else { noise })?;
            if let Some(white) = white.filter(|_| i + 1 == renewed) {
                belief.renew(white.place, 0.0, white.variance)?;
            }
        }
        Ok(())
    }

    /// Conditions the belief on one sample, while a force over mass \[m/s²\], or an [input](Input), acts, and writes the update to `correction`. NaN skips a sensor.
    ///
    /// # Errors
    /// [`FilterError::SingularInnovation`] and [`FilterError::IndefiniteInnovation`] where S is not positive definite,
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where the belief is not valid any more,
    /// [`FilterError::ImpossibleMeasurement`] where the likelihood overflows; [`FilterError::InfiniteMeasurement`].
    pub fn update<'a>(
        &mut self,
        input: impl Into<Input<'a>>,
        measured: &[f64],
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { system, noise, observation, learning, jump, belief, white, .. } = self;
        *correction = Correction::nothing(system.size(), noise.sensors.len());
        learning.sample += 1;
        observation.take(input.into(), measured, &noise.sensors)?;
        if observation.is_empty() {
            return belief.gaussian().check();
        }
        belief.condition(&mut **system, observation, correction)?;
        correction.check(&observation.sensors)?;
        if learning.learns_now() {
            learn(learning, (observation, measured), correction, noise, *white);
        }
        if let Some(jump) = jump {
            jump.observe(correction.nis, observation.len());
        }
        Ok(())
    }
}

fn learn(
    learning: &mut Adapting<f64>,
    (Observation { sensors, variances, .. }, measured): (&Observation, &[f64]),
    Correction { innovation, innovation_cov, gain, .. }: &Correction,
    noise: &mut Noise,
    white: Option<White>,
) {
    let m = sensors.len();
    let innovation = mapped(sensors, &|&sensor| innovation[sensor]);
    let innovation_cov = part_of(innovation_cov.as_slice(), innovation_cov.nrows(), sensors);
    let mut lower = innovation_cov.clone();
    let (_, is_positive) = factor(&mut lower, m);
    let (innovation, innovation_cov, factor) = (&innovation[..], &innovation_cov[..], &lower[..]);
    let update = Innovations { sensors, innovation, innovation_cov, factor, variances };
    if learning.adaptation.process_noise {
        let gain = gain.select_columns(sensors);
        let process = (noise.process.as_mut_slice(), white.map(|white| white.place));
        learning.adapt_process(&update, gain.as_slice(), true, process);
        noise.process.fill_upper_triangle_with_lower_triangle();
    }
    if learning.adaptation.sensor_noise && is_positive {
        learning.adapt_sensors(&update, measured, &mut noise.sensors);
    }
}
