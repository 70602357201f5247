//! A user's own filter: an EKF that rejects innovations beyond three standard deviations.
//!
//! ```text
//! cargo run -p kalmanscope-core --example own_filter
//! ```

use std::borrow::Cow;

use kalmanscope_core::filter::kalman::{self, Expected};
use kalmanscope_core::filter::{
    Adaptation, Algorithm, Belief, Correction, Filter, FilterError, FilterInfo, Gaussian, Noise, Observation,
    Propagation, Step, System,
};
use kalmanscope_core::filter::{Matrix, Vector};
use kalmanscope_core::{FilterKind, FilterSettings, Hold, Model, PlantKind, Quantity, Run, Scenario};

/// A Gaussian that is linearised at its mean and gives little weight to outliers.
pub(crate) struct Doubting {
    belief: Gaussian,
}

/// Limits an innovation, in standard deviations.
const CREDIBLE: f64 = 3.0;

impl Belief for Doubting {
    fn predict(&mut self, system: &mut dyn System, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let Self { belief } = self;
        let (mean, transition) = system.step(Propagation::LocalLinearisation, &belief.mean, step);
        belief.cov = &transition * &belief.cov * transition.transpose();
        belief.mean = mean;
        noise.spread(&mut belief.cov);
        Ok(())
    }

    fn condition(
        &mut self,
        system: &mut dyn System,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { belief } = self;
        let at = belief.mean.as_slice();
        let (mean, jacobian) = (observation.read(system, at).column(0).into(), observation.jacobian(system, at));
        let mut expected = Expected::linear(belief, mean, jacobian, observation);
        // An outlier is treated as a measurement with more noise.
        let innovation = observation.innovation(&expected.mean);
        for i in 0..innovation.len() {
            let excess = innovation[i] * innovation[i] / (CREDIBLE * CREDIBLE) - expected.cov[(i, i)];
            expected.cov[(i, i)] += excess.max(0.0);
        }
        expected.jacobian = None;
        kalman::condition(belief, &expected, observation, correction)
    }

    fn renew(&mut self, place: usize, kept: f64, variance: f64) -> Result<(), FilterError> {
        self.belief.renew(place, kept, variance);
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        Cow::Borrowed(&self.belief)
    }
}

/// The kind, for use in scenarios.
pub(crate) const DOUBTING: FilterKind = FilterKind::new(&FilterInfo {
    key: "doubting",
    name: "doubting EKF",
    description: "an EKF that takes little notice of outliers",
    reference: "Huber (1964), Robust estimation of a location parameter",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations: |_, n| 1 + n,
    time: |_, n| 500.0 * n as f64,
    has_propagation: false,
    algorithm: Algorithm::Belief(|initial, _, _| Ok(Box::new(Doubting { belief: initial }))),
});

/// Steps the filter by hand over measurements at rest with one outlier of a metre. Returns the estimated displacement
/// after it \[m\].
///
/// # Errors
/// [`FilterError`] where the filter fails.
pub(crate) fn step_by_hand() -> Result<f64, FilterError> {
    let std = Vector::from_column_slice(&[0.1, 0.3, 2.0, 0.1]);
    let initial = Gaussian::independent(Vector::from_column_slice(&[0.0, 0.0, 6.0, 0.05]), &std);
    let noise = Noise { process: Matrix::identity(4, 4) * 1e-10, sensors: vec![1e-4], fading: 1.0 };
    let (model, belief) = (Model::new(PlantKind::SDOF), Box::new(Doubting { belief: initial }));
    let readings = vec![model.reading(Quantity::DISPLACEMENT)];
    let mut filter = Filter::new(model.state, belief, 0.01, Hold::Zero, noise, readings, Adaptation::default());
    let mut correction = Correction::nothing(4, 1);
    for k in 1..=100 {
        filter.predict([0.0, 0.0])?;
        filter.update(0.0, &[if k == 100 { 1.0 } else { 0.0 }], &mut correction)?;
    }
    Ok(filter.belief.gaussian().mean[0])
}

/// The natural frequency \[rad/s\] that the filter identifies in the default scenario, where the true one is 4.8:
/// estimate and standard deviation.
///
/// # Errors
/// [`kalmanscope_core::RunError`] where the scenario is impossible.
pub(crate) fn identify() -> Result<(f64, f64), kalmanscope_core::RunError> {
    let mut scenario = Scenario::default();
    scenario.filters.truncate(1);
    scenario.filters[0] = FilterSettings { kind: DOUBTING, ..scenario.filters[0].clone() };
    let mut run = Run::new(&scenario)?;
    run.finish();
    let estimates = &run.estimates()[0];
    let k = estimates.len() - 1;
    Ok((estimates.mean(k)[2], estimates.std(k, 2)))
}

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("after an outlier of 1 m: {:.4} m", step_by_hand()?);
    let (estimate, std) = identify()?;
    println!("natural frequency {estimate:.3} ± {std:.3} rad/s, and in truth 4.8");
    Ok(())
}
