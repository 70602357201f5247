//! The kernels agree with the reference filters: the same scenario by both, over a whole record, sample by sample.

use std::sync::Arc;

use kalmanscope_core::filter::{FilterInfo, FilterKind};
use kalmanscope_core::simulate;
use kalmanscope_core::{Estimates, FilterSettings, PlantKind, Quantity, Record, Run, Scenario};

/// The same kind of filter under a name without a kernel, so that the reference filter is used.
fn by_the_book(kind: FilterKind) -> FilterKind {
    let key = format!("book_{}", kind.key()).leak();
    FilterKind::new(Box::leak(Box::new(FilterInfo { key, ..*kind.info() })))
}

/// A changing truth of a plant that has a kernel, over 31 samples, with sensors of some quantities.
fn truth(plant: PlantKind, quantities: &[Quantity]) -> Scenario {
    let mut scenario = Scenario { duration: 0.3, filters: vec![FilterSettings::default()], ..Scenario::default() };
    scenario.filters[0].fading = 1.002;
    scenario.set_plant(plant);
    scenario.plant.disturbance_std = 0.5;
    scenario.set_sensors(quantities);
    scenario
}

/// The record of a scenario, in which every fifth sample lacks its first sensor and every eleventh lacks all.
fn record(scenario: &Scenario) -> Record {
    simulate(scenario).without_truth().with_gaps(|sensor, k| k % 11 == 10 || (k % 5 == 4 && sensor == 0))
}

fn estimates(scenario: &Scenario, record: &Arc<Record>) -> Estimates {
    let mut run = Run::on_record(scenario, Arc::clone(record)).unwrap();
    run.finish();
    run.estimates()[0].clone()
}

/// The largest relative difference of two estimates over the first samples: of means, relative to the larger of mean
/// and standard deviation; of covariances, to the standard deviations of both channels; otherwise to the larger number.
fn difference(a: &Estimates, b: &Estimates, samples: usize) -> f64 {
    assert_eq!((a.len(), a.stop().map(|stop| stop.reason)), (b.len(), b.stop().map(|stop| stop.reason)));
    let mut worst = 0.0_f64;
    let mut compare = |what: &str, k: usize, a: f64, b: f64, size: f64| {
        assert_eq!(a.is_nan(), b.is_nan(), "{what} at sample {k}: {a} and {b}");
        if a != b && !a.is_nan() {
            worst = worst.max((a - b).abs() / size);
        }
    };
    let n = a.channels().len();
    for k in 0..samples.min(a.len()) {
        let std: Vec<f64> = (0..n).map(|i| a.std(k, i)).collect();
        for i in 0..n {
            compare("mean", k, a.mean(k)[i], b.mean(k)[i], std[i].max(a.mean(k)[i].abs()));
            for j in 0..n {
                compare("covariance", k, a.cov(k)[i * n + j], b.cov(k)[i * n + j], std[i] * std[j]);
            }
        }
        let m = a.sensors().len();
        for i in 0..m {
            let size = a.innovation_cov(k)[i * m + i].sqrt();
            compare("innovation", k, a.innovation(k)[i], b.innovation(k)[i], size.max(a.innovation(k)[i].abs()));
            compare("S", k, a.innovation_cov(k)[i * m + i], b.innovation_cov(k)[i * m + i], size * size);
            for (c, std) in std.iter().enumerate() {
                let gain = a.gain(k)[i * n + c];
                compare("gain", k, gain, b.gain(k)[i * n + c], gain.abs().max(std / size));
            }
        }
        compare("NIS", k, a.nis()[k], b.nis()[k], a.nis()[k].max(1.0));
        compare("determinant", k, a.determinant()[k], b.determinant()[k], a.determinant()[k]);
    }
    worst
}

/// The samples of one step: the second step amplifies the rounding of the first.
const ONE_STEP: usize = 2;

/// Number of samples before rounding is amplified much.
const A_FEW: usize = 3;

/// The filter of a scenario by kernel and by reference, over the same record: the largest differences over one step,
/// over a few samples, and over all.
fn kernel_and_reference(scenario: &Scenario, record: &Arc<Record>) -> [f64; 3] {
    let mut book = scenario.clone();
    let filter = &mut book.filters[0];
    filter.kind = by_the_book(filter.kind);
    let (kernel, book) = (estimates(scenario, record), estimates(&book, record));
    assert!(kernel.len() > 25, "the filter goes on for a while: {:?}", kernel.stop());
    [ONE_STEP, A_FEW, usize::MAX].map(|samples| difference(&kernel, &book, samples))
}

const PLANTS: [PlantKind; 6] = [
    PlantKind::SDOF,
    PlantKind::DUFFING,
    PlantKind::BOUC_WEN,
    PlantKind::SHEAR_2,
    PlantKind::SHEAR_3,
    PlantKind::SHEAR_4,
];

/// Variants of a filter's settings: decay, logarithms, adaptation, both, none.
fn variants(settings: &FilterSettings) -> Vec<(&'static str, FilterSettings)> {
    let mut adaptive = settings.clone();
    adaptive.adaptation.sensor_noise = true;
    adaptive.adaptation.process_noise = true;
    vec![
        ("plain", settings.clone()),
        ("decay", FilterSettings { eta: 0.02, ..settings.clone() }),
        ("logarithms", FilterSettings { log_parameters: true, ..settings.clone() }),
        ("logarithms and decay", FilterSettings { eta: 0.02, log_parameters: true, ..settings.clone() }),
        ("adaptation", adaptive),
    ]
}

#[test]
fn kernels_agree_with_the_reference_filters() {
    let sensors: [&[Quantity]; 3] = [
        &[Quantity::DISPLACEMENT, Quantity::VELOCITY],
        &[Quantity::DISPLACEMENT, Quantity::ACCELERATION],
        &[Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION],
    ];
    for plant in PLANTS {
        for quantities in sensors {
            let scenario = truth(plant, quantities);
            let record = Arc::new(record(&scenario));
            for kind in FilterKind::ALL {
                for (name, mut settings) in variants(&scenario.filters[0]) {
                    settings.kind = kind;
                    settings.ensemble_size = 400;
                    if kind == FilterKind::PF {
                        // With nearly all weight on one particle, the particles are so close together that their spread
                        // is rounding.
                        settings.sensor_std.iter_mut().for_each(|std| *std *= 30.0);
                    }
                    if kind == FilterKind::KF {
                        // The reference filter's own name hides that a KF knows its parameters.
                        settings.eta = 0.0;
                        for channel in plant.parameters() {
                            settings.initial_mean[channel] = channel.usual_truth();
                            settings.initial_std[channel] = 0.0;
                            settings.process_std[channel] = 0.0;
                        }
                    }
                    let scenario = Scenario { filters: vec![settings], ..scenario.clone() };
                    let [step, few, forth] = kernel_and_reference(&scenario, &record);
                    let what = format!("{plant:?} {kind:?} {quantities:?} {name}: {step:.1e} {few:.1e} {forth:.1e}");
                    // Rounding grows over a record, most of all for particles that are close together. An accelerometer takes
                    // nearly all of a variance away, which amplifies the rounding of the step before.
                    let curved = [FilterKind::UKF, FilterKind::CKF, FilterKind::SR_UKF].contains(&kind)
                        && quantities.contains(&Quantity::ACCELERATION);
                    let limits = match kind {
                        kind if kind == FilterKind::PF => [1e-12, 1e-11, 1e-9],
                        _ if curved => [1e-12, 4e-12, 2e-11],
                        _ => [1e-12, 1e-12, 2e-11],
                    };
                    assert!([step, few, forth].iter().zip(limits).all(|(error, limit)| *error < limit), "{what}");
                }
            }
        }
    }
}
