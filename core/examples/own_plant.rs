//! A user's own plant: a pendulum with unknown natural frequency and damping ratio.
//!
//! ```text
//! cargo run -p kalmanscope-core --example own_plant
//! ```

use kalmanscope_core::plant::{Plant, PlantInfo, Spring};
use kalmanscope_core::{Channel, FilterKind, FilterSettings, PlantKind, Run, RunError, Scenario, Signal};

/// `ẍ + 2ζωₙẋ + ωₙ² sin x = f` with the angle x \[rad\] and state `y = [x, v, ωₙ, ζ]`.
struct Pendulum;

static INFO: PlantInfo<'_> = PlantInfo {
    key: "pendulum",
    name: "pendulum",
    equation: "ẍ + 2ζωₙẋ + ωₙ² sin x = f",
    reference: "Huygens (1673), Horologium Oscillatorium",
    channels: &[Channel::DISPLACEMENT, Channel::VELOCITY, Channel::NATURAL_FREQUENCY, Channel::DAMPING_RATIO],
    is_linear: false,
    spring: Spring::Linear,
};

impl Plant for Pendulum {
    fn info(&self) -> PlantInfo<'_> {
        INFO
    }

    fn motion_rate(&self, state: &[f64], force: f64, rate: &mut [f64]) {
        let &[x, v, wn, zeta, ..] = state else { return };
        rate[0] = v;
        rate[1] = force - 2.0 * zeta * wn * v - wn * wn * x.sin();
    }

    fn motion_jacobian(&self, state: &[f64], jacobian: &mut [f64]) {
        let &[x, v, wn, zeta, ..] = state else { return };
        #[rustfmt::skip]
        jacobian.copy_from_slice(&[
            0.0,                1.0,              0.0,                              0.0,
            -wn * wn * x.cos(), -2.0 * zeta * wn, -2.0 * (wn * x.sin() + zeta * v), -2.0 * wn * v,
        ]);
    }
}

/// The kind, for use in scenarios.
pub(crate) const PENDULUM: PlantKind = PlantKind::new(&Pendulum);

/// The natural frequency \[rad/s\] of a pendulum of 5 rad/s, identified by an EKF and a UKF: estimate and standard
/// deviation of each.
///
/// # Errors
/// [`RunError`] where the scenario is impossible.
pub(crate) fn identify() -> Result<Vec<(f64, f64)>, RunError> {
    let filter = |kind| FilterSettings { kind, sensor_std: vec![0.01, 0.06], ..FilterSettings::default() };
    let filters = [FilterKind::EKF, FilterKind::UKF].map(filter).to_vec();
    let mut scenario = Scenario { duration: 40.0, filters, ..Scenario::default() };
    scenario.set_plant(PENDULUM);
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(5.0));
    let mut run = Run::new(&scenario)?;
    run.finish();
    let last = |estimates: &kalmanscope_core::Estimates| {
        let (k, place) = (estimates.len() - 1, 2);
        (estimates.canonical_mean(k, place), estimates.std(k, place))
    };
    Ok(run.estimates().iter().map(last).collect())
}

fn main() -> Result<(), RunError> {
    for (estimate, std) in identify()? {
        println!("natural frequency {estimate:.3} ± {std:.3} rad/s, and in truth 5");
    }
    Ok(())
}
