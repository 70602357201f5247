//! Filters as model classes: the probability of each, given the readings.

use kalmanscope_core::{
    Channel, Evidence, FilterKind, FilterSettings, ModelClasses, Run, Scenario, Signal, Source, Study, Values, Wanted,
};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

use crate::run::finished;

fn known([frequency, damping]: [f64; 2]) -> FilterSettings {
    FilterSettings {
        kind: FilterKind::KF,
        initial_mean: Values::ZERO.with([(Channel::NATURAL_FREQUENCY, frequency), (Channel::DAMPING_RATIO, damping)]),
        initial_std: Values::ZERO.with([(Channel::DISPLACEMENT, 0.3), (Channel::VELOCITY, 1.0)]),
        process_std: Values::ZERO.with([(Channel::DISPLACEMENT, 1e-4), (Channel::VELOCITY, 0.02)]),
        fading: 1.0,
        ..Scenario::default().filters[0].clone()
    }
}

/// The logarithm of the density of all readings of a run but the first: they are jointly normal.
fn log_density(run: &Run, [frequency, damping]: [f64; 2], sensor_std: [f64; 2]) -> f64 {
    let (record, dt, samples) = (run.record(), run.record().dt(), run.record().len());
    let decay = (-damping * frequency * dt).exp();
    let wd = frequency * (1.0 - damping * damping).sqrt();
    let h = decay * (wd * dt).sin() / wd;
    let dh = decay * (wd * dt).cos() - damping * frequency * h;
    let transition = Matrix2::new(dh + 2.0 * damping * frequency * h, h, -frequency * frequency * h, dh);
    let input = Vector2::new((1.0 - transition[(0, 0)]) / (frequency * frequency), h);
    let noise = Matrix2::from_diagonal(&Vector2::new(1e-4_f64.powi(2), 0.02_f64.powi(2)));
    let mut means = vec![Vector2::zeros()];
    // The covariance of the states at two samples.
    let mut covs = vec![vec![Matrix2::from_diagonal(&Vector2::new(0.09, 1.0))]];
    for k in 1..samples {
        means.push(transition * means[k - 1] + input * record.force(k - 1));
        let mut row: Vec<Matrix2<f64>> = (0..k).map(|j| transition * covs[k - 1][j]).collect();
        row.push(transition * covs[k - 1][k - 1] * transition.transpose() + noise);
        for (j, block) in row.iter().enumerate().take(k) {
            covs[j].push(block.transpose());
        }
        covs.push(row);
    }
    let size = 2 * (samples - 1);
    let readings = DVector::from_fn(size, |i, _| record.measured(i % 2)[1 + i / 2] - means[1 + i / 2][i % 2]);
    let cov = DMatrix::from_fn(size, size, |i, j| {
        covs[1 + i / 2][1 + j / 2][(i % 2, j % 2)] + if i == j { sensor_std[i % 2].powi(2) } else { 0.0 }
    });
    let factor = cov.cholesky().expect("it is definite");
    let square = readings.dot(&factor.solve(&readings));
    let ln_determinant = 2.0 * factor.l().diagonal().map(f64::ln).sum();
    -0.5 * (square + ln_determinant + size as f64 * std::f64::consts::TAU.ln())
}

#[test]
fn the_evidence_of_linear_models_is_the_density_of_the_readings() {
    let models = [[6.0, 0.05], [6.3, 0.05], [6.0, 0.2]];
    let mut scenario = Scenario { duration: 0.6, filters: models.map(known).to_vec(), ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, Signal::Constant(6.0));
    let run = finished(&scenario);
    let std = [scenario.sensors[0].noise_std, scenario.sensors[1].noise_std];
    let exact = models.map(|model| log_density(&run, model, std));
    let evidence: Vec<f64> = run.estimates().iter().map(|of| Evidence::new(of).at(60).expect("it is there")).collect();
    for (found, exact) in evidence.iter().zip(exact) {
        assert!((found - exact).abs() < 1e-9 * exact.abs(), "{found} {exact}");
    }
    let [found, exact] = [ModelClasses::new(evidence), ModelClasses::new(exact)];
    assert!(found.probabilities().iter().all(|p| (1e-6..0.999_999).contains(p)), "a hard case: {found:?}");
    for (found, exact) in found.probabilities().iter().zip(exact.probabilities()) {
        assert!((found - exact).abs() < 1e-9, "{found} {exact}");
    }
}

#[test]
fn a_study_has_the_evidence_however_it_goes_on() {
    let scenario = Scenario { duration: 20.0, ..Scenario::default() };
    let whole = finished(&scenario);
    let all: Vec<Evidence> = whole.estimates().iter().map(Evidence::new).collect();
    for window in [usize::MAX, 200] {
        let mut study = Study::new(&scenario, Source::Simulated, window).expect("it is possible");
        study.want(Wanted::EVIDENCE);
        for done in [7, 500, 2001] {
            while !study.advance_to(done, &mut || false) {}
            let (run, evidence) = (study.run(), study.analysis().evidence());
            assert_eq!(evidence.len(), 2);
            for (evidence, all) in evidence.iter().zip(&all) {
                let forgotten = run.record().forgotten();
                assert_eq!(evidence.len(), run.len());
                assert!((0..run.len()).all(|k| evidence.at(k) == all.at(forgotten + k)));
                assert_eq!(evidence.at(run.len()), None);
            }
        }
    }
    let mut broken = scenario;
    broken.filters[0].fading = 1e30;
    let run = finished(&broken);
    let stop = run.estimates()[0].stop().expect("so much fading is too much").sample;
    let evidence = Evidence::new(&run.estimates()[0]);
    assert!(evidence.at(stop - 1).is_some_and(f64::is_finite));
    assert_eq!((evidence.at(stop), evidence.at(2000)), (Some(f64::NEG_INFINITY), Some(f64::NEG_INFINITY)));
}
