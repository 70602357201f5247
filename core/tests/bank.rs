//! A bank of still and walking parameters: its arithmetic, its limits, and what it is for.

use kalmanscope_core::filter::{
    Adaptation, Belief as _, Correction, Filter, Gaussian, Matrix, Moments, Noise, Rule, Vector,
};
use kalmanscope_core::signal::{Signal, Step};
use kalmanscope_core::{
    Channel, Diagnosis, Diagnostics, FilterKind, Hold, Model, PlantKind, Propagation, Run, Scenario, VerdictKind,
    simulate,
};

/// A linear oscillator that loses stiffness at 10 s, with one filter.
fn scenario(kind: FilterKind, walk: f64) -> Scenario {
    let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
    let step = Step { from: 6.0, to: 4.5, at: 10.0 };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Step(step));
    scenario.filters.truncate(1);
    let filter = &mut scenario.filters[0];
    (filter.kind, filter.fading, filter.walk) = (kind, 1.0, walk);
    filter.process_std = filter.process_std.clone().with([
        (Channel::DISPLACEMENT, 0.0),
        (Channel::VELOCITY, 1e-3),
        (Channel::NATURAL_FREQUENCY, 0.0),
        (Channel::DAMPING_RATIO, 0.0),
    ]);
    scenario
}

const KINDS: [FilterKind; 5] =
    [FilterKind::EKF, FilterKind::IEKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF];

/// An independent bank, written down as the book has it: two filters, and a page of sums.
struct Book {
    filters: [Filter<Moments>; 2],
    probability: [f64; 2],
    transition: [[f64; 2]; 2],
}

impl Book {
    fn new(scenario: &Scenario) -> Self {
        let settings = &scenario.filters[0];
        let model = Model::new(PlantKind::SDOF);
        let numbers = |of: &dyn Fn(Channel) -> f64| -> Vec<f64> { model.channels().iter().map(|&c| of(c)).collect() };
        let mean = Vector::from_vec(numbers(&|c| settings.initial_mean[c]));
        let std = Vector::from_vec(numbers(&|c| settings.initial_std[c]));
        let filter = |walk: f64| {
            let variance = |c: Channel| {
                let w = if c.is_parameter() { walk * settings.initial_std[c] } else { 0.0 };
                settings.process_std[c].powi(2) + w * w * scenario.dt
            };
            let noise = Noise {
                process: Matrix::from_diagonal(&Vector::from_vec(numbers(&variance))),
                sensors: settings.sensor_std.iter().map(|s| s * s).collect(),
                fading: settings.fading,
            };
            let initial = Gaussian::independent(mean.clone(), &std);
            let belief = if settings.kind == FilterKind::UKF {
                Moments::sigma_points(initial, Rule::Unscented)
            } else {
                Moments::linearised(initial, Propagation::LocalLinearisation, 1)
            };
            let sensors: Vec<_> = scenario.sensors.iter().map(|sensor| sensor.measures).collect();
            let model = Model::new(PlantKind::SDOF);
            Filter::new(model, Box::new(belief), scenario.dt, Hold::Zero, noise, &sensors, Adaptation::default())
        };
        let (a, b) = (scenario.dt / 30.0, scenario.dt);
        let transition = [[1.0 - a, a], [b, 1.0 - b]];
        Self { filters: [filter(0.0), filter(settings.walk)], probability: [1.0, 0.0], transition }
    }

    /// The mixture's mean and covariance after a sample, and c.
    fn step(&mut self, forces: [f64; 2], measured: &[f64]) -> (Vector, Matrix, [f64; 2]) {
        let old: Vec<Gaussian> = self.filters.iter().map(|f| f.belief().gaussian().into_owned()).collect();
        let before = [0, 1].map(|j| (0..2).map(|i| self.transition[i][j] * self.probability[i]).sum::<f64>());
        let mut likelihoods = [0.0; 2];
        for j in 0..2 {
            let weights: Vec<f64> = (0..2).map(|i| self.transition[i][j] * self.probability[i] / before[j]).collect();
            let (mean, cov) = mixture(&weights, &old);
            let filter = &mut self.filters[j];
            assert!(filter.belief_mut().replace(&Gaussian { mean, cov }).unwrap());
            filter.predict(forces).unwrap();
            let mut correction = Correction::nothing(4, measured.len());
            filter.update(forces[1], measured, &mut correction).unwrap();
            // The innovations of the sensors that measured.
            let e: Vec<usize> = (0..measured.len()).filter(|&i| !measured[i].is_nan()).collect();
            let s = Matrix::from_fn(e.len(), e.len(), |a, b| correction.innovation_cov[(e[a], e[b])]);
            let e = Vector::from_fn(e.len(), |a, _| correction.innovation[e[a]]);
            let square = if e.is_empty() { 0.0 } else { e.dot(&(s.clone().try_inverse().unwrap() * &e)) };
            likelihoods[j] = (-0.5 * square).exp() / (2.0 * std::f64::consts::PI * s).determinant().sqrt();
        }
        let sum: f64 = (0..2).map(|j| before[j] * likelihoods[j]).sum();
        self.probability = [0, 1].map(|j| before[j] * likelihoods[j] / sum);
        let new: Vec<Gaussian> = self.filters.iter().map(|f| f.belief().gaussian().into_owned()).collect();
        let (mean, cov) = mixture(&self.probability, &new);
        (mean, cov, before)
    }
}

fn mixture(weights: &[f64], parts: &[Gaussian]) -> (Vector, Matrix) {
    let mean: Vector = weights.iter().zip(parts).map(|(w, part)| &part.mean * *w).sum();
    let cov = weights.iter().zip(parts).map(|(w, part)| {
        let d = &part.mean - &mean;
        (&part.cov + &d * d.transpose()) * *w
    });
    (mean.clone(), cov.sum())
}

#[test]
fn it_is_that_of_the_book() {
    for kind in [FilterKind::EKF, FilterKind::UKF] {
        let scenario = scenario(kind, 0.3);
        let record = simulate(&scenario).with_gaps(|sensor, k| k % 11 == 0 && k % 2 == sensor);
        let mut run = Run::on_record(&scenario, record.clone().into()).unwrap();
        run.finish();
        let estimates = &run.estimates()[0];
        let mut book = Book::new(&scenario);
        let mut most = 0.0_f64;
        for k in 1..record.len() {
            let measured: Vec<f64> = (0..2).map(|sensor| record.measured(sensor)[k]).collect();
            let (mean, cov, _) = book.step([record.force(k - 1), record.force(k)], &measured);
            most = most.max(book.probability[1]);
            let std: Vec<f64> = (0..4).map(|i| cov[(i, i)].sqrt()).collect();
            for i in 0..4 {
                assert!((mean[i] - estimates.mean(k)[i]).abs() < 1e-6 * std[i], "{kind:?}, mean of {i} at {k}");
                for j in 0..4 {
                    let error = (cov[(i, j)] - estimates.cov(k)[4 * i + j]).abs();
                    assert!(error < 1e-6 * std[i] * std[j], "{kind:?}, covariance of {i} and {j} at {k}");
                }
            }
        }
        assert!(most > 0.9, "{kind:?}: the parameters never walked: {most}");
    }
}

/// A walk of nothing is no second model.
#[test]
fn without_a_walk_both_are_one() {
    for kind in KINDS {
        let run = |walk: f64| {
            let mut run = Run::new(&scenario(kind, walk)).unwrap();
            run.finish();
            assert!(run.estimates()[0].stop().is_none(), "{kind:?}");
            run
        };
        let (alone, bank) = (run(0.0), run(1e-12));
        let [alone, bank] = [&alone.estimates()[0], &bank.estimates()[0]];
        for k in 0..alone.len() {
            for i in 0..4 {
                let std = alone.cov(k)[5 * i].sqrt();
                assert!((alone.mean(k)[i] - bank.mean(k)[i]).abs() < 1e-4 * std, "{kind:?}, {i} at {k}");
                assert!((bank.cov(k)[5 * i].sqrt() / std - 1.0).abs() < 1e-4, "{kind:?}, {i} at {k}");
            }
        }
    }
}

/// A bank finds a sudden loss, and its band is right before and after it.
#[test]
fn a_sudden_loss_is_found_and_the_band_is_right() {
    let mut good = 0;
    for seed in 300..320 {
        let scenario = Scenario { seed, ..scenario(FilterKind::EKF, 0.2) };
        let mut run = Run::new(&scenario).unwrap();
        run.finish();
        let estimates = &run.estimates()[0];
        let jumps: Vec<usize> = estimates.jumps().filter(|&k| k > 100).collect();
        assert!(jumps.first().is_some_and(|k| (1000..1100).contains(k)), "seed {seed}: {jumps:?}");
        let diagnostics = Diagnostics::new(estimates, run.record());
        let diagnosis = Diagnosis::new(&diagnostics, estimates, run.record(), None).unwrap();
        good += usize::from(
            diagnosis
                .verdict
                .is_some_and(|verdict| matches!(verdict.kind, VerdictKind::Consistent | VerdictKind::Recovered)),
        );
    }
    assert!(good >= 18, "{good} of 20");
}

#[test]
fn filters_that_cannot_mix_are_refused() {
    let told = |filter: &str| {
        Scenario::from_toml(&format!("[[filters]]\nwalk = 0.1\n{filter}")).map_err(|error| error.to_string())
    };
    assert!(told("kind = \"ekf\"").is_ok());
    for filter in [
        "kind = \"enkf\"",
        "kind = \"kf\"",
        "jump = true",
        "robust = \"gate\"",
        "smoother = true",
        "adaptation.sensor_noise = true",
    ] {
        let error = told(filter).unwrap_err();
        assert!(error.contains("`filters[0].walk` is 0.1, but must be 0 for a filter that"), "{filter}: {error}");
    }
    assert!(told("kind = \"ukf\"\nguesses = 3").is_ok());
    let mut scenario = Scenario { duration: 5.0, ..scenario(FilterKind::EKF, 0.2) };
    scenario.filters[0].guesses = 3;
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    assert!(run.estimates()[0].stop().is_none());
}
