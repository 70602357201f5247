//! Rules that every plant keeps.

use super::{ALL, Visitor, visit};
use crate::PlantKind;
use crate::mathematics::integrate::{Integrals, exponential_integrals};
use crate::mathematics::kernel::gaussian::{Matrix, Vector};
use crate::mathematics::kernel::model::Model;
use crate::mathematics::kernel::propagation::runge_kutta;
use crate::mathematics::linalg;

/// A state of ordinary size: numbers between -1 and 1 times the usual.
fn state<P: Model<N>, const N: usize>(seed: usize) -> Vector<N> {
    Vector::<N>::from_fn(|i, _| {
        let channel = P::CHANNELS[i];
        let number = libm::sin(1.7 * (seed * N + i) as f64 + 0.4);
        let size = if channel.is_parameter() { crate::Values::INITIAL_MEAN } else { crate::Values::INITIAL_STD };
        size[channel] * if channel.is_parameter() { 1.0 + 0.5 * number } else { number }
    })
}

/// Does the same with every plant, with and without decay.
fn with_each(visit: impl Fn(PlantKind, f64)) {
    for kind in ALL {
        [0.0, 0.02, 3.0].into_iter().for_each(|eta| visit(kind, eta));
    }
}

fn visit_kind<V: Visitor>(kind: PlantKind, eta: f64, visitor: V) -> V::Output {
    visit(kind, eta, visitor).expect("the plant has a kernel")
}

#[test]
fn jacobians_agree_with_differences() {
    struct Differences;
    impl Visitor for Differences {
        type Output = f64;

        fn visit<P: Model<N>, const N: usize>(self, model: P) -> f64 {
            let mut worst = 0.0_f64;
            for seed in 0..20 {
                let at = state::<P, N>(seed);
                let analytic = model.jacobian(&at);
                for j in 0..N {
                    let step = 1e-6 * at[j].abs().max(1e-3);
                    let [mut high, mut low] = [at; 2];
                    high[j] += step;
                    low[j] -= step;
                    let difference = (model.rate(&high, 2.0) - model.rate(&low, 2.0)) / (high[j] - low[j]);
                    let scale = analytic.column(j).amax().max(1.0);
                    worst = worst.max((difference - analytic.column(j)).amax() / scale);
                }
            }
            worst
        }
    }
    with_each(|kind, eta| {
        let error = visit_kind(kind, eta, Differences);
        assert!(error < 2e-6, "{kind:?}, η = {eta}: {error}");
    });
}

/// `Φ` and the mean after a step of local linearisation, by one exponential of all of A.
fn dense_step<P: Model<N>, const N: usize>(
    model: &P,
    at: &Vector<N>,
    force: f64,
    dt: f64,
) -> (Vector<N>, Matrix<N, N>) {
    let jacobian = model.jacobian(at);
    let dense = linalg::Matrix::from_fn(N, N, |i, j| jacobian[(i, j)]);
    let Integrals { transition, constant, .. } = exponential_integrals(&dense, dt);
    let integral = Matrix::<N, N>::from_fn(|i, j| constant[(i, j)]);
    (at + integral * model.rate(at, force), Matrix::from_fn(|i, j| transition[(i, j)]))
}

#[test]
fn steps_with_shortcuts_are_those_of_the_definition() {
    struct Steps(f64);
    impl Visitor for Steps {
        type Output = [f64; 3];

        fn visit<P: Model<N>, const N: usize>(self, model: P) -> [f64; 3] {
            let dt = self.0;
            let mut worst = [0.0_f64; 3];
            for seed in 0..20 {
                let mut at = state::<P, N>(seed);
                if seed >= 18 {
                    // A ratio of damping or a stiffness of zero is no special case.
                    at[P::MOTION + seed - 18] = 0.0;
                }
                let (mean, transition) = model.linearised_step(&at, 3.0, dt);
                let (general, exp) = dense_step(&model, &at, 3.0, dt);
                let stages = runge_kutta(&at, dt, |y| model.rate(y, 3.0));
                let step = model.runge_kutta_step(&at, 3.0, dt);
                let errors = [
                    (transition - exp).amax() / exp.amax(),
                    (mean - general).amax() / general.amax(),
                    (step - stages).amax() / stages.amax(),
                ];
                worst = std::array::from_fn(|i| worst[i].max(errors[i]));
            }
            worst
        }
    }
    with_each(|kind, eta| {
        for dt in [1e-6, 1e-4, 0.001, 0.01, 0.03, 0.1, 0.3, 1.0] {
            let errors = visit_kind(kind, eta, Steps(dt));
            // Over a second the dense exponential, doubled a dozen times, is itself off by 2e-11, as numbers of eighty digits
            // show; the chains' own error is below 1e-13.
            let rounding = if dt < 1.0 { 1e-12 } else { 5e-11 };
            assert!(errors.iter().all(|e| *e < rounding), "{kind:?}, η = {eta}, dt = {dt}: {errors:?}");
        }
    });
}

#[test]
fn states_without_bounds_give_no_number_and_no_endless_loop() {
    struct Overflows(f64);
    impl Visitor for Overflows {
        type Output = bool;

        fn visit<P: Model<N>, const N: usize>(self, model: P) -> bool {
            let state = Vector::<N>::from_fn(|i, _| if i == P::MOTION { self.0 } else { 1.0 });
            let (mean, transition) = model.linearised_step(&state, 3.0, 10.0);
            !(mean.sum() + transition.sum()).is_finite()
        }
    }
    for kind in ALL {
        for eta in [0.0, 0.02, 3.0] {
            for number in [f64::NAN, f64::INFINITY, 1e307, -1e200] {
                assert_eq!(visit(kind, eta, Overflows(number)), Some(true), "{kind:?}, η = {eta}, {number}");
            }
        }
    }
}

#[test]
fn a_linear_plants_exact_response_is_that_of_many_small_steps() {
    struct Response;
    impl Visitor for Response {
        type Output = Option<f64>;

        fn visit<P: Model<N>, const N: usize>(self, model: P) -> Option<f64> {
            let at = state::<P, N>(3);
            let exact = at + model.exact_integral(&at, 0.05)? * model.rate(&at, 2.0);
            let small = (0..500).fold(at, |y, _| runge_kutta(&y, 1e-4, |y| model.rate(y, 2.0)));
            Some((exact - small).amax() / small.amax())
        }
    }
    for kind in ALL {
        let error = visit(kind, 0.0, Response).expect("the plant has a kernel");
        let linear = kind.info().is_linear;
        assert_eq!(error.is_some(), linear, "{kind:?}");
        assert!(error.is_none_or(|e| e < 1e-12), "{kind:?}: {error:?}");
    }
}
