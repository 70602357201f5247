//! Masses one above the other, each storey a spring and a damper.

use crate::Channel;
use crate::mathematics::kernel::gaussian::{Matrix, Vector};
use crate::mathematics::kernel::model::Model;
use crate::mathematics::kernel::propagation::{chain_step, exp_and_integral};

/// A shear building of equal masses, shaken at its base, with every storey's stiffness and the damping unknown:
/// `y = [x₁ … x_m, v₁ … v_m, κ₁ … κ_m, c]`.
///
/// ```text
/// sᵢ = κᵢ (xᵢ - xᵢ₋₁) + c (vᵢ - vᵢ₋₁),  x₀ = v₀ = 0
/// ẍᵢ = f - sᵢ + sᵢ₊₁,  s_{m+1} = 0,  κ̇ᵢ = -η κᵢ,  ċ = -η c
/// ```
///
/// xᵢ is the displacement against the base and f the base's acceleration with the sign reversed, the same for every mass.
///
/// Source: Chopra (2017), *Dynamics of Structures*, sections 9.1 and 9.4.
#[derive(Clone, Copy, Debug)]
pub struct ShearChain<const MASSES: usize> {
    /// η, the rate at which the parameters decay \[1/s\].
    pub eta: f64,
}

const DISPLACEMENTS: [Channel; 4] =
    [Channel::DISPLACEMENT, Channel::displacement(1), Channel::displacement(2), Channel::displacement(3)];
const VELOCITIES: [Channel; 4] = [Channel::VELOCITY, Channel::velocity(1), Channel::velocity(2), Channel::velocity(3)];
const STIFFNESSES: [Channel; 4] =
    [Channel::stiffness(0), Channel::stiffness(1), Channel::stiffness(2), Channel::stiffness(3)];

/// The channels of a chain of `masses`, with `N = 3 masses + 1`.
const fn channels<const N: usize>(masses: usize) -> [Channel; N] {
    let mut channels = [Channel::STOREY_DAMPING; N];
    let mut i = 0;
    while i < masses {
        channels[i] = DISPLACEMENTS[i];
        channels[masses + i] = VELOCITIES[i];
        channels[2 * masses + i] = STIFFNESSES[i];
        i += 1;
    }
    channels
}

// N and the number of moving components follow from the number of masses, which const generics cannot say yet.
macro_rules! shear_chain {
    ($masses:literal, $motion:literal, $n:literal) => {
        impl Model<$n> for ShearChain<$masses> {
            const CHANNELS: [Channel; $n] = channels($masses);
            const MOTION: usize = $motion;
            const MOVES_POINTS: bool = false;

            fn eta(&self) -> f64 {
                self.eta
            }

            fn rate(&self, state: &Vector<$n>, force: f64) -> Vector<$n> {
                rate::<$masses, $n>(self.eta, state, force)
            }

            fn jacobian(&self, state: &Vector<$n>) -> Matrix<$n, $n> {
                jacobian::<$masses, $n>(self.eta, state)
            }

            fn linearised_step(&self, state: &Vector<$n>, force: f64, dt: f64) -> (Vector<$n>, Matrix<$n, $n>) {
                chain_step::<$masses, $n>(state, force, self.eta, dt)
            }

            fn exact_integral(&self, state: &Vector<$n>, dt: f64) -> Option<Matrix<$n, $n>> {
                let jacobian = self.jacobian(state);
                let (_, motion) = exp_and_integral(&jacobian.fixed_view::<$motion, $motion>(0, 0).into_owned(), dt);
                let mut integral = Matrix::<$n, $n>::identity() * dt;
                integral.fixed_view_mut::<$motion, $motion>(0, 0).copy_from(&motion);
                Some(integral)
            }
        }
    };
}
shear_chain!(2, 4, 7);
shear_chain!(3, 6, 10);
shear_chain!(4, 8, 13);

fn rate<const MASSES: usize, const N: usize>(eta: f64, state: &Vector<N>, force: f64) -> Vector<N> {
    let damping = state[3 * MASSES];
    let mut rate = state * -eta;
    let (mut below_x, mut below_v) = (0.0, 0.0);
    for i in 0..MASSES {
        let (x, v) = (state[i], state[MASSES + i]);
        let storey = state[2 * MASSES + i] * (x - below_x) + damping * (v - below_v);
        rate[i] = v;
        rate[MASSES + i] = force - storey;
        if i > 0 {
            rate[MASSES + i - 1] += storey;
        }
        (below_x, below_v) = (x, v);
    }
    rate
}

fn jacobian<const MASSES: usize, const N: usize>(eta: f64, state: &Vector<N>) -> Matrix<N, N> {
    let damping = state[3 * MASSES];
    let mut jacobian = Matrix::<N, N>::zeros();
    for parameter in 2 * MASSES..N {
        jacobian[(parameter, parameter)] = -eta;
    }
    for i in 0..MASSES {
        jacobian[(i, MASSES + i)] = 1.0;
        let stiffness = state[2 * MASSES + i];
        let below = i.checked_sub(1);
        let drift = state[i] - below.map_or(0.0, |b| state[b]);
        let drift_rate = state[MASSES + i] - below.map_or(0.0, |b| state[MASSES + b]);
        // The storey's force pulls the mass above it down and the one below it up.
        for (mass, sign) in [(Some(i), -1.0), (below, 1.0)] {
            let Some(row) = mass.map(|m| MASSES + m) else { continue };
            jacobian[(row, i)] += sign * stiffness;
            jacobian[(row, MASSES + i)] += sign * damping;
            if let Some(b) = below {
                jacobian[(row, b)] -= sign * stiffness;
                jacobian[(row, MASSES + b)] -= sign * damping;
            }
            jacobian[(row, 2 * MASSES + i)] = sign * drift;
            jacobian[(row, 3 * MASSES)] += sign * drift_rate;
        }
    }
    jacobian
}
