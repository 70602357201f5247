//! A Kalman filter of matrices of one's own, against the equations of a textbook.

use kalmanscope_core::filter::{Correction, Gaussian, Matrix, Vector};
use kalmanscope_core::{FilterError, KalmanFilter, MeasurementModel, SystemError};

fn some(rows: usize, columns: usize, seed: f64) -> Matrix {
    Matrix::from_fn(rows, columns, |i, j| libm::sin(seed + (3 * i + 5 * j * j) as f64))
}

fn covariance(n: usize, seed: f64) -> Matrix {
    let root = some(n, n, seed);
    (&root * root.transpose() + Matrix::identity(n, n) * 0.1) * 0.3
}

/// A, B, H, Q, R of three components, two inputs and three sensors.
fn system(are_correlated: bool) -> [Matrix; 5] {
    let r = covariance(3, 2.0);
    let r = if are_correlated { r } else { Matrix::from_diagonal(&r.diagonal()) };
    [some(3, 3, 0.1) * 0.5, some(3, 2, 0.7), some(3, 3, 1.3), covariance(3, 0.4) * 0.1, r]
}

fn initial() -> Gaussian {
    Gaussian { mean: Vector::from_column_slice(&[1.0, -2.0, 0.5]), cov: covariance(3, 3.0) }
}

fn filter(are_correlated: bool) -> KalmanFilter {
    let [a, b, h, q, r] = system(are_correlated);
    KalmanFilter::new(a, b, h, q, r, initial()).expect("the system is one")
}

fn readings(k: u32) -> [f64; 3] {
    [0, 1, 2].map(|i| if (k + i).is_multiple_of(5) && i > 0 { f64::NAN } else { libm::sin(f64::from(k * (i + 2))) })
}

#[test]
fn a_step_is_that_of_the_textbook() {
    for are_correlated in [false, true] {
        let [a, b, h, q, r] = system(are_correlated);
        let mut filter = filter(are_correlated);
        let Gaussian { mean: mut x, cov: mut p } = initial();
        let close = |one: &Matrix, other: &Matrix, what: &str| {
            assert!((one - other).amax() < 1e-12 * other.amax().max(1.0), "{what}: {one} {other}");
        };
        let vector = |vector: &Vector| Matrix::from_column_slice(vector.len(), 1, vector.as_slice());
        for k in 0..100 {
            let u = Vector::from_column_slice(&[libm::cos(f64::from(k)), 0.3]);
            x = &a * x + &b * &u;
            p = &a * p * a.transpose() + &q;
            let z = readings(k);
            filter.predict(u.as_slice()).expect("it is finite");
            close(&vector(&filter.belief.mean), &vector(&x), "prediction");
            filter.update(&z).expect("S is positive definite");
            close(&filter.prior.cov, &p, "P⁻");
            close(&vector(&filter.prior.mean), &vector(&x), "x⁻");
            let there: Vec<usize> = (0..3).filter(|&i| !z[i].is_nan()).collect();
            let some_h = h.select_rows(&there);
            let some_r = r.select_rows(&there).select_columns(&there);
            let e = Vector::from_fn(there.len(), |i, _| z[there[i]]) - &some_h * &x;
            let s = &some_h * &p * some_h.transpose() + some_r;
            let inverse = s.clone().try_inverse().expect("S is positive definite");
            let gain = &p * some_h.transpose() * &inverse;
            x += &gain * &e;
            p = (Matrix::identity(3, 3) - &gain * &some_h) * &p;
            close(&vector(&filter.belief.mean), &vector(&x), "mean");
            close(&filter.belief.cov, &p, "covariance");
            for (i, &sensor) in there.iter().enumerate() {
                assert!((filter.correction.innovation[sensor] - e[i]).abs() < 1e-12);
                assert!((filter.correction.gain.column(sensor) - gain.column(i)).amax() < 1e-12);
                for (j, &other) in there.iter().enumerate() {
                    assert!((filter.correction.innovation_cov[(sensor, other)] - s[(i, j)]).abs() < 1e-12);
                }
            }
            let Correction { innovation, gain, .. } = &filter.correction;
            let is_missing = |i: usize| innovation[i].is_nan() && gain.column(i).amax() == 0.0;
            assert!((0..3).all(|i| there.contains(&i) || is_missing(i)));
            let nis = e.dot(&(&inverse * &e));
            assert!((filter.correction.nis - nis).abs() < 1e-11 * nis.max(1.0));
            let ln_2_pi = libm::log(std::f64::consts::TAU);
            let likelihood = -0.5 * (nis + libm::log(s.determinant()) + there.len() as f64 * ln_2_pi);
            assert!((filter.correction.log_likelihood - likelihood).abs() < 1e-11 * likelihood.abs().max(1.0));
        }
    }
}

#[test]
fn an_update_without_a_reading_changes_nothing() {
    let mut filter = filter(true);
    filter.step(&[0.1, 0.2], &[0.3, 0.4, f64::NAN]).expect("it goes on");
    let before = filter.belief.clone();
    filter.update(&[f64::NAN; 3]).expect("it goes on");
    assert_eq!(filter.belief, before);
    let Correction { innovation, innovation_cov, gain, nis, log_likelihood, .. } = &filter.correction;
    assert!(nis.is_nan() && log_likelihood.is_nan() && gain.amax() == 0.0);
    assert!(innovation.iter().chain(innovation_cov).all(|x| x.is_nan()));
}

#[test]
fn a_function_that_is_linear_is_the_matrix() {
    let [a, b, h, q, r] = system(true);
    let function = |h: &Matrix| {
        let h = h.clone();
        MeasurementModel::function(move |state, readings| {
            for (i, reading) in readings.iter_mut().enumerate() {
                *reading = h.row(i).iter().zip(state).map(|(h, x)| h * x).sum();
            }
        })
    };
    let jacobian = h.clone();
    let with_jacobian = function(&h).with_jacobian(move |_, to| to.copy_from(&jacobian));
    let (a, b, q, r) = (&a, &b, &q, &r);
    let of = |model: MeasurementModel| {
        KalmanFilter::new(a.clone(), b.clone(), model, q.clone(), r.clone(), initial()).expect("the system is one")
    };
    let (mut linear, mut exact, mut differences) = (of(h.clone().into()), of(with_jacobian), of(function(&h)));
    for k in 0..50 {
        for filter in [&mut linear, &mut exact, &mut differences] {
            filter.step(&[0.5, -0.5], &readings(k)).expect("it goes on");
        }
        assert!((&linear.belief.mean - &exact.belief.mean).amax() < 1e-13);
        assert!((&linear.belief.mean - &differences.belief.mean).amax() < 1e-8, "{k}");
        assert!((&linear.belief.cov - &differences.belief.cov).amax() < 1e-8, "{k}");
    }
}

#[test]
fn differences_are_the_derivative_for_states_of_any_size() {
    let ones = || Matrix::identity(1, 1);
    for (at, std) in [(0.0_f64, 1e-6), (1e-7, 1e-6), (0.3, 0.1), (0.3, 0.0), (2e5, 1e-3), (0.0, 0.0)] {
        let frequency = 1.0 / (std + at).max(1e-3);
        let model = MeasurementModel::function(move |x, z| z[0] = 1.0 + libm::sin(frequency * x[0]));
        let initial = Gaussian::independent(Vector::repeat(1, at), &Vector::repeat(1, std));
        let mut filter =
            KalmanFilter::new(ones(), Matrix::zeros(1, 0), model, ones() * 0.0, ones(), initial).expect("it is one");
        filter.update(&[0.5]).expect("it goes on");
        let slope = frequency * libm::cos(frequency * at);
        let expected = std * std * slope / (1.0 + std * std * slope * slope);
        let gain = filter.correction.gain[(0, 0)];
        assert!((gain - expected).abs() <= 1e-5 * expected.abs(), "{at} ± {std}: {gain} {expected}");
    }
}

fn refused(change: impl FnOnce(&mut [Matrix; 5], &mut Gaussian)) -> String {
    let (mut matrices, mut start) = (system(true), initial());
    change(&mut matrices, &mut start);
    let [a, b, h, q, r] = matrices;
    KalmanFilter::new(a, b, h, q, r, start).err().expect("it is no system").to_string()
}

#[test]
fn a_matrix_of_another_shape_is_refused_with_both_shapes() {
    for (matrix, rows, columns, said) in [
        (0, 3, 2, "A is 3 × 2, but must be 3 × 3: a row and a column for each component of the state"),
        (1, 2, 2, "B is 2 × 2, but must be 3 × 2: a row for each component of the state, a column for each input"),
        (2, 3, 4, "H is 3 × 4, but must be 3 × 3: a row for each sensor, a column for each component of the state"),
        (3, 2, 2, "Q is 2 × 2, but must be 3 × 3: a row and a column for each component of the state"),
        (4, 2, 2, "R is 2 × 2, but must be 3 × 3: a row and a column for each sensor"),
    ] {
        assert_eq!(refused(|matrices, _| matrices[matrix] = Matrix::from_element(rows, columns, 0.1)), said);
    }
    let cov = refused(|_, start| start.cov = Matrix::zeros(2, 3));
    assert_eq!(cov, "P is 2 × 3, but must be 3 × 3: a row and a column for each component of the initial mean");
    let nothing = refused(|_, start| start.mean = Vector::zeros(0));
    assert_eq!(nothing, "the initial mean is empty, but a state must have a component");
    let function = MeasurementModel::function(|_, _| ());
    let [a, b, _, q, _] = system(true);
    let error = KalmanFilter::new(a, b, function, q, Matrix::zeros(2, 3), initial()).err();
    let why = "a row and a column for each sensor";
    assert_eq!(error, Some(SystemError::Shape { matrix: "R", found: (2, 3), needed: (2, 2), why }));
}

#[test]
fn numbers_that_are_not_finite_and_matrices_that_are_no_covariances_are_refused() {
    for (place, name) in ["A", "B", "H", "Q", "R"].into_iter().enumerate() {
        for value in [f64::NAN, f64::INFINITY] {
            let message = refused(|matrices, _| matrices[place][(2, 1)] = value);
            assert_eq!(message, format!("{name}[2, 1] is {value}, but must be a finite number"));
        }
    }
    let asymmetric = Matrix::from_row_slice(3, 3, &[1.0, 0.0, 0.0, 0.5, 1.0, 0.0, 0.0, 0.0, 1.0]);
    let negative = Matrix::from_diagonal(&Vector::from_column_slice(&[1.0, -1.0, 1.0]));
    for (message, said) in [
        (refused(|_, start| start.mean[1] = f64::NAN), "the initial mean[1] is NaN, but must be a finite number"),
        (refused(|all, _| all[3] = asymmetric), "Q must be symmetric, but Q[1, 0] is 0.5 and Q[0, 1] is 0"),
        (refused(|all, _| all[4] = negative), "R must be a covariance, but has a negative variance in some direction"),
    ] {
        assert_eq!(message, said);
    }
}

#[test]
fn a_step_that_is_refused_leaves_the_filter_as_it_was() {
    let mut filter = filter(false);
    filter.step(&[0.1, 0.2], &readings(1)).expect("it goes on");
    let before = filter.belief.clone();
    let message = |error: Result<(), SystemError>| error.expect_err("it is refused").to_string();
    let said = "the input has 1 numbers, but must have 2: a number for each column of B";
    assert_eq!(message(filter.predict(&[1.0])), said);
    assert_eq!(message(filter.predict(&[1.0, f64::NAN])), "the input[1] is NaN, but must be a finite number");
    let said = "the sample has 1 numbers, but must have 3: a number for each sensor, NaN where it has no reading";
    assert_eq!(message(filter.update(&[1.0])), said);
    assert_eq!(filter.update(&[0.0, f64::INFINITY, 0.0]), Err(FilterError::InfiniteMeasurement.into()));
    assert_eq!(filter.update(&[1e200, 0.0, 0.0]), Err(FilterError::ImpossibleMeasurement.into()));
    assert_eq!(filter.belief, before);
    assert!(filter.correction.nis.is_nan() && filter.correction.log_likelihood.is_nan());
    filter.update(&readings(2)).expect("it goes on");

    let [_, b, h, q, r] = system(true);
    let mut unstable =
        KalmanFilter::new(Matrix::identity(3, 3) * 1e200, b, h, q, r, initial()).expect("the system is one");
    assert_eq!(unstable.predict(&[0.0, 0.0]), Err(FilterError::NotFinite.into()));
    assert_eq!(unstable.belief.mean, initial().mean);
}

#[test]
fn what_a_function_writes_is_checked() {
    let of = |model: MeasurementModel| {
        let [a, b, _, q, r] = system(true);
        KalmanFilter::new(a, b, model, q, r, initial()).expect("the system is one")
    };
    let mut undefined = of(MeasurementModel::function(|_, readings| readings[2] = f64::NAN)
        .with_jacobian(|_, jacobian| jacobian[(2, 0)] = 1.0));
    let message = undefined.update(&[0.0; 3]).expect_err("it is refused").to_string();
    assert_eq!(message, "the measurement function[2] is NaN, but must be a finite number");
    let mut wide =
        of(MeasurementModel::function(|_, _| ()).with_jacobian(|_, jacobian| *jacobian = Matrix::zeros(3, 4)));
    let message = wide.update(&[0.0; 3]).expect_err("it is refused").to_string();
    assert!(message.starts_with("the Jacobian is 3 × 4, but must be 3 × 3"), "{message}");
    assert_eq!(wide.belief.mean, initial().mean);
}

#[test]
fn a_filter_can_be_sent_to_another_thread() {
    fn is_send(_: impl Send) {}
    is_send(filter(true));
}
