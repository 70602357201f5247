//! The cost of a filter's prediction, independent of the machine.

use kalmanscope_core::{FilterSettings, InputKind, PlantKind};

/// The number of evaluations of the plant's rate `g(y, f)` in one predicted step. `truth` is the filter's plant unless
/// its settings name another. The kind of the filter has the count.
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
        for (key, count) in [("kf", 5), ("iekf", 5), ("ukf", 36), ("ckf", 32), ("pf", 2000), ("rbpf", 2500)] {
            assert_eq!(FilterKind::from_key(key).map(of), Some(count), "{key}");
        }
        let other = FilterSettings {
            plant: Some(PlantKind::DUFFING),
            propagation: Propagation::RungeKutta,
            ..FilterSettings::default()
        };
        assert_eq!(evaluations_per_step(&other, PlantKind::SDOF), 24);
    }
}
