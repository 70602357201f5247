//! How much motion a force gives at each frequency, as it is and as a filter believes it to be.
//!
//! ```text
//! H(iω) = C (iω I - A)⁻¹ B
//! ```
//!
//! takes the force over mass \[m/s²\] to the displacement \[m\] of the mass, or of the first of several, so that |H| is in
//! s². A and B are those of the plant at rest: a Duffing or Bouc-Wen oscillator answers so as long as it hardly moves. Its
//! cubic stiffness and the shape of its hysteresis do not show.

mod band;
mod transfer_function;

use crate::linalg::{Matrix, Vector, lower_root};
use crate::{Channel, Estimates, Model, PlantKind, Record};

use band::Extremes;

pub use transfer_function::TransferFunction;

/// How many draws from a belief one estimate of its band is made of.
const DRAWS: usize = 96;
/// How many such estimates the band is the mean of: one alone is ragged where the belief is wide.
const BATCHES: usize = 4;

/// The response that a filter believes in, frequency by frequency \[s²\].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Believed {
    /// |H| of the estimated parameters.
    pub mean: Vec<f64>,
    /// The 2.5 % and the 97.5 % quantile of |H|; none where the covariance of the parameters has no root.
    pub band: Option<(Vec<f64>, Vec<f64>)>,
}

/// The transfer function of a plant at rest with a value for each of its parameters, in the channel's unit.
pub fn transfer_function(plant: PlantKind, value: impl Fn(Channel) -> f64) -> TransferFunction {
    let value = |channel: Channel| if channel.is_parameter() { value(channel) } else { 0.0 };
    let rest: Vec<f64> = plant.channels().iter().map(|&channel| value(channel)).collect();
    TransferFunction::of(&Model::new(plant), &rest)
}

/// The true transfer function at sample `k`; `None` where a parameter of the truth is not known.
pub fn true_transfer_function(plant: PlantKind, record: &Record, k: usize) -> Option<TransferFunction> {
    let known = |channel| record.truth(channel)?.get(k).copied().filter(|value| value.is_finite());
    plant.parameters().all(|c| known(c).is_some()).then(|| transfer_function(plant, |c| known(c).unwrap_or(f64::NAN)))
}

/// What a filter believes at sample `k` of |H| at some frequencies \[rad/s\], which must be positive.
///
/// The band is that of draws from the normal distribution of the parameters, always the same ones, so that it moves as
/// smoothly as the belief, and of its canonical form ([`Estimates::canonical_mean`]). A filter of logarithms reports its
/// belief in the parameters' own units to first order, and so is its band.
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

/// The transfer function for the mean of a filter's belief at sample `k`, and those for draws from it; the plant is at rest,
/// whatever its motion is believed to be.
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
