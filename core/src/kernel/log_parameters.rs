//! Positive parameters as their logarithms.

use crate::Channel;
use crate::kernel::gaussian::{Gaussian, Matrix, Vector};
use crate::kernel::model::{Model, one_by_one};
use crate::kernel::propagation::{runge_kutta, shared_exp_and_integral};

/// A plant with, if `on`, `ln θ` in its state in place of every parameter θ that cannot be negative
/// ([`Channel::is_positive`]), so that no estimate is.
///
/// ```text
/// d(ln θ)/dt = θ̇ / θ,  ∂g/∂(ln θ) = θ ∂g/∂θ
/// ```
///
/// Beliefs are given and reported in the channels' own units, to first order: the mean is `exp` of the logarithm's, the
/// standard deviation θ times the logarithm's.
#[derive(Clone, Copy, Debug)]
pub struct LogParameters<P> {
    /// The plant itself.
    pub plant: P,
    /// Whether there are logarithms. This is a run-time choice, not a type: filters over every plant are most of the
    /// program, and a type would double them.
    pub on: bool,
}

impl<P> LogParameters<P> {
    /// The plant's own state, and for each component its derivative by the one here.
    fn plain<const N: usize>(state: &Vector<N>) -> (Vector<N>, Vector<N>)
    where
        P: Model<N>,
    {
        let mut plain = *state;
        let mut scale = Vector::repeat(1.0);
        for i in P::MOTION..N {
            if P::CHANNELS[i].is_positive() {
                plain[i] = libm::exp(state[i]);
                scale[i] = plain[i];
            }
        }
        (plain, scale)
    }
}

impl<P> LogParameters<P> {
    /// [`Model::linearised_step`] with logarithms, in a function of its own, so that the step without them stays short.
    #[inline(never)]
    fn log_step<const N: usize>(&self, state: &Vector<N>, force: f64, dt: f64) -> (Vector<N>, Matrix<N, N>)
    where
        P: Model<N>,
    {
        if self.plant.eta() != 0.0 {
            let (transition, integral) = shared_exp_and_integral(&self.jacobian(state), dt);
            return (state + integral * self.rate(state, force), transition);
        }
        let (plain, scale) = Self::plain(state);
        let (mut mean, mut transition) = self.plant.linearised_step(&plain, force, dt);
        for j in P::MOTION..N {
            mean[j] = state[j];
            for i in 0..P::MOTION {
                transition[(i, j)] *= scale[j];
            }
        }
        (mean, transition)
    }
}

impl<P: Model<N>, const N: usize> Model<N> for LogParameters<P> {
    const CHANNELS: [Channel; N] = P::CHANNELS;
    const MOTION: usize = P::MOTION;

    fn eta(&self) -> f64 {
        self.plant.eta()
    }

    #[inline]
    fn rate(&self, state: &Vector<N>, force: f64) -> Vector<N> {
        if !self.on {
            return self.plant.rate(state, force);
        }
        let (plain, scale) = Self::plain(state);
        self.plant.rate(&plain, force).component_div(&scale)
    }

    fn jacobian(&self, state: &Vector<N>) -> Matrix<N, N> {
        if !self.on {
            return self.plant.jacobian(state);
        }
        let (plain, scale) = Self::plain(state);
        let mut jacobian = self.plant.jacobian(&plain);
        for j in P::MOTION..N {
            for i in 0..P::MOTION {
                jacobian[(i, j)] *= scale[j];
            }
            if P::CHANNELS[j].is_positive() {
                // -η θ / θ does not depend on θ.
                jacobian[(j, j)] = 0.0;
            }
        }
        jacobian
    }

    #[inline]
    fn linearised_step(&self, state: &Vector<N>, force: f64, dt: f64) -> (Vector<N>, Matrix<N, N>) {
        if self.on { self.log_step(state, force, dt) } else { self.plant.linearised_step(state, force, dt) }
    }

    #[inline]
    fn runge_kutta_step(&self, state: &Vector<N>, force: f64, dt: f64) -> Vector<N> {
        if !self.on {
            return self.plant.runge_kutta_step(state, force, dt);
        }
        if self.eta() != 0.0 {
            return runge_kutta(state, dt, |y| self.rate(y, force));
        }
        let (plain, _) = Self::plain(state);
        let mut next = self.plant.runge_kutta_step(&plain, force, dt);
        for j in P::MOTION..N {
            next[j] = state[j];
        }
        next
    }

    #[inline]
    fn runge_kutta_steps<const B: usize>(&self, states: &Matrix<B, N>, force: f64, dt: f64) -> Matrix<B, N> {
        if !self.on {
            return self.plant.runge_kutta_steps(states, force, dt);
        }
        one_by_one(states, |state| self.runge_kutta_step(&state, force, dt))
    }

    fn in_units(&self) -> bool {
        !self.on
    }

    fn to_units(&self, belief: &Gaussian<N>) -> (Gaussian<N>, Vector<N>) {
        if !self.on {
            return self.plant.to_units(belief);
        }
        let (mean, scale) = Self::plain(&belief.mean);
        let cov = Matrix::from_fn(|i, j| belief.cov[(i, j)] * (scale[i] * scale[j]));
        (Gaussian { mean, cov }, scale)
    }

    fn to_state(&self, values: &Vector<N>) -> (Vector<N>, Vector<N>) {
        if !self.on {
            return self.plant.to_state(values);
        }
        let mut state = *values;
        let mut unit = Vector::repeat(1.0);
        for i in P::MOTION..N {
            if P::CHANNELS[i].is_positive() {
                state[i] = libm::log(values[i]);
                unit[i] = 1.0 / values[i];
            }
        }
        (state, unit)
    }
}
