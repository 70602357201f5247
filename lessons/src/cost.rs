//! The cost of a filter's prediction, independent of the machine.

use kalmanscope_core::{FilterSettings, InputKind, PlantKind};

/// The number of evaluations of the plant's rate `g(y, f)` in one predicted step. `truth` is the filter's plant unless
/// its settings name another; it has n channels. A Jacobian counts as n evaluations, one per column, as in finite
/// differences.
///
/// ```text
/// KF, EKF, IEKF    1 + n by local linearisation or Euler, 4 (1 + n) by Runge-Kutta
/// UKF, SR-UKF      4 (2n + 1)
/// CKF              4 · 2n
/// EnKF, PF         4 times the size of the ensemble
/// ```
pub fn evaluations_per_step(settings: &FilterSettings, truth: PlantKind) -> usize {
    (settings.kind.info().evaluations)(&settings.method(), settings.model(truth, InputKind::Force).size())
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::{FilterKind, Propagation};

    #[test]
    fn each_kind_has_its_count() {
        let of = |kind| evaluations_per_step(&FilterSettings { kind, ..FilterSettings::default() }, PlantKind::SDOF);
        let counts = FilterKind::ALL.map(of);
        assert_eq!(counts, [5, 5, 5, 36, 36, 32, 2000, 2000, 2500]);
        let other = FilterSettings {
            plant: Some(PlantKind::DUFFING),
            propagation: Propagation::RungeKutta,
            ..FilterSettings::default()
        };
        assert_eq!(evaluations_per_step(&other, PlantKind::SDOF), 24);
    }
}
