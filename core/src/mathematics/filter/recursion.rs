//! Predict and update, sample after sample: the part that all filters share.

use super::considered::Considered;
use super::jump::Jump;
use super::learning::Learning;
use super::share::Share;
use super::weighing::Weighing;
use super::{Adaptation, Belief, Correction, FilterError, Matrix, Noise, Observation, Robust, Step, White};
use crate::mathematics::model::{Hold, Model};
use crate::mathematics::quantity::Quantity;

/// A part of a prediction.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Part {
    /// The belief moves.
    Step(Step),
    /// The component at this place is another one from now on.
    Renewal(usize),
}

/// A recursive estimator of the n-component state of a model, at k = 0 and after.
///
/// ```
/// use kalmanscope_core::filter::{Adaptation, Correction, Filter, Gaussian, Moments, Noise, Rule};
/// use kalmanscope_core::filter::{Matrix, Vector};
/// use kalmanscope_core::{Hold, Model, PlantKind, Quantity};
/// # fn main() -> Result<(), kalmanscope_core::FilterError> {
/// let model = Model::new(PlantKind::SDOF);
/// let (mean, std) = ([0.0, 0.0, 8.0, 0.1], [0.1, 0.3, 2.0, 0.1]);
/// let initial = Gaussian::independent(mean.to_vec().into(), &std.to_vec().into());
/// let noise = Noise { process: Matrix::identity(4, 4) * 1e-8, sensors: vec![1e-4], fading: 1.0 };
/// let belief = Box::new(Moments::sigma_points(initial, Rule::Unscented));
/// let mut filter = Filter::new(model, belief, 0.01, Hold::Zero, noise, &[Quantity::DISPLACEMENT], Adaptation::default());
/// let mut correction = Correction::default();
/// filter.predict([1.0, 1.0])?;
/// filter.update(1.0, &[0.002], &mut correction)?;
/// assert!(correction.nis < 1.0);
/// # Ok(())
/// # }
/// ```
pub struct Filter<B: Belief + ?Sized = dyn Belief> {
    model: Model,
    dt: f64,
    hold: Hold,
    noise: Noise,
    observation: Observation,
    learning: Learning,
    jump: Option<Jump>,
    weighing: Option<Weighing>,
    substeps: usize,
    white: Option<White>,
    considered: Option<Considered>,
    belief: Box<B>,
}

impl<B: Belief + ?Sized> Filter<B> {
    /// A filter at k = 0, with `dt` \[s\] between samples. It ignores a sensor for a quantity that the model does not
    /// have.
    pub fn new(
        model: Model,
        belief: Box<B>,
        dt: f64,
        hold: Hold,
        noise: Noise,
        sensors: &[Quantity],
        adaptation: Adaptation,
    ) -> Self {
        let readings = sensors.iter().map(|&quantity| model.reading(quantity)).collect();
        let (observation, learning, substeps) = (Observation::of(readings), Learning::new(adaptation, &noise, dt), 1);
        let (jump, weighing, white, considered) = (None, None, None, None);
        Self { model, belief, dt, hold, noise, observation, learning, jump, weighing, substeps, white, considered }
    }

    /// The same filter with its predictions divided into this many steps, for plants that are not linear over one: the
    /// noise is added in the last.
    #[must_use]
    pub fn with_substeps(self, substeps: usize) -> Self {
        Self { substeps: substeps.max(1), ..self }
    }

    /// The same filter, which widens P once where its innovations grow at once. The belief must be the initial one.
    #[must_use]
    pub fn with_jump(self) -> Self {
        let initial = self.belief.gaussian().cov.diagonal().as_slice().to_vec();
        Self { jump: Some(Jump::new(initial)), ..self }
    }

    /// The same filter, which weighs its measurements by a rule.
    #[must_use]
    pub fn with_robust(self, rule: Robust) -> Self {
        Self { weighing: Weighing::new(rule, self.noise.sensors.len()), ..self }
    }

    /// The same filter, which does not estimate the components at these places but counts their uncertainty: an update keeps their
    /// means and covariance, its gain for them is zero, and fading does not widen them. A belief that is a random sample estimates
    /// them all the same.
    ///
    /// Source: Schmidt (1966), Application of state-space methods to navigation problems.
    #[must_use]
    pub fn with_considered(self, places: &[usize]) -> Self {
        Self { considered: Considered::new(places), ..self }
    }

    /// The same filter with a white force. Its row and column of Q are set to zero: each sample draws it again.
    #[must_use]
    pub fn with_white_force(mut self, white: Option<White>) -> Self {
        self.white = white;
        white.into_iter().for_each(|white| white.leave_out(&mut self.noise.process));
        self
    }

    /// The white force, if the filter has one.
    pub fn white_force(&self) -> Option<White> {
        self.white
    }

    /// The belief after the last predict or update.
    pub fn belief(&self) -> &B {
        &self.belief
    }

    /// The belief, to be changed.
    pub fn belief_mut(&mut self) -> &mut B {
        &mut self.belief
    }

    /// Begins from another belief.
    pub(crate) fn set_belief(&mut self, belief: Box<B>) {
        self.belief = belief;
    }

    /// The usual misfits of the sensors, to which a robust filter compares those of a sample; none for any other filter.
    pub(crate) fn usual_misfits(&self) -> &[f64] {
        self.weighing.as_ref().map_or(&[], |weighing| weighing.weights().usual())
    }

    /// The weight of each sensor's reading in the last update, from 0 to about 1, and NaN where it measured nothing; empty for a
    /// filter that weighs none.
    pub fn weights(&self) -> &[f64] {
        self.weighing.as_ref().map_or(&[], |weighing| weighing.weights().each())
    }

    /// Goes back to the usual misfits of an earlier sample.
    pub(crate) fn set_usual_misfits(&mut self, misfits: &[f64]) {
        if let Some(weighing) = &mut self.weighing {
            weighing.weights_mut().set_usual(misfits);
        }
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// The noise that the filter assumes by now.
    pub fn noise(&self) -> &Noise {
        &self.noise
    }

    /// The variance of each R, where the filter learns R; zero elsewhere.
    pub(crate) fn noise_uncertainty(&self) -> &[f64] {
        self.learning.uncertainty()
    }

    /// Whether the filter learns its noise.
    pub(crate) fn is_adaptive(&self) -> bool {
        self.learning.is_on()
    }

    /// Whether the last prediction has widened P because the innovations had grown at once.
    pub fn has_widened(&self) -> bool {
        self.jump.as_ref().is_some_and(Jump::has_widened)
    }

    /// The step from a sample to the next with the recorded forces over mass of both \[m/s²\].
    pub(crate) fn step(&self, [begin, end]: [f64; 2]) -> Step {
        let end = match self.hold {
            Hold::Zero => begin,
            Hold::First => end,
        };
        Step { forces: [begin, end], hold: self.hold, dt: self.dt }
    }

    /// Carries the belief over one step, from a sample to the next, with the recorded forces over mass of both \[m/s²\].
    /// Where the force is held the second does not matter.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where sigma points cannot be drawn,
    /// [`FilterError::UndefinedForce`]. Any other prediction that overflows is found by the update.
    pub fn predict(&mut self, forces: [f64; 2]) -> Result<(), FilterError> {
        self.predict_by(forces, |_, _, _| Ok(()))
    }

    /// Carries the belief over a share of a step, of dt at most, with the recorded forces over mass at both ends \[m/s²\], and with its
    /// share of the noise. It calls `before` with model, belief and the step, before each substep. A white force and jumps belong
    /// to whole samples: it has none of them.
    ///
    /// # Errors
    /// Those of [`Self::predict`].
    pub(crate) fn predict_share(
        &mut self,
        share: f64,
        [begin, end]: [f64; 2],
        of_share: &mut Share,
        mut before: impl FnMut(&Model, &mut B, Step) -> Result<(), FilterError>,
    ) -> Result<(), FilterError> {
        if ![begin, end].iter().all(|force| force.is_finite()) {
            return Err(FilterError::UndefinedForce);
        }
        of_share.set(share, &self.noise);
        let Self { model, belief, considered, hold, dt, substeps, .. } = self;
        let whole = Step { forces: [begin, end], hold: *hold, dt: *dt * share };
        for substep in 0..*substeps {
            let step = whole.part(substep, *substeps);
            let noise = of_share.of(substep + 1 == *substeps);
            before(model, belief, step)?;
            belief.predict(model, step, noise)?;
            if let Some(considered) = considered {
                considered.keep(&mut **belief, noise)?;
            }
        }
        Ok(())
    }

    /// [`Self::predict`], which calls `before` with model, belief and the next part of the step, before each part.
    pub(crate) fn predict_by(
        &mut self,
        forces: [f64; 2],
        mut before: impl FnMut(&Model, &mut B, Part) -> Result<(), FilterError>,
    ) -> Result<(), FilterError> {
        let whole = self.step(forces);
        if !whole.forces.iter().all(|force| force.is_finite()) {
            return Err(FilterError::UndefinedForce);
        }
        let Self { model, noise, jump, substeps, belief, white, considered, .. } = self;
        let mut wide = None;
        if let Some(widening) = jump.as_mut().and_then(Jump::widening) {
            let Noise { process, .. } = wide.insert(noise.clone());
            // A force that is drawn again at each sample always has its full variance.
            let is_kept = |(i, _): &(usize, f64)| white.is_none_or(|white| white.place != *i);
            widening.enumerate().filter(is_kept).for_each(|(i, variance)| process[(i, i)] += variance);
        }
        let noise = wide.as_ref().unwrap_or(noise);
        let (steps, renewed) = white.map_or((*substeps, 0), |white| white.course.steps(*substeps));
        if steps == 1 {
            before(model, belief, Part::Step(whole))?;
            belief.predict(model, whole, noise)?;
        } else {
            let silent = Noise { process: Matrix::zeros(model.size(), model.size()), sensors: Vec::new(), fading: 1.0 };
            for i in 0..steps {
                let part = whole.part(i, steps);
                before(model, belief, Part::Step(part))?;
                belief.predict(model, part, if i + 1 < steps { &silent } else { noise })?;
                if let Some(white) = white.filter(|_| i + 1 == renewed && renewed < steps) {
                    before(model, belief, Part::Renewal(white.place))?;
                    white.renew(&mut **belief)?;
                }
            }
        }
        if let Some(considered) = considered {
            considered.keep(&mut **belief, noise)?;
        }
        let Some(white) = white.filter(|_| renewed == steps) else { return Ok(()) };
        before(model, belief, Part::Renewal(white.place))?;
        white.renew(&mut **belief)
    }

    /// Conditions the belief on one sample of the sensors, while `force` acts, and writes the update to `correction`. A
    /// measurement that is NaN skips its sensor.
    ///
    /// # Errors
    /// [`FilterError::SingularInnovation`] and [`FilterError::IndefiniteInnovation`] where S is not positive definite;
    /// [`FilterError::IndefiniteCovariance`] where sigma points cannot be drawn or a variance comes out negative;
    /// [`FilterError::NotFinite`] where the belief overflows; [`FilterError::ImpossibleMeasurement`] where the likelihood
    /// does; [`FilterError::InfiniteMeasurement`].
    pub fn update(&mut self, force: f64, measured: &[f64], correction: &mut Correction) -> Result<(), FilterError> {
        let Self { model, noise, observation, learning, jump, weighing, belief, white, considered, .. } = self;
        correction.clear(model.size(), noise.sensors.len());
        learning.go_on();
        if let Some(weighing) = weighing {
            weighing.weights_mut().clear();
        }
        observation.take(force, measured, &noise.sensors)?;
        if observation.is_empty() {
            return belief.gaussian().check();
        }
        if let Some(considered) = considered {
            considered.store(&belief.gaussian());
        }
        if let Some(weighing) = weighing {
            weighing.condition(&mut **belief, model, noise, measured, observation, correction)?;
        } else {
            belief.condition(model, observation, correction)?;
        }
        if let Some(considered) = considered {
            considered.restore(&mut **belief, correction)?;
        }
        // Readings that count for next to nothing are reported as none.
        let counted = observation.sensors().iter().filter(|&&sensor| !correction.innovation[sensor].is_nan()).count();
        if counted == 0 && weighing.is_some() {
            return belief.gaussian().check();
        }
        correction.check(observation.sensors())?;
        if learning.is_on_now() {
            learning.adapt(observation, correction, noise);
            if let Some(white) = white {
                white.leave_out(&mut noise.process);
            }
        }
        if let Some(jump) = jump {
            jump.look(correction.nis, counted);
        }
        Ok(())
    }
}
