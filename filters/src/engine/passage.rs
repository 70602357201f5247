//! The passage of a filter from one sample to the next: what a smoother needs of it.

use super::belief::GaussianBelief;
use super::columns::{divide_by_root, lower_root, multiply};
use super::design::{Design, Method};
use super::dynamics::Dynamics;
use super::level::Level;
use super::linearised::Linearised;
use super::model::Step;
use super::number::Number;
use super::sigma_points::SigmaPoints;

#[derive(Clone, Debug)]
pub struct Passage<T> {
    /// Φ, n × n, of all steps: the derivative by the state, or the regression on it, without directions of no variance.
    pub transition: Vec<T>,
    /// P⁻, n × n; of it the lower triangle counts.
    pub predicted: Vec<T>,
    /// e, m numbers; S, m × m; K, n × m; of the last linearisation of the sensors.
    pub innovation: Vec<T>,
    pub innovation_cov: Vec<T>,
    pub gain: Vec<T>,
    /// H, m × n; empty where there is none.
    pub jacobian: Vec<T>,
    step: Vec<T>,
    root: Vec<T>,
    work: GaussianBelief<T>,
}

impl<T: Number> Passage<T> {
    pub(super) fn new(n: usize) -> Self {
        let zeros = |count: usize| vec![T::of(0.0); count];
        Self {
            transition: zeros(n * n),
            predicted: zeros(n * n),
            innovation: Vec::new(),
            innovation_cov: Vec::new(),
            gain: Vec::new(),
            jacobian: Vec::new(),
            step: zeros(n * n),
            root: zeros(n * n),
            work: GaussianBelief { mean: zeros(n), cov: zeros(n * n) },
        }
    }

    pub(super) fn begin(&mut self, belief: &GaussianBelief<T>) {
        let n = self.work.size();
        self.predicted.copy_from_slice(&belief.cov);
        self.transition.iter_mut().enumerate().for_each(|(at, entry)| *entry = identity(at, n));
        self.innovation.clear();
        self.jacobian.clear();
    }

    pub(super) fn follow(&mut self, linearised: &Linearised<T>, moving: usize) {
        let n = self.work.size();
        for j in 0..n {
            for i in 0..n {
                let entry = if i < moving { linearised.rows[j * moving + i] } else { identity(j * n + i, n) };
                self.step[j * n + i] = entry;
            }
        }
        self.compose();
    }

    /// Before a step by sigma points, whose odd parts are `Φ L`.
    pub(super) fn regress<L: Level>(
        &mut self,
        level: L,
        design: &Design<impl Dynamics>,
        points: &mut SigmaPoints<T>,
        belief: &GaussianBelief<T>,
        step: &Step<'_, T>,
    ) {
        let (Method::SigmaPoints(rule) | Method::SquareRoot(rule)) = design.method else { return };
        let n = belief.size();
        self.work.copy_from(belief);
        lower_root(level, &belief.cov, &mut self.root, n);
        points.advance(level, rule, &design.model, &mut self.work, step);
        self.step.copy_from_slice(&points.root[..n * n]);
        divide_by_root(&mut self.step, &self.root, n);
        self.compose();
    }

    pub(super) fn renew(&mut self, place: usize, kept: T) {
        let n = self.work.size();
        self.transition.iter_mut().skip(place).step_by(n).for_each(|entry| *entry = *entry * kept);
    }

    fn compose(&mut self) {
        let n = self.work.size();
        let Self { transition, step, root, .. } = self;
        multiply(root, step, transition, n, n);
        transition.copy_from_slice(root);
    }
}

fn identity<T: Number>(at: usize, n: usize) -> T {
    T::of(if at.is_multiple_of(n + 1) { 1.0 } else { 0.0 })
}
