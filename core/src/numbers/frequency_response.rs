//! Frequency responses of plants, true and estimated.
//!
//! ```text
//! H(iω) = C (iω I - A)⁻¹ B
//! ```
//!
//! is the transfer function from the force over mass \[m/s²\] to the displacement \[m\] of the first mass, so that |H|
//! is in s². A and B are those of the plant at rest, so that for a Duffing or Bouc-Wen oscillator the response holds
//! for small motion. It does not depend on the cubic stiffness or the shape of the hysteresis.

mod band;
mod transfer_function;

use crate::mathematics::linalg::{Matrix, Vector, lower_root};
use crate::{Channel, Estimates, Model, PlantKind, Record};

use band::Extremes;

pub use transfer_function::TransferFunction;

/// The number of draws from a belief for one estimate of the band.
const DRAWS: usize = 96;
/// The number of such estimates that are averaged; a single one is ragged where the belief is wide.
const BATCHES: usize = 4;

/// The estimated frequency response and its band \[s²\].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Believed {
    /// |H| of the estimated parameters.
    pub mean: Vec<f64>,
    /// The 2.5 % and the 97.5 % quantile of |H|. `None` if the covariance of the parameters has no root.
    pub band: Option<(Vec<f64>, Vec<f64>)>,
}

/// The transfer function of a plant at rest, with a value for each of its parameters in the channel's unit.
pub fn transfer_function(plant: PlantKind, value: impl Fn(Channel) -> f64) -> TransferFunction {
    let value = |channel: Channel| if channel.is_parameter() { value(channel) } else { 0.0 };
    let rest: Vec<f64> = plant.channels().iter().map(|&channel| value(channel)).collect();
    TransferFunction::of(&Model::new(plant), &rest)
}

/// The true transfer function at sample `k`. `None` if a parameter of the truth is not known.
pub fn true_transfer_function(plant: PlantKind, record: &Record, k: usize) -> Option<TransferFunction> {
    let known = |channel| record.truth(channel)?.get(k).copied().filter(|value| value.is_finite());
    plant.parameters().all(|c| known(c).is_some()).then(|| transfer_function(plant, |c| known(c).unwrap_or(f64::NAN)))
}

/// The estimate of |H| and its band at sample `k`, at frequencies \[rad/s\] that must be positive.
///
/// The band comes from draws from the normal distribution of the parameters in canonical form
/// ([`Estimates::canonical_mean`]). The draws are the same at every sample, so that the band moves as smoothly as the
/// belief. A filter of logarithms reports its belief in the parameters' own units to first order, and its band has the
/// same accuracy.
pub fn believed(estimates: &Estimates, k: usize, frequencies: &[f64]) -> Believed {
    let (mean, draws) = from_belief(estimates, k);
    let band = draws.map(|draws| {
        let mut band = (vec![0.0; frequencies.len()], vec![0.0; frequencies.len()]);
        let mut magnitude = Vec::with_capacity(frequencies.len());
        for batch in draws.chunks(DRAWS) {
            let mut extremes = Extremes::new(frequencies.len());
            for draw in batch {
                draw.magnitude_into(frequencies, &mut magnitude);
                extremes.push(&magnitude);
            }
            let (low, high) = extremes.quantiles();
            for (mean, quantile) in band.0.iter_mut().zip(low).chain(band.1.iter_mut().zip(high)) {
                *mean += quantile / BATCHES as f64;
            }
        }
        band
    });
    Believed { mean: mean.magnitude(frequencies), band }
}

/// The transfer functions for the mean of a filter's belief at sample `k` and for draws from it, at rest.
fn from_belief(estimates: &Estimates, k: usize) -> (TransferFunction, Option<Vec<TransferFunction>>) {
    let model = Model::new(estimates.plant());
    let (n, motion) = (model.size(), model.motion());
    let mut mean = Vector::zeros(n);
    for i in motion..n {
        mean[i] = estimates.canonical_mean(k, i);
    }
    let (all, cov) = (estimates.channels().len(), estimates.cov(k));
    let parameters = Matrix::from_fn(n - motion, n - motion, |i, j| {
        let (i, j) = (i + motion, j + motion);
        estimates.canonical_sign(k, i) * estimates.canonical_sign(k, j) * cov[j * all + i]
    });
    let draw = |root: &Matrix, i: usize| {
        let normal = Vector::from_fn(n - motion, |j, _| band::normal(i, j, n - motion));
        let mut drawn = mean.clone();
        let mut parameters = drawn.rows_mut(motion, n - motion);
        parameters += root * normal;
        TransferFunction::of(&model, drawn.as_slice())
    };
    let draws = lower_root(&parameters).ok().map(|root| (0..BATCHES * DRAWS).map(|i| draw(&root, i)).collect());
    (TransferFunction::of(&model, mean.as_slice()), draws)
}

#[cfg(test)]
mod tests;
