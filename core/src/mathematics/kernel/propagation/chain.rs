//! Steps of chains of masses: the response to an impulse on each mass gives all of the exponential.

use crate::mathematics::integrate::{INVERSE_FACTORIAL, doublings};
use crate::mathematics::kernel::gaussian::{Matrix, Vector};

/// A row of equal masses, each tied to the one before it by a spring and a damper, the first to the ground.
///
/// ```text
/// ẍ = f - K x - C ẋ,  K = Dᵀ diag(κ) D,  C = c Dᵀ D,  (D x)ᵢ = xᵢ - xᵢ₋₁,  x₀ = 0
/// ```
///
/// With one mass it is the oscillator.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Chain<const M: usize> {
    /// κ, the stiffness over mass of each spring \[1/s²\].
    pub(crate) stiffness: [f64; M],
    /// c, the damping over mass of every damper \[1/s\].
    pub(crate) damping: f64,
}

/// The response of a chain to a unit impulse on each mass, one a column, after a time t, and its integrals.
///
/// ```text
/// h'' = -K h - C h',  h(0) = 0,  h'(0) = I,  q = ∫₀ᵗ h(s) ds,  r = ∫₀ᵗ h(t - s) exp(-η s) ds
/// ```
#[derive(Clone, Copy, Debug)]
pub(crate) struct ChainResponse<const M: usize> {
    /// h \[s\], M × M.
    pub(crate) value: Matrix<M, M>,
    /// q \[s²\], M × M: the response to a constant.
    pub(crate) integral: Matrix<M, M>,
    /// r \[s²\], M × M: the response to a force that decays at the rate η; q where η is zero.
    pub(crate) decaying: Matrix<M, M>,
}

/// The parts of the transition, M × M each.
struct Parts<const M: usize> {
    /// `-q Dᵀ`
    drop_integral: Matrix<M, M>,
    /// `-h Dᵀ`
    drop_value: Matrix<M, M>,
    /// `I - q K`: displacements by displacements.
    displaced: Matrix<M, M>,
    /// `-h K`: velocities by displacements.
    pulled: Matrix<M, M>,
    /// `I - q K - h C`: velocities by velocities. Those of displacements by velocities are h.
    kept: Matrix<M, M>,
}

/// `-A Dᵀ`: the column before less the column itself.
#[inline]
fn drops<const M: usize>(a: &Matrix<M, M>) -> Matrix<M, M> {
    let mut drops = -a;
    for j in 1..M {
        for i in 0..M {
            drops[(i, j)] += a[(i, j - 1)];
        }
    }
    drops
}

/// `A D`: the column less the one after it.
#[inline]
fn rises<const M: usize>(a: &Matrix<M, M>) -> Matrix<M, M> {
    let mut rises = *a;
    for j in 1..M {
        for i in 0..M {
            rises[(i, j - 1)] -= a[(i, j)];
        }
    }
    rises
}

/// `A diag(s)`
#[inline]
fn scaled<const M: usize>(mut a: Matrix<M, M>, scale: &[f64; M]) -> Matrix<M, M> {
    for j in 0..M {
        for i in 0..M {
            a[(i, j)] *= scale[j];
        }
    }
    a
}

impl<const M: usize> Chain<M> {
    /// The response after `dt` \[s\] with the decay `eta` \[1/s\].
    ///
    /// A Taylor series over a step so short that its terms exhaust double precision, then doubled:
    ///
    /// ```text
    /// h = t Σ cₙ/(n+1)!,  q = t² Σ cₙ/(n+2)!,  cₙ₊₁ = -t cₙ C - t² cₙ₋₁ K,  c₀ = I
    /// r = t² Σ dₙ/(n+2)!,  dₙ₊₁ = cₙ₊₁ - η t dₙ
    /// ```
    ///
    /// Its length follows from the stiffness's square root, as a time scale does, and not from the norm of the matrix
    /// of the first-order equations: its rows have different units.
    #[inline]
    pub(crate) fn response(&self, eta: f64, dt: f64) -> ChainResponse<M> {
        let size = self.size(eta) * dt;
        match SERIES.iter().find(|(longest, _)| size <= *longest) {
            Some(&(_, terms)) => self.series(eta, dt, terms),
            // A step that is too long to be halved overflows, and the update reports it.
            None => self.doubled(eta, dt, doublings(size)),
        }
    }

    /// A bound on the rate at which terms grow: the positive root of `s² = ‖C‖ s + ‖K‖`, and η.
    #[inline]
    fn size(&self, eta: f64) -> f64 {
        // The sums of K's columns are below four times the largest stiffness, those of C below four times c.
        let ties = if M == 1 { 1.0 } else { 4.0 };
        let stiffness = ties * self.stiffness.iter().fold(0.0, |max: f64, k| max.max(k.abs()));
        let damping = ties * self.damping.abs();
        0.5 * (damping + (damping * damping + 4.0 * stiffness).sqrt()) + eta
    }

    #[inline]
    fn series(&self, eta: f64, t: f64, terms: usize) -> ChainResponse<M> {
        let (damping, stiffness, decay) = (self.damping * t, self.stiffness.map(|k| k * (t * t)), eta * t);
        let mut c = Matrix::<M, M>::identity();
        let mut before = Matrix::<M, M>::zeros();
        let mut d = c;
        let mut value = c;
        let mut integral = c * INVERSE_FACTORIAL[2];
        let mut decaying = integral;
        for n in 1..terms {
            (before, c) = (c, rises(&(drops(&c) * damping + scaled(drops(&before), &stiffness))));
            value += c * INVERSE_FACTORIAL[n + 1];
            integral += c * INVERSE_FACTORIAL[n + 2];
            if eta != 0.0 {
                d = c - d * decay;
                decaying += d * INVERSE_FACTORIAL[n + 2];
            }
        }
        integral *= t * t;
        let decaying = if eta == 0.0 { integral } else { decaying * (t * t) };
        ChainResponse { value: value * t, integral, decaying }
    }

    /// ```text
    /// q(2t) = 2 q - q K q + h h,  h(2t) = h - h K q + h' h,  r(2t) = r - q K r + h r' + exp(-η t) r
    /// ```
    #[inline(never)]
    fn doubled(&self, eta: f64, dt: f64, doublings: u32) -> ChainResponse<M> {
        let mut t = dt / libm::exp2(f64::from(doublings));
        let mut response = self.series(eta, t, LONGEST);
        for _ in 0..doublings {
            let Parts { displaced, pulled, kept, .. } = self.parts(&response);
            let ChainResponse { value: h, integral: q, decaying: r } = response;
            let integral = q + displaced * q + h * h;
            let decaying =
                if eta == 0.0 { integral } else { displaced * r + h * (h - r * eta) + r * libm::exp(-eta * t) };
            response = ChainResponse { value: h + pulled * q + kept * h, integral, decaying };
            t *= 2.0;
        }
        response
    }

    #[inline]
    fn parts(&self, response: &ChainResponse<M>) -> Parts<M> {
        let identity = Matrix::<M, M>::identity();
        let (drop_integral, drop_value) = (drops(&response.integral), drops(&response.value));
        let by_springs = scaled(drop_integral, &self.stiffness);
        Parts {
            drop_integral,
            drop_value,
            displaced: identity + rises(&by_springs),
            pulled: rises(&scaled(drop_value, &self.stiffness)),
            kept: identity + rises(&(by_springs + drop_value * self.damping)),
        }
    }
}

/// Limits the size s of a step with a number of terms, so that the first one left out, `sⁿ/(n+1)!`, is below rounding.
pub const SERIES: [(f64, usize); 5] = [(0.05, 8), (0.14, 10), (0.3, 12), (0.4, 13), (0.6, LONGEST)];
/// Limits the number of terms.
const LONGEST: usize = 15;

/// One step of local linearisation of a chain with parameters that decay at the rate `eta` \[1/s\]: the state `[x, v,
/// κ, c]` after `dt` \[s\] under the force over mass `force` \[m/s²\] on every mass, and its transition matrix.
///
/// ```text
/// Φ = [I - q K, h, -r Dᵀ diag(δ), -r Dᵀ δ'; -h K, I - q K - h C, -r' Dᵀ diag(δ), -r' Dᵀ δ'; 0, 0, exp(-η dt) I]
/// x⁻ = x + h v + q (C v + f) - r Dᵀ s,  v⁻ = v - q K v + h f - r' Dᵀ s,  r' = h - η r
/// ```
///
/// with the drifts `δ = D x`, `δ' = D v` of the springs and their forces `s = κ δ + c δ'`.
#[inline]
pub(crate) fn chain_step<const M: usize, const N: usize>(
    state: &Vector<N>,
    force: f64,
    eta: f64,
    dt: f64,
) -> (Vector<N>, Matrix<N, N>) {
    let chain = Chain::<M> { stiffness: std::array::from_fn(|i| state[2 * M + i]), damping: state[3 * M] };
    let response = chain.response(eta, dt);
    let Parts { drop_integral: drop_q, drop_value: drop_h, displaced, pulled, kept } = chain.parts(&response);
    let ChainResponse { value: h, integral: q, decaying: r } = response;
    let (drop_r, drop_speed, decay) = if eta == 0.0 {
        (drop_q, drop_h, 1.0)
    } else {
        let drop_r = drops(&r);
        (drop_r, drop_h - drop_r * eta, libm::exp(-eta * dt))
    };

    let mut mean = *state;
    let mut transition = Matrix::<N, N>::zeros();
    for parameter in 2 * M..N {
        mean[parameter] *= decay;
        transition[(parameter, parameter)] = decay;
    }
    for j in 0..M {
        let below = |i: usize| if j == 0 { 0.0 } else { state[i - 1] };
        let (velocity, stiffness) = (state[M + j], chain.stiffness[j]);
        let drift = state[j] - below(j);
        let drift_rate = velocity - below(M + j);
        let spring = stiffness * drift + chain.damping * drift_rate;
        for i in 0..M {
            transition[(i, j)] = displaced[(i, j)];
            transition[(M + i, j)] = pulled[(i, j)];
            transition[(i, M + j)] = h[(i, j)];
            transition[(M + i, M + j)] = kept[(i, j)];
            transition[(i, 2 * M + j)] = drop_r[(i, j)] * drift;
            transition[(M + i, 2 * M + j)] = drop_speed[(i, j)] * drift;
            transition[(i, 3 * M)] += drop_r[(i, j)] * drift_rate;
            transition[(M + i, 3 * M)] += drop_speed[(i, j)] * drift_rate;
            mean[i] += h[(i, j)] * velocity + q[(i, j)] * force - drop_q[(i, j)] * (chain.damping * drift_rate)
                + drop_r[(i, j)] * spring;
            mean[M + i] += h[(i, j)] * force + drop_q[(i, j)] * (stiffness * drift_rate) + drop_speed[(i, j)] * spring;
        }
    }
    (mean, transition)
}
