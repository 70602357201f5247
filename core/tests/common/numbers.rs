//! Differences of numbers and of estimates, motions by textbook formulas, and random numbers that the core has no part in.

use kalmanscope_core::{Estimates, FilterKind, Hold, Record};
use nalgebra::{DMatrix, DVector, Matrix2, Vector2};

pub(crate) const DETERMINISTIC: [FilterKind; 6] =
    [FilterKind::KF, FilterKind::EKF, FilterKind::IEKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF];
pub(crate) const ADAPTIVE: [FilterKind; 5] =
    [FilterKind::EKF, FilterKind::IEKF, FilterKind::UKF, FilterKind::SR_UKF, FilterKind::CKF];

pub(crate) fn bits(values: &[f64]) -> Vec<u64> {
    values.iter().map(|x| x.to_bits()).collect()
}

pub(crate) fn beliefs(estimates: &Estimates) -> Vec<u64> {
    (0..estimates.len()).flat_map(|k| [estimates.mean(k), estimates.cov(k)]).flat_map(bits).collect()
}

pub(crate) fn largest(values: &[f64]) -> f64 {
    values.iter().fold(0.0, |most, x| most.max(x.abs()))
}

pub(crate) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

pub(crate) fn rms(values: &[f64]) -> f64 {
    (values.iter().map(|x| x * x).sum::<f64>() / values.len() as f64).sqrt()
}

/// Over the standard deviations of the sample; where these are zero, any difference is infinite.
pub(crate) fn distance([mean, cov]: [&[f64]; 2], other: &Estimates, at: usize) -> f64 {
    let n = mean.len();
    let of = |i: usize| {
        let (far, std) = (mean[i] - other.mean(at)[i], other.std(at, i));
        let wider = cov[i * (n + 1)].sqrt() - std;
        if far == 0.0 && wider == 0.0 { 0.0 } else { far.abs().max(wider.abs()) / std }
    };
    (0..n).map(of).fold(0.0, f64::max)
}

pub(crate) fn apart((one, k): (&Estimates, usize), (other, at): (&Estimates, usize)) -> f64 {
    distance([one.mean(k), one.cov(k)], other, at)
}

/// The most that a sample of the one is apart from that of the other, which has this many steps for each of its own.
pub(crate) fn farthest(one: &Estimates, other: &Estimates, steps: usize) -> f64 {
    (0..one.len()).map(|k| apart((one, k), (other, steps * k))).fold(0.0, f64::max)
}

/// The transition of x and ẋ of an oscillator with ωₙ and ζ < 1 over a time, without a force.
pub(crate) fn transition([wn, zeta]: [f64; 2], t: f64) -> Matrix2<f64> {
    let wd = wn * (1.0 - zeta * zeta).sqrt();
    let (sin, cos) = (wd * t).sin_cos();
    let ratio = zeta * wn / wd;
    Matrix2::new(cos + ratio * sin, sin / wd, -wn * wn / wd * sin, cos - ratio * sin) * (-zeta * wn * t).exp()
}

/// x, ẋ and ẍ of an oscillator at each sample, under a force that is held, or linear between samples.
pub(crate) fn motion(of: [f64; 2], dt: f64, hold: Hold, force: &[f64], start: [f64; 2]) -> Vec<[f64; 3]> {
    let ([wn, zeta], transition, mut state) = (of, transition(of, dt), Vector2::from(start));
    let step = |k: usize| {
        let [x, v]: [f64; 2] = state.into();
        let next = if hold == Hold::First { force[(k + 1).min(force.len() - 1)] } else { force[k] };
        let slope = (next - force[k]) / dt;
        // Besides its free motion it follows a line by a line.
        let follows = |force: f64| Vector2::new(force - 2.0 * zeta / wn * slope, slope) / (wn * wn);
        state = transition * (state - follows(force[k])) + follows(next);
        [x, v, force[k] - 2.0 * zeta * wn * v - wn * wn * x]
    };
    (0..force.len()).map(step).collect()
}

/// By the belief of a filter that is `run::knowing`, before any reading: they are jointly normal.
pub(crate) fn joint_motion(record: &Record, of: [f64; 2]) -> (DVector<f64>, DMatrix<f64>) {
    let (n, transition) = (2 * record.len(), transition(of, record.dt()));
    let input = Vector2::new((1.0 - transition[(0, 0)]) / (of[0] * of[0]), transition[(0, 1)]);
    let variances = |stds: [f64; 2]| Matrix2::from_diagonal(&Vector2::from(stds.map(|std| std * std)));
    let (mut mean, mut cov) = (DVector::zeros(n), DMatrix::zeros(n, n));
    cov.fixed_view_mut::<2, 2>(0, 0).copy_from(&variances([0.3, 1.0]));
    for k in 1..record.len() {
        let (last, next) = (2 * k - 2, 2 * k);
        let moved = transition * mean.fixed_rows::<2>(last) + input * record.force(k - 1);
        mean.fixed_rows_mut::<2>(next).copy_from(&moved);
        let rows = transition * cov.view((last, 0), (2, next));
        cov.view_mut((next, 0), (2, next)).copy_from(&rows);
        cov.view_mut((0, next), (next, 2)).copy_from(&rows.transpose());
        let own = rows.fixed_view::<2, 2>(0, last) * transition.transpose() + variances([1e-4, 0.02]);
        cov.fixed_view_mut::<2, 2>(next, next).copy_from(&own);
    }
    (mean, cov)
}

pub(crate) fn log_normal(cov: DMatrix<f64>, errors: &DVector<f64>) -> f64 {
    let factor = cov.cholesky().expect("it is definite");
    let ln_determinant = 2.0 * factor.l().diagonal().map(f64::ln).sum();
    let ln_2_pi = std::f64::consts::TAU.ln();
    -0.5 * (errors.dot(&factor.solve(errors)) + ln_determinant + errors.len() as f64 * ln_2_pi)
}

/// `exp(M)` by a Taylor series over a 1024th, squared ten times.
pub(crate) fn exponential(m: &DMatrix<f64>) -> DMatrix<f64> {
    let small = m / 1024.0;
    let mut term = DMatrix::identity(m.nrows(), m.nrows());
    let mut sum = term.clone();
    for n in 1..20 {
        term = term * &small / f64::from(n);
        sum += &term;
    }
    (0..10).fold(sum, |power, _| &power * &power)
}

/// SplitMix64 (Steele, Lea and Flood 2014).
pub(crate) struct Random(u64);

const STEP: u64 = 0x9E37_79B9_7F4A_7C15;

impl Random {
    /// A state that is a multiple of the step would give the numbers of another seed, some places on.
    pub(crate) fn new(seed: u64) -> Self {
        Self(mixed(seed.wrapping_add(12_345)))
    }

    pub(crate) fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(STEP);
        (mixed(self.0) >> 11) as f64 / (1_u64 << 53) as f64
    }

    pub(crate) fn normal(&mut self) -> f64 {
        (-2.0 * (1.0 - self.uniform()).ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

fn mixed(state: u64) -> u64 {
    let z = (state ^ (state >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
    let z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
    z ^ (z >> 31)
}
