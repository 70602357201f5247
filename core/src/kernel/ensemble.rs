//! Beliefs as a sample of states, all of the same weight: EnKF.

use std::borrow::Cow;

use super::kalman::{check, factor, report};
use super::{Belief, Correction, FilterError, Noise, Observation};
use crate::kernel::gaussian::{Gaussian, Matrix, Vector, lower_root};
use crate::kernel::model::Model;
use crate::random::Normal;

/// The ensemble Kalman filter: every member moves by a Runge-Kutta step and a draw of Q, and is corrected with the gain
/// of the ensemble's own covariances, as if its sensors had read their values plus a draw of R.
///
/// Draws are centred, so that they move no mean. Fading stretches the ensemble about its mean.
///
/// Source: Evensen (2003), The ensemble Kalman filter: theoretical formulation and practical implementation; Burgers, van
/// Leeuwen and Evensen (1998), Analysis scheme in the ensemble Kalman filter.
#[derive(Clone, Debug)]
pub struct Ensemble<const N: usize> {
    members: Vec<Vector<N>>,
    normal: Normal,
    /// The belief that the ensemble was drawn from, until it first moves.
    origin: Option<Gaussian<N>>,
}

impl<const N: usize> Ensemble<N> {
    /// `size` members drawn from a Gaussian; at least 2.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] where the Gaussian's covariance has no root.
    pub(crate) fn new(belief: Gaussian<N>, size: usize, mut normal: Normal) -> Result<Self, FilterError> {
        let mut members = vec![belief.mean; size.max(2)];
        add_draws(&mut members, &belief.cov, &mut normal)?;
        Ok(Self { members, normal, origin: Some(belief) })
    }

    /// `P ← λ P + Q`
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where Q has no root.
    fn spread(&mut self, Noise { process, fading, .. }: &Noise<N>) -> Result<(), FilterError> {
        let Self { members, normal, .. } = self;
        if *fading != 1.0 {
            let mean = mean(members);
            let stretch = fading.sqrt();
            for member in members.iter_mut() {
                *member = mean + (*member - mean) * stretch;
            }
        }
        add_draws(members, process, normal)
    }
}

impl<P: Model<N>, const N: usize> Belief<P, N> for Ensemble<N> {
    const PADDED: bool = true;

    fn predict(&mut self, model: &P, force: f64, dt: f64, noise: &Noise<N>) -> Result<(), FilterError> {
        self.origin = None;
        for member in &mut self.members {
            *member = model.runge_kutta_step(member, force, dt);
        }
        self.spread(noise)
    }

    fn condition<const M: usize>(
        &mut self,
        model: &P,
        observation: &Observation<M>,
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        let Self { members, normal, .. } = self;
        let readings: Vec<Vector<M>> = members.iter().map(|member| observation.read(model, member)).collect();
        let (state_mean, reading_mean) = (mean(members), mean(&readings));
        let mut innovation_cov = Matrix::<M, M>::zeros();
        let mut cross = Matrix::<N, M>::zeros();
        for (member, reading) in members.iter().zip(&readings) {
            let deviation = reading - reading_mean;
            innovation_cov += deviation * deviation.transpose();
            cross += (member - state_mean) * deviation.transpose();
        }
        let degrees = (members.len() - 1) as f64;
        innovation_cov /= degrees;
        cross /= degrees;
        observation.add_noise(&mut innovation_cov);

        let factor = factor(&innovation_cov, M)?;
        let gain = factor.divide(&cross);
        let innovation = observation.values - reading_mean;
        let mut perturbed = vec![observation.values; members.len()];
        let noise = Vector::<M>::from_fn(|row, _| observation.active[row].variance);
        add_draws(&mut perturbed, &Matrix::from_diagonal(&noise), normal)?;
        for ((member, reading), value) in members.iter_mut().zip(&readings).zip(&perturbed) {
            *member += gain * (value - reading);
        }
        report(observation.measured(), &innovation, &innovation_cov, &factor, &gain, correction);
        check(&Belief::<P, N>::gaussian(self))
    }

    fn gaussian(&self) -> Cow<'_, Gaussian<N>> {
        if let Some(origin) = &self.origin {
            return Cow::Borrowed(origin);
        }
        let mean = mean(&self.members);
        let mut cov = Matrix::<N, N>::zeros();
        for member in &self.members {
            let deviation = member - mean;
            cov += deviation * deviation.transpose();
        }
        Cow::Owned(Gaussian { mean, cov: cov / (self.members.len() - 1) as f64 })
    }
}

/// The mean, taken about the first member, so that the mean of equal values is that value to the last bit.
fn mean<const N: usize>(sample: &[Vector<N>]) -> Vector<N> {
    let sum: Vector<N> = sample.iter().map(|x| x - sample[0]).sum();
    sample[0] + sum / sample.len() as f64
}

/// Adds a draw from a normal distribution to every element; together the draws have a mean of zero.
fn add_draws<const N: usize>(
    sample: &mut [Vector<N>],
    cov: &Matrix<N, N>,
    normal: &mut Normal,
) -> Result<(), FilterError> {
    let root = lower_root(cov)?;
    let count = sample.len() as f64;
    // Centring takes one degree of freedom.
    let scale = (count / (count - 1.0)).sqrt();
    let draws: Vec<Vector<N>> = sample.iter().map(|_| Vector::from_fn(|_, _| normal.sample())).collect();
    let centre = mean(&draws);
    for (element, draw) in sample.iter_mut().zip(&draws) {
        *element += root * (draw - centre) * scale;
    }
    Ok(())
}
