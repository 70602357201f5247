//! The linear oscillator's response to an impulse: [`ImpulseResponse`](kalmanscope_core::integrate::ImpulseResponse) in
//! lanes.

use kalmanscope_core::internals::{INVERSE_FACTORIAL, SERIES, doublings};

use crate::lane::{LANES, Lane, Mask};

/// The response h \[s\] and its integral q \[s²\].
#[derive(Clone, Copy)]
pub(crate) struct Impulse<T> {
    pub(crate) h: T,
    pub(crate) q: T,
}

/// Limits the size of a step with ten terms, and with fourteen.
const SHORT: f64 = 0.07;
const MIDDLING: f64 = 0.25;

impl<T: Lane> Impulse<T> {
    /// With stiffness `a` \[1/s²\] and damping `b` \[1/s\].
    #[inline(always)]
    pub(crate) fn new(a: T, b: T, dt: f64) -> Self {
        let size = a.abs().sqrt().max(b.abs()) * a.of(dt);
        let short = size.le(a.of(SHORT));
        if short.all() {
            return Self::series::<0, 10>(a, b, a.of(dt)).1;
        }
        T::apart(
            a.token(),
            #[inline(always)]
            || Self::long(a, b, size, short, dt),
        )
    }

    /// Where some lanes need more than ten terms, or a doubled step.
    #[inline(always)]
    fn long(a: T, b: T, size: T, short: T::Mask, dt: f64) -> Self {
        let mut times = [0; LANES];
        let mut steps = [dt; LANES];
        for (lane, size) in size.to_array().into_iter().enumerate() {
            // Not a number has no place here, but in the single filter's branch.
            if size <= MIDDLING {
                continue;
            }
            times[lane] = doublings(2.0 * size);
            steps[lane] = dt / libm::exp2(f64::from(times[lane]));
        }
        let (ten, fourteen) = Self::series::<10, 14>(a, b, T::from_array(a.token(), steps));
        let Self { mut h, mut q } = Self::either(short, ten, fourteen);
        let most = times.iter().copied().max().unwrap_or(0);
        let times = T::from_array(a.token(), times.map(f64::from));
        let two = a.of(2.0);
        for n in 0..most {
            let doubled = Self { h: h * (two + two * a * q + b * h), q: q * (two + a * q) + h * h };
            Self { h, q } = Self::either(a.of(f64::from(n)).lt(times), doubled, Self { h, q });
        }
        Self { h, q }
    }

    #[inline(always)]
    fn either(mask: T::Mask, yes: Self, no: Self) -> Self {
        Self { h: T::select(mask, yes.h, no.h), q: T::select(mask, yes.q, no.q) }
    }

    /// After `EARLY` terms of the series, and after `TERMS`.
    #[inline(always)]
    fn series<const EARLY: usize, const TERMS: usize>(a: T, b: T, dt: T) -> (Self, Self) {
        let zero = dt.of(0.0);
        let (alpha, beta) = (a * dt * dt, b * dt);
        let forward = beta * beta + dt.of(2.0) * alpha;
        let back = alpha * alpha;
        let mut c = [[dt.of(1.0), beta], [beta * beta + alpha, beta * forward]];
        let (mut h, mut q) = ([zero; 2], [zero; 2]);
        let mut early = Self { h: zero, q: zero };
        for n in (0..TERMS).step_by(2) {
            if n == EARLY {
                early = Self::sum(h, q, dt);
            }
            for parity in 0..2 {
                h[parity] = h[parity] + c[0][parity] * dt.of(INVERSE_FACTORIAL[n + parity + 1]);
                q[parity] = q[parity] + c[0][parity] * dt.of(INVERSE_FACTORIAL[n + parity + 2]);
            }
            let next = [forward * c[1][0] - back * c[0][0], forward * c[1][1] - back * c[0][1]];
            c = [c[1], next];
        }
        (early, Self::sum(h, q, dt))
    }

    /// From the sums of even and odd terms.
    #[inline(always)]
    fn sum(h: [T; 2], q: [T; 2], dt: T) -> Self {
        Self { h: (h[0] + h[1]) * dt, q: (q[0] + q[1]) * dt * dt }
    }

    /// By a classical fourth-order Runge-Kutta step.
    #[inline(always)]
    pub(crate) fn runge_kutta(a: T, b: T, dt: f64) -> Self {
        let step = a.of(dt);
        let (alpha, beta) = (a * step * step, b * step);
        let second = alpha + beta * beta;
        let third = beta * (second + alpha);
        let [_, one, half, sixth, twenty_fourth, ..] = INVERSE_FACTORIAL;
        let (one, half, sixth, twenty_fourth) = (a.of(one), a.of(half), a.of(sixth), a.of(twenty_fourth));
        Self {
            h: step * ((one + beta * half) + (second * sixth + third * twenty_fourth)),
            q: a.of(dt * dt) * ((half + beta * sixth) + second * twenty_fourth),
        }
    }

    /// Displacement and velocity after the step.
    #[inline(always)]
    pub(crate) fn advance(self, a: T, b: T, [x, v]: [T; 2], acceleration: T) -> [T; 2] {
        let Self { h, q } = self;
        [x + (h - b * q) * v + q * acceleration, v + a * q * v + h * acceleration]
    }
}

/// The response beside parameters that decay: also the response r \[s²\] to a force that decays with them.
pub(crate) struct DecayingImpulse<T: Lane> {
    pub(crate) impulse: Impulse<T>,
    pub(crate) r: T,
    /// The lanes for which it holds: those with a step that needs no doubling.
    pub(crate) holds: T::Mask,
}

impl<T: Lane> DecayingImpulse<T> {
    /// With stiffness `a` \[1/s²\], damping `b` \[1/s\] and decay `eta` \[1/s\].
    #[inline(always)]
    pub(crate) fn new(a: T, b: T, eta: T, dt: f64) -> Self {
        let t = a.of(dt);
        let (stiffness, damping) = (-a, -b);
        let rate = damping.abs();
        let size = (a.of(0.5) * (rate + (rate * rate + a.of(4.0) * stiffness.abs()).sqrt()) + eta) * t;
        let (damping, stiffness, decay) = (damping * t, stiffness * (t * t), eta * t);
        let mut c = a.of(1.0);
        let mut before = a.of(0.0);
        let mut d = c;
        let mut sums = [c, a.of(INVERSE_FACTORIAL[2]), a.of(INVERSE_FACTORIAL[2])];
        let mut result = sums;
        let (longest, most) = SERIES[SERIES.len() - 1];
        for n in 1..=most {
            // The sums are now complete for lanes with steps of this length.
            if let Some(at) = SERIES.iter().position(|&(_, terms)| terms == n) {
                let shorter = if at == 0 { f64::NEG_INFINITY } else { SERIES[at - 1].0 };
                let done = a.of(shorter).lt(size) & size.le(a.of(SERIES[at].0));
                for (result, sum) in result.iter_mut().zip(sums) {
                    *result = T::select(done, sum, *result);
                }
            }
            if n == most {
                break;
            }
            (before, c) = (c, (-c) * damping + (-before) * stiffness);
            d = c - d * decay;
            sums[0] = sums[0] + c * a.of(INVERSE_FACTORIAL[n + 1]);
            sums[1] = sums[1] + c * a.of(INVERSE_FACTORIAL[n + 2]);
            sums[2] = sums[2] + d * a.of(INVERSE_FACTORIAL[n + 2]);
        }
        let [value, integral, decaying] = result;
        let impulse = Impulse { h: value * t, q: integral * (t * t) };
        Self { impulse, r: decaying * (t * t), holds: size.le(a.of(longest)) }
    }
}
