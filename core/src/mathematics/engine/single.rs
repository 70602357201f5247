//! The engine for one run: predict and update of a belief that the caller stores.

use super::belief::{Belief, Noise};
use super::columns::{Rooted, lower_root};
use super::design::{Design, Method};
use super::fault::{Held, of_root};
use super::level::Baseline;
use super::linearised::Linearised;
use super::model::Model;
use super::propagation::Propagation;
use super::sigma_points::SigmaPoints;
use super::square_root::{SquareRoot, std};
use super::step::Step;
use super::update::{Observation, Told, Update};
use crate::FilterError;
use crate::mathematics::filter::adaptation::Adaptation;
use crate::mathematics::filter::robust::Robust;
use crate::mathematics::model::Reading;

/// Mean and covariance, n and n × n numbers; of the covariance the lower triangle counts.
#[derive(Debug)]
pub(crate) struct Moments<'a> {
    /// y
    pub(crate) mean: &'a mut [f64],
    /// P
    pub(crate) cov: &'a mut [f64],
    /// The root of P, n × n, row by row, of a filter that holds one; else empty.
    pub(crate) root: &'a mut [f64],
}

/// The memory of one filter.
#[derive(Clone, Debug)]
pub(crate) struct Single {
    design: Design,
    belief: Belief<f64>,
    /// The belief before the update, where the sensors are linearised again.
    prior: Belief<f64>,
    at: Vec<f64>,
    noise: Noise<f64>,
    linearised: Linearised<f64>,
    points: SigmaPoints<f64>,
    root: Option<SquareRoot<f64>>,
    update: Update<f64>,
    measured: Vec<f64>,
    held: Held<bool>,
}

/// The measurements of one sample: a number for each sensor, NaN where it is missing, and its variance.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Measured<'a> {
    /// The recorded force over mass that acts meanwhile \[m/s²\].
    pub(crate) force: f64,
    /// z
    pub(crate) values: &'a [f64],
    /// The diagonal of R.
    pub(crate) variances: &'a [f64],
}

/// The step of an iteration counts as none when it is this small, squared, against the variance.
const CONVERGED: f64 = 1e-12;

impl Single {
    /// The memory for a model and sensors that read this.
    pub(crate) fn new(book: &crate::Model, method: Method, readings: Vec<Reading>) -> Self {
        let model = Model::of(book);
        let (n, sensors) = (model.size, readings.len());
        let belief = Belief { mean: vec![0.0; n], cov: vec![0.0; n * n] };
        Self {
            prior: belief.clone(),
            belief,
            at: vec![0.0; n],
            noise: Noise { process: vec![0.0; n], matrix: Vec::new(), sensors: vec![1.0; sensors], fading: 1.0 },
            linearised: Linearised::new(&model),
            points: SigmaPoints::new(&model),
            root: match method {
                Method::SquareRoot(rule) => Some(SquareRoot::new(&model, rule, sensors)),
                Method::Linearised(..) | Method::SigmaPoints(_) => None,
            },
            update: Update::new(&model, sensors),
            measured: vec![f64::NAN; sensors],
            held: Held::new(),
            design: Design {
                model,
                method,
                dt: 0.0,
                has_slope: true,
                substeps: 1,
                readings,
                white: None,
                robust: Robust::NONE,
                adaptation: Adaptation::default(),
                jumps: false,
            },
        }
    }

    /// Moves a belief by a step, without noise. If it has a root, [`Self::spread`] completes it.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where sigma points cannot be drawn.
    pub(crate) fn advance(&mut self, mut moments: Moments<'_>, step: &Step<f64>) -> Result<(), FilterError> {
        self.take(&moments);
        let Self { design: Design { model, method, .. }, belief, linearised, points, root, .. } = self;
        match (*method, root) {
            (Method::Linearised(propagation, _), _) => linearised.advance(Baseline, propagation, model, belief, step),
            (Method::SquareRoot(_), Some(root)) => root.advance(Baseline, model, belief, step),
            (Method::SigmaPoints(rule) | Method::SquareRoot(rule), _) => {
                rooted(points.advance(Baseline, rule, model, belief, step))?;
            }
        }
        self.give(&mut moments);
        Ok(())
    }

    /// Completes a belief with a root that has moved: `λ P + Q`, Q n × n.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where Q has no root.
    pub(crate) fn spread(&mut self, mut moments: Moments<'_>, process: &[f64], fading: f64) -> Result<(), FilterError> {
        let Self { belief, prior, root: Some(root), .. } = self else { return Ok(()) };
        let n = belief.size();
        let is_usual = |(at, q): (usize, &f64)| if at % (n + 1) == 0 { *q >= 0.0 && q.is_finite() } else { *q == 0.0 };
        if process.iter().enumerate().all(is_usual) {
            root.spread(Baseline, fading, |i, row| row[i] = std(process[i * (n + 1)]));
        } else {
            rooted(lower_root(Baseline, process, &mut prior.cov, n))?;
            root.spread(Baseline, fading, |i, row| (0..=i).for_each(|k| row[k] = prior.cov[k * n + i]));
        }
        self.square();
        self.give(&mut moments);
        Ok(())
    }

    /// Makes a component of a belief with a root another one, which has mean zero and this variance and knows nothing of the
    /// others.
    pub(crate) fn renew(&mut self, mut moments: Moments<'_>, place: usize, variance: f64) {
        self.take(&moments);
        if let Some(root) = &mut self.root {
            root.renew(Baseline, &mut self.belief, place, variance);
        }
        self.square();
        self.give(&mut moments);
    }

    /// Makes the covariance that of the root, if there is one.
    fn square(&mut self) {
        if let Some(root) = &self.root {
            root.square(Baseline, &mut self.belief.cov);
        }
    }

    fn take(&mut self, moments: &Moments<'_>) {
        self.belief.take(moments);
        if let Some(root) = &mut self.root {
            root.rows_mut().copy_from_slice(moments.root);
        }
    }

    fn give(&self, moments: &mut Moments<'_>) {
        self.belief.give(moments);
        if let Some(root) = &self.root {
            moments.root.copy_from_slice(root.rows());
        }
    }

    /// Φ, n × n, written over `out`: the derivative of a step by the state, or its regression on the state.
    ///
    /// ```text
    /// Φ L = odd parts of the points
    /// ```
    ///
    /// Directions without variance are left out of the regression.
    ///
    /// # Errors
    /// Those of [`Self::advance`].
    pub(crate) fn transition_into(
        &mut self,
        moments: &mut Moments<'_>,
        step: &Step<f64>,
        out: &mut [f64],
    ) -> Result<(), FilterError> {
        self.belief.take(moments);
        match self.design.method {
            Method::Linearised(propagation, _) => self.step_into(propagation, moments.mean, step, out),
            Method::SigmaPoints(rule) | Method::SquareRoot(rule) => {
                let Self { design: Design { model, .. }, belief, points, prior, .. } = self;
                let n = model.size;
                rooted(lower_root(Baseline, &belief.cov, &mut prior.cov, n))?;
                rooted(points.advance(Baseline, rule, model, belief, step))?;
                out.copy_from_slice(points.odd());
                divide_by_root(out, &prior.cov, n);
            }
        }
        Ok(())
    }

    /// Moves a mean by a step, and takes the step's derivative by the state, n × n, written over `out`.
    pub(crate) fn step_into(&mut self, propagation: Propagation, mean: &mut [f64], step: &Step<f64>, out: &mut [f64]) {
        let Self { design: Design { model, .. }, linearised, .. } = self;
        let (n, moving) = (model.size, model.moving());
        linearised.step(Baseline, propagation, model, mean, step);
        for (j, column) in out.chunks_exact_mut(n).enumerate() {
            column.fill(0.0);
            column[j] = 1.0;
            column[..moving].copy_from_slice(&linearised.rows[j * moving..(j + 1) * moving]);
        }
    }

    /// Conditions a belief on measurements. `report` is called with the first update, and with the last one if the
    /// sensors are linearised again.
    ///
    /// # Errors
    /// Those of the [update](crate::mathematics::filter::Filter::update).
    pub(crate) fn condition(
        &mut self,
        mut moments: Moments<'_>,
        measured: Measured<'_>,
        mut report: impl FnMut(&Told<f64>, Parts<'_>),
    ) -> Result<(), FilterError> {
        self.take(&moments);
        self.noise.sensors.copy_from_slice(measured.variances);
        self.measured.copy_from_slice(measured.values);
        let iterations = if let Method::Linearised(_, iterations) = self.design.method { iterations } else { 1 };
        if iterations > 1 {
            self.prior.copy_from(&self.belief);
        }
        let Self { design, belief, root, noise, update, held, .. } = self;
        let observation = Observation { force: measured.force, measured: &self.measured };
        let told = update.condition(Baseline, design, belief, root.as_mut(), noise, observation, held);
        self.check(&told)?;
        report(&told, self.parts());
        let readings = &self.design.readings;
        if iterations > 1 && !self.update.active().iter().all(|&sensor| readings[sensor].is_of_components()) {
            let told = self.descend(measured.force, iterations)?;
            report(&told, self.parts());
        }
        self.give(&mut moments);
        Ok(())
    }

    /// Goes on from the first step of a Gauss-Newton descent to the most probable state, each step linearising the sensors where
    /// the last has led:
    ///
    /// ```text
    /// yᵢ₊₁ = y⁻ + Kᵢ (z - h(yᵢ) - Hᵢ (y⁻ - yᵢ)),  y₀ = y⁻
    /// ```
    fn descend(&mut self, force: f64, iterations: usize) -> Result<Told<f64>, FilterError> {
        let mut iteration = 1;
        loop {
            let Self { design, belief, prior, at, noise, update, held, measured, .. } = self;
            at.copy_from_slice(&belief.mean);
            belief.copy_from(prior);
            let observation = Observation { force, measured };
            let told = update.condition_at(Baseline, design, belief, noise, observation, at, held);
            self.check(&told)?;
            iteration += 1;
            let Self { belief, at, .. } = self;
            let n = belief.size();
            let is_small = |i: usize| {
                let moved = belief.mean[i] - at[i];
                moved * moved <= CONVERGED * belief.cov[i * n + i]
            };
            if iteration == iterations || (0..n).all(is_small) {
                return Ok(told);
            }
        }
    }

    fn check(&self, told: &Told<f64>) -> Result<(), FilterError> {
        if told.holds { Ok(()) } else { Err(self.held.reason(0, || self.update.of_lane(0))) }
    }

    /// The parts of the last update.
    fn parts(&self) -> Parts<'_> {
        Parts { design: &self.design, update: &self.update }
    }
}

/// The parts of an update by m measurements.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Parts<'a> {
    design: &'a Design,
    update: &'a Update<f64>,
}

impl<'a> Parts<'a> {
    /// e, m numbers; S, m × m, only its lower triangle; K, n × m.
    pub(crate) fn numbers(&self) -> [&'a [f64]; 3] {
        self.update.parts()
    }

    /// H, m × n, written over `out`. Returns whether there is an H.
    pub(crate) fn jacobian_into(&self, out: &mut [f64]) -> bool {
        self.update.jacobian_into(self.design, out)
    }
}

impl Belief<f64> {
    fn take(&mut self, moments: &Moments<'_>) {
        self.mean.copy_from_slice(moments.mean);
        self.cov.copy_from_slice(moments.cov);
    }

    fn give(&self, moments: &mut Moments<'_>) {
        moments.mean.copy_from_slice(&self.mean);
        moments.cov.copy_from_slice(&self.cov);
    }
}

fn rooted(rooted: Rooted<bool>) -> Result<(), FilterError> {
    if rooted.holds { Ok(()) } else { Err(of_root(rooted.is_finite, FilterError::IndefiniteCovariance)) }
}

/// `X L⁻¹` in place of X, n × n, the last column first.
fn divide_by_root(x: &mut [f64], root: &[f64], n: usize) {
    for j in (0..n).rev() {
        let (before, after) = x.split_at_mut((j + 1) * n);
        let column = &mut before[j * n..];
        for (k, later) in (j + 1..n).zip(after.chunks_exact(n)) {
            column.iter_mut().zip(later).for_each(|(entry, later)| *entry -= root[j * n + k] * later);
        }
        let pivot = root[j * n + j];
        let inverse = if pivot == 0.0 { 0.0 } else { 1.0 / pivot };
        column.iter_mut().for_each(|entry| *entry *= inverse);
    }
}
