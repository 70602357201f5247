//! A step by the book reserves no memory.

use kalmanscope_core::filter::{Adaptation, Correction, Filter, Gaussian, Noise, Normal};
use kalmanscope_core::filter::{Matrix, Vector};
use kalmanscope_core::{FilterKind, FilterSettings, Hold, InputKind, PlantKind, Propagation, Quantity};

#[test]
fn a_step_by_the_book_reserves_no_memory() {
    let kinds = FilterKind::ALL.into_iter().filter(|kind| !kind.is_sampled());
    for (kind, plant) in kinds.flat_map(|kind| PlantKind::ALL.map(|plant| (kind, plant))) {
        for log_parameters in [false, true] {
            for propagation in Propagation::ALL {
                let settings = FilterSettings {
                    kind,
                    log_parameters,
                    propagation: Some(propagation),
                    ..FilterSettings::default()
                };
                let model = settings.model(plant, InputKind::Force);
                let n = model.size();
                let values: Vec<f64> = model.channels().iter().map(|&c| settings.initial_mean[c]).collect();
                let (mean, _) = model.to_state(&values);
                let initial = Gaussian::independent(mean, &Vector::repeat(n, 0.01));
                let process = Matrix::identity(n, n) * 1e-8;
                let noise = Noise { process, sensors: vec![1e-4, 1e-2], fading: 1.002 };
                let belief =
                    (kind.info().begin)(initial, &settings.method(plant), Normal::from_seed(1)).expect("it has a root");
                let sensors = [Quantity::DISPLACEMENT, Quantity::ACCELERATION];
                let learns = Adaptation::default();
                let mut filter = Filter::new(model, belief, 0.01, Hold::First, noise, &sensors, learns);
                let mut correction = Correction::default();
                let mut steps = |count: usize| {
                    for k in 0..count {
                        filter.predict([1.0, 0.5]).expect("it goes on");
                        let displacement = if k % 3 == 1 { f64::NAN } else { 1e-3 };
                        filter.update(0.5, &[displacement, 0.4], &mut correction).expect("it goes on");
                    }
                };
                steps(3);
                let reserved = allocation_counter::measure(|| steps(6)).count_total;
                assert_eq!(reserved, 0, "{kind:?} {plant:?} {log_parameters} {propagation:?}");
            }
        }
    }
}
