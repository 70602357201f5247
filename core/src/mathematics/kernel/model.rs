//! A plant as a filter models it: the rate of change, its Jacobian, and the readings of sensors.

use crate::Channel;
use crate::mathematics::kernel::gaussian::{Matrix, Vector};
use crate::mathematics::kernel::propagation::{exp_and_integral, runge_kutta};
use crate::mathematics::model::Reading;

/// The place of a sensor's quantity in the model.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Output {
    /// A component of the state.
    State(usize),
    /// The rate of change of a component of the state.
    Rate(usize),
}

impl Output {
    /// The place of a reading, if it is one component of the state or its rate.
    pub fn of(reading: &Reading) -> Option<Self> {
        reading.component().map(Self::State).or_else(|| reading.rate_component().map(Self::Rate))
    }
}

/// A plant with an N-component augmented state `y` (motion and parameters) and rate `ẏ = g(y, f)`.
pub trait Model<const N: usize>: Clone + Send + Sync + 'static {
    /// The channel of each component: motion first, then the parameters.
    const CHANNELS: [Channel; N];
    /// The number of components that move. Those after them are parameters: each is constant or decays in proportion to
    /// itself, independent of the others.
    const MOTION: usize;
    /// Whether a kernel moves sigma points at least a third faster than the engine.
    const MOVES_POINTS: bool = true;

    /// `g(y, f)`, with the force over mass `force` \[m/s²\]; each component in its unit per second.
    fn rate(&self, state: &Vector<N>, force: f64) -> Vector<N>;

    /// `A = ∂g/∂y`, N × N. The force enters additively, so it does not appear.
    fn jacobian(&self, state: &Vector<N>) -> Matrix<N, N>;

    /// The rate at which the parameters decay \[1/s\].
    fn eta(&self) -> f64;

    /// One step of local linearisation: the state after `dt` \[s\] and its transition matrix.
    ///
    /// ```text
    /// A = ∂g/∂y,  Φ = exp(A dt),  y⁻ = y + dt φ₁(A dt) g(y, f)
    /// ```
    ///
    /// Source: Huang and Yuen (2023), *Bayesian Real-Time System Identification*, with `A⁻¹(exp(A dt) - I)` read as the
    /// entire function `dt φ₁(A dt)`, which a singular `A` does not trouble.
    fn linearised_step(&self, state: &Vector<N>, force: f64, dt: f64) -> (Vector<N>, Matrix<N, N>) {
        let (transition, integral) = exp_and_integral(&self.jacobian(state), dt);
        (state + integral * self.rate(state, force), transition)
    }

    /// One classical fourth-order Runge-Kutta step over `dt` \[s\] with the force held.
    fn runge_kutta_step(&self, state: &Vector<N>, force: f64, dt: f64) -> Vector<N> {
        runge_kutta(state, dt, |y| self.rate(y, force))
    }

    /// [`Self::runge_kutta_step`] of several states, one a row. A plant with a step without branches can override this
    /// and step all states at once, component by component: the compiler makes vector instructions of that.
    #[inline]
    fn runge_kutta_steps<const B: usize>(&self, states: &Matrix<B, N>, force: f64, dt: f64) -> Matrix<B, N> {
        one_by_one(states, |state| self.runge_kutta_step(&state, force, dt))
    }

    /// `Γ = dt φ₁(A dt)` for a plant that is linear as long as its parameters are held: then `y + Γ g(y, f)` is its
    /// exact response. The truth of such a plant has only rounding errors.
    fn exact_integral(&self, _state: &Vector<N>, _dt: f64) -> Option<Matrix<N, N>> {
        None
    }
}

/// The states after `step`, one a row.
#[inline]
pub(crate) fn one_by_one<const N: usize, const B: usize>(
    states: &Matrix<B, N>,
    step: impl Fn(Vector<N>) -> Vector<N>,
) -> Matrix<B, N> {
    let mut images = *states;
    for row in 0..B {
        images.set_row(row, &step(states.row(row).transpose()).transpose());
    }
    images
}
