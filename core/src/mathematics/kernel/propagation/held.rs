//! Steps of plants with parameters that are constant or decay: only the motion has an exponential.

use super::chain::{Chain, ChainResponse};
use super::{ImpulseResponse, exp_and_integral, shared_exp_and_integral};
use crate::mathematics::kernel::gaussian::{Matrix, Vector};

/// One step of local linearisation of an oscillator `[x, v, parameters]` with parameters that decay at the rate `eta`:
/// the state after `dt` \[s\] and its transition matrix, from `A` and `g` at its beginning. All of it follows from the
/// impulse response of `A`'s second row:
///
/// ```text
/// Φ = [1 + a q, h, q c; a h, 1 + a q + b h, h c; 0, 0, I],  A's second row [a, b, c],  η = 0
/// ```
#[inline]
pub(crate) fn oscillator_step<const N: usize>(
    state: &Vector<N>,
    rate: &Vector<N>,
    jacobian: &Matrix<N, N>,
    eta: f64,
    dt: f64,
) -> (Vector<N>, Matrix<N, N>) {
    if eta != 0.0 {
        return decaying_oscillator_step(state, rate, jacobian, eta, dt);
    }
    let (a, b) = (jacobian[(1, 0)], jacobian[(1, 1)]);
    let response = ImpulseResponse::new(a, b, dt);
    let ImpulseResponse { value: h, integral: q } = response;
    let mut mean = *state;
    [mean[0], mean[1]] = response.advance(a, b, [state[0], state[1]], rate[1]);
    let mut transition = Matrix::identity();
    transition[(0, 0)] = 1.0 + a * q;
    transition[(0, 1)] = h;
    transition[(1, 0)] = a * h;
    transition[(1, 1)] = 1.0 + a * q + b * h;
    for j in 2..N {
        transition[(0, j)] = q * jacobian[(1, j)];
        transition[(1, j)] = h * jacobian[(1, j)];
    }
    (mean, transition)
}

/// [`oscillator_step`] with a decay, in a function of its own, so that the step without one stays short.
///
/// ```text
/// Φ = [1 + a q, h, r c; a h, 1 + a q + b h, r' c; 0, 0, exp(-η dt) I],  r = ∫₀^dt h(dt - s) exp(-η s) ds,  r' = h - η r
/// ```
///
/// The parameters' share of the acceleration, `c p`, decays with them; the rest of it is held.
#[inline(never)]
fn decaying_oscillator_step<const N: usize>(
    state: &Vector<N>,
    rate: &Vector<N>,
    jacobian: &Matrix<N, N>,
    eta: f64,
    dt: f64,
) -> (Vector<N>, Matrix<N, N>) {
    let (a, b) = (jacobian[(1, 0)], jacobian[(1, 1)]);
    let ChainResponse { value, integral, decaying } = Chain { stiffness: [-a], damping: -b }.response(eta, dt);
    let (h, q, r) = (value[(0, 0)], integral[(0, 0)], decaying[(0, 0)]);
    let (speed, decay) = (h - eta * r, libm::exp(-eta * dt));
    let share: f64 = (2..N).map(|j| jacobian[(1, j)] * state[j]).sum();
    let mut mean = state * decay;
    [mean[0], mean[1]] = ImpulseResponse { value: h, integral: q }.advance(a, b, [state[0], state[1]], rate[1] - share);
    mean[0] += r * share;
    mean[1] += speed * share;
    let mut transition = Matrix::identity() * decay;
    transition[(0, 0)] = 1.0 + a * q;
    transition[(0, 1)] = h;
    transition[(1, 0)] = a * h;
    transition[(1, 1)] = 1.0 + a * q + b * h;
    for j in 2..N {
        transition[(0, j)] = r * jacobian[(1, j)];
        transition[(1, j)] = speed * jacobian[(1, j)];
    }
    (mean, transition)
}

/// One step of local linearisation of a plant with M moving components and parameters p that decay at the rate `eta`:
/// the state after `dt` \[s\] and its transition matrix, from `A` and `g` at its beginning.
///
/// ```text
/// A = [F, C; 0, -η I],  Φ = [exp(F dt), G C; 0, exp(-η dt) I],  Γ = dt φ₁(F dt)
/// G = ∫₀^dt exp(F (dt - s)) exp(-η s) ds = exp(-η dt) dt φ₁((F + η I) dt),  y⁻ = y + Γ (g - C p) + G C p
/// ```
#[inline]
pub(crate) fn held_parameters_step<const M: usize, const N: usize>(
    state: &Vector<N>,
    rate: &Vector<N>,
    jacobian: &Matrix<N, N>,
    eta: f64,
    dt: f64,
) -> (Vector<N>, Matrix<N, N>) {
    if eta != 0.0 {
        return decaying_parameters_step::<M, N>(state, rate, jacobian, eta, dt);
    }
    let motion: Matrix<M, M> = jacobian.fixed_view::<M, M>(0, 0).into_owned();
    let (exp, integral) = exp_and_integral(&motion, dt);
    let mut mean = *state;
    let mut transition = Matrix::<N, N>::identity();
    transition.fixed_view_mut::<M, M>(0, 0).copy_from(&exp);
    for i in 0..M {
        mean[i] += (0..M).map(|k| integral[(i, k)] * rate[k]).sum::<f64>();
        for j in M..N {
            transition[(i, j)] = (0..M).map(|k| integral[(i, k)] * jacobian[(k, j)]).sum();
        }
    }
    (mean, transition)
}

/// [`held_parameters_step`] with a decay, in a function of its own, so that the step without one stays short.
#[inline(never)]
fn decaying_parameters_step<const M: usize, const N: usize>(
    state: &Vector<N>,
    rate: &Vector<N>,
    jacobian: &Matrix<N, N>,
    eta: f64,
    dt: f64,
) -> (Vector<N>, Matrix<N, N>) {
    if eta * dt > 1.0 {
        // With so fast a decay, exp((F + η I) dt) may overflow.
        let (transition, integral) = shared_exp_and_integral(jacobian, dt);
        return (state + integral * rate, transition);
    }
    let motion: Matrix<M, M> = jacobian.fixed_view::<M, M>(0, 0).into_owned();
    let decay = libm::exp(-eta * dt);
    let (exp, integral) = exp_and_integral(&motion, dt);
    let (_, growing) = exp_and_integral(&(motion + Matrix::<M, M>::identity() * eta), dt);
    let decaying = growing * decay;
    let mut mean = state * decay;
    let mut transition = Matrix::<N, N>::identity() * decay;
    transition.fixed_view_mut::<M, M>(0, 0).copy_from(&exp);
    let share: [f64; M] = std::array::from_fn(|k| (M..N).map(|j| jacobian[(k, j)] * state[j]).sum());
    for i in 0..M {
        mean[i] = state[i];
        for k in 0..M {
            mean[i] += integral[(i, k)] * (rate[k] - share[k]) + decaying[(i, k)] * share[k];
        }
        for j in M..N {
            transition[(i, j)] = (0..M).map(|k| decaying[(i, k)] * jacobian[(k, j)]).sum();
        }
    }
    (mean, transition)
}

/// [`runge_kutta`](super::runge_kutta) of a state `[motion, parameters]` with constant parameters: its motion after the
/// step, from the motion's rate.
#[inline]
pub(crate) fn held_runge_kutta<const M: usize, const N: usize>(
    state: [f64; N],
    dt: f64,
    rate: impl Fn([f64; N]) -> [f64; M],
) -> [f64; M] {
    let half = 0.5 * dt;
    let moved = |rate: [f64; M], dt: f64| {
        let mut stage = state;
        for i in 0..M {
            stage[i] += rate[i] * dt;
        }
        stage
    };
    let k1 = rate(state);
    let k2 = rate(moved(k1, half));
    let k3 = rate(moved(k2, half));
    let k4 = rate(moved(k3, dt));
    std::array::from_fn(|i| state[i] + (k1[i] + (k2[i] + k3[i]) * 2.0 + k4[i]) * (dt / 6.0))
}

/// Several states after a step, one a row. `motion` gives the first M components; the others are held. If `motion` has
/// no branches, the compiler takes two rows at a time.
#[inline]
pub(crate) fn held_rows<const M: usize, const N: usize, const B: usize>(
    states: &Matrix<B, N>,
    motion: impl Fn([f64; N]) -> [f64; M],
) -> Matrix<B, N> {
    let columns = states.data.0;
    let mut moved = [[0.0; B]; M];
    for row in 0..B {
        let image = motion(std::array::from_fn(|i| columns[i][row]));
        for i in 0..M {
            moved[i][row] = image[i];
        }
    }
    let mut images = columns;
    images[..M].copy_from_slice(&moved);
    Matrix::from(images)
}
