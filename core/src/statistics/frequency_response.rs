//! Frequency responses of plants, true and estimated.
//!
//! ```text
//! H(iω) = C (iω I - A)⁻¹ B
//! ```
//!
//! is that from the force over mass \[m/s²\] to the displacement \[m\] of the first mass at rest, for small motion.

use std::f64::consts::TAU;

use kalmanscope_filters::Channel;
use kalmanscope_filters::linalg::{Matrix, Vector, lower_root};
use kalmanscope_filters::lists::{mapped, sort_numbers};
use kalmanscope_records::Record;
use nalgebra::{Complex, DMatrix};

use crate::{Estimates, Model, PlantKind};

const DRAWS: usize = 96;
/// The number of estimates of the band that are averaged: a single one is ragged where the belief is wide.
const BATCHES: usize = 4;

/// The estimated frequency response and its band \[s²\].
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Believed {
    /// |H| of the estimated parameters.
    pub mean: Vec<f64>,
    /// The 2.5 % and the 97.5 % quantile of |H|. `None` if the covariance of the parameters has no root.
    pub band: Option<(Vec<f64>, Vec<f64>)>,
}

/// The transfer function of a plant at rest, with a value for each of its parameters in the channel's unit.
pub fn transfer_function(plant: &PlantKind, value: impl Fn(Channel) -> f64) -> TransferFunction {
    let value = |channel: Channel| if channel.is_parameter() { value(channel) } else { 0.0 };
    let rest: Vec<f64> = mapped(plant.channels(), &|&channel| value(channel));
    TransferFunction::of(&Model::new(plant.clone()), &rest)
}

/// The true transfer function at sample `k`. `None` if a parameter of the truth is not known.
pub fn true_transfer_function(plant: &PlantKind, record: &Record, k: usize) -> Option<TransferFunction> {
    let known = |channel| record.truth(channel)?.get(k).copied().filter(|value| value.is_finite());
    plant.parameters().all(|c| known(c).is_some()).then(|| transfer_function(plant, |c| known(c).unwrap_or(f64::NAN)))
}

/// The estimate of |H| and its band at sample `k`, at frequencies \[rad/s\] that must be positive.
///
/// The band comes from draws from the normal distribution of the parameters in canonical form, the same at every sample.
pub fn believed(estimates: &Estimates, k: usize, frequencies: &[f64]) -> Believed {
    let (mean, draws) = from_belief(estimates, k);
    let band = draws.map(|draws| {
        let mut band = (vec![0.0; frequencies.len()], vec![0.0; frequencies.len()]);
        for batch in draws.chunks(DRAWS) {
            let magnitudes: Vec<Vec<f64>> = mapped(batch, &|draw| draw.magnitude(frequencies));
            for (place, (below, above)) in band.0.iter_mut().zip(&mut band.1).enumerate() {
                let [low, high] = quantiles(&mut mapped(&magnitudes, &|of| of[place]));
                *below += low / BATCHES as f64;
                *above += high / BATCHES as f64;
            }
        }
        band
    });
    Believed { mean: mean.magnitude(frequencies), band }
}

fn from_belief(estimates: &Estimates, k: usize) -> (TransferFunction, Option<Vec<TransferFunction>>) {
    let model = Model::new(estimates.plant.clone());
    let (n, motion) = (model.size(), model.motion());
    let mut mean = Vector::zeros(n);
    for i in motion..n {
        mean[i] = estimates.canonical_mean(k, i);
    }
    let (all, cov) = (estimates.channels().len(), estimates.cov(k));
    let parameters = Matrix::from_fn(n - motion, n - motion, |i, j| {
        let (i, j) = (i + motion, j + motion);
        estimates.canonical_sign(k, i) * estimates.canonical_sign(k, j) * cov[j * all + i]
    });
    let draw = |root: &Matrix, i: usize| {
        let normal = Vector::from_fn(n - motion, |j, _| normal(i, j, n - motion));
        let mut drawn = mean.clone();
        let mut parameters = drawn.rows_mut(motion, n - motion);
        parameters += root * normal;
        TransferFunction::of(&model, drawn.as_slice())
    };
    let draws = lower_root(&parameters).ok().map(|root| (0..BATCHES * DRAWS).map(|i| draw(&root, i)).collect());
    (TransferFunction::of(&model, mean.as_slice()), draws)
}

const USUAL: usize = 6;

/// The root of `x^(d+1) = x + 1` above 1: powers of its inverse are d numbers far from rational and from each other.
fn root(d: usize) -> f64 {
    let mut x = 1.2;
    for _ in 0..60 {
        // A fixed-point iteration: (1 + x)^(1/(d+1)).
        x = libm::pow(1.0 + x, 1.0 / (d + 1) as f64);
    }
    x
}

const ROOT: f64 = 1.1127756842787055;

/// The component `j` of draw `i` from a standard normal distribution of `d` components: a quasirandom sequence, which fills space more
/// evenly than random points, with the Box-Muller transform. Source: Roberts (2018), The unreasonable effectiveness of quasirandom
/// sequences; Niederreiter (1992), *Random Number Generation and Quasi-Monte Carlo Methods*, section 3.1 (Kronecker sequences).
fn normal(i: usize, j: usize, d: usize) -> f64 {
    let ratio = if d <= USUAL { ROOT } else { root(d + d % 2) };
    let uniform = |place: usize| {
        let x = 0.5 + (i + 1) as f64 * (0..=place).fold(1.0, |power, _| power / ratio);
        x - libm::floor(x)
    };
    let radius = (-2.0 * libm::log(1.0 - uniform(j & !1))).sqrt();
    let (sin, cos) = libm::sincos(TAU * uniform(j | 1));
    if j.is_multiple_of(2) { radius * cos } else { radius * sin }
}

/// The place of the 2.5 % quantile between the second and third smallest draws: the i-th of n draws has the share `(i - ½) / n` below it.
/// Source: Hyndman and Fan (1996), Sample quantiles in statistical packages, definition 5.
const BEYOND_SECOND: f64 = 0.025 * DRAWS as f64 + 0.5 - 2.0;

fn quantiles(values: &mut [f64]) -> [f64; 2] {
    sort_numbers(values);
    let between = |a: f64, b: f64| if a == b { a } else { a + BEYOND_SECOND * (b - a) };
    let last = values.len() - 1;
    [between(values[1], values[2]), between(values[last - 1], values[last - 2])]
}

/// The transfer function of a plant at rest, as a ratio of polynomials.
///
/// ```text
/// H(s) = C (s I - A)⁻¹ B = b(s) / a(s),  a(s) = det(s I - A)
/// ```
///
/// The polynomials are those of `s / unit`, so that coefficients of a high degree neither overflow nor underflow.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    /// Coefficients of b, that of s⁰ first, padded with a zero to an even number; in s².
    numerator: Vec<f64>,
    denominator: Vec<f64>,
    degree: usize,
    /// A power of two \[rad/s\].
    unit: f64,
    long: Option<LongChain>,
}

/// Many masses, `ẍ = K x + C ẋ + b f`. Their polynomials lose digits: at 13 masses they were wrong by 4e-6.
#[derive(Clone, Debug, PartialEq)]
struct LongChain {
    stiffness: Matrix,
    damping: Matrix,
    push: Vec<f64>,
    /// The largest distance of two masses that act on each other.
    reach: usize,
}

impl LongChain {
    /// `None` where the motion is not `[x, v]` with `ẋ = v`, or has few masses.
    fn of(motion: &Matrix, push: &[f64]) -> Option<Self> {
        let m = motion.nrows() / 2;
        let moves = |i: usize, j: usize| motion[(i, j)] == f64::from(u8::from(j == m + i));
        let is_of_masses = motion.nrows() == 2 * m && (0..m).all(|i| (0..2 * m).all(|j| moves(i, j)));
        if motion.nrows() <= LONG || !is_of_masses {
            return None;
        }
        let [stiffness, damping] = [0, m].map(|column| motion.view((m, column), (m, m)).into_owned());
        let acts = |i: usize, j: usize| stiffness[(i, j)] != 0.0 || damping[(i, j)] != 0.0;
        let distances = (0..m).flat_map(|i| (0..m).filter(move |j| acts(i, *j)).map(move |j| i.abs_diff(j)));
        Some(Self { reach: distances.max().unwrap_or(0), push: push[m..2 * m].to_vec(), stiffness, damping })
    }

    /// Solves `(-ω² - iω C - K) x = b` within the band, with partial pivoting. A thousand operations for twenty masses: a band of the
    /// response takes 150,000 solutions.
    fn magnitude(&self, w: f64) -> f64 {
        let Self { stiffness, damping, push, reach } = self;
        let m = push.len();
        let mut a = DMatrix::<Complex<f64>>::zeros(m, m);
        for j in 0..m {
            for i in j.saturating_sub(*reach)..m.min(j + reach + 1) {
                let inertia = if i == j { w * w } else { 0.0 };
                a[(i, j)] = Complex::new(-stiffness[(i, j)] - inertia, -w * damping[(i, j)]);
            }
        }
        let mut x: Vec<Complex<f64>> = mapped(push, &|push| Complex::new(*push, 0.0));
        // A swap of rows doubles the reach above the diagonal.
        let columns = |i: usize| i..m.min(i + 2 * reach + 1);
        for i in 0..m {
            let below = i + 1..m.min(i + reach + 1);
            let larger =
                |one: usize, two: usize| if a[(two, i)].norm_sqr() > a[(one, i)].norm_sqr() { two } else { one };
            let pivot = below.clone().fold(i, larger);
            if pivot != i {
                columns(i).for_each(|j| a.swap((i, j), (pivot, j)));
                x.swap(i, pivot);
            }
            for row in below {
                let factor = a[(row, i)] / a[(i, i)];
                columns(i).for_each(|j| a[(row, j)] = a[(row, j)] - factor * a[(i, j)]);
                x[row] = x[row] - factor * x[i];
            }
        }
        for i in (0..m).rev() {
            let known: Complex<f64> = columns(i).skip(1).map(|j| a[(i, j)] * x[j]).sum();
            x[i] = (x[i] - known) / a[(i, i)];
        }
        let square = x[0].norm_sqr();
        if square.is_nan() { f64::INFINITY } else { square.sqrt() }
    }

    fn natural_span(&self) -> Option<(f64, f64)> {
        let least = (-&self.stiffness).try_inverse()?.trace().sqrt().recip();
        let greatest = -self.stiffness.trace();
        (least.is_normal() && greatest > 0.0).then(|| (least, greatest.sqrt()))
    }
}

impl TransferFunction {
    /// From the force to the displacement of the first mass, linearised about a state of rest. Source: Faddeev and Faddeeva
    /// (1963), *Computational Methods of Linear Algebra*, section 47 (the method of Leverrier and Faddeev).
    fn of(model: &Model, rest: &[f64]) -> Self {
        let degree = model.motion();
        let jacobian = model.jacobian(rest, 0.0);
        let push = model.by_force(rest);
        let motion = jacobian.view((0, 0), (degree, degree)).into_owned();
        // A few masses need no unit: their polynomials are exact enough.
        let unit = if degree <= FEW { 1.0 } else { unit_of(&motion) };
        let long = LongChain::of(&motion, push.as_slice());
        let degree = if long.is_some() { 0 } else { degree };
        let (a, b) = (motion.view((0, 0), (degree, degree)) / unit, push.rows(0, degree) / (unit * unit));
        let output = model.place(Channel::DISPLACEMENT).unwrap_or(0);
        let coefficients = 2 * (degree / 2 + 1);
        let mut numerator = vec![0.0; coefficients];
        let mut denominator = vec![0.0; coefficients];
        denominator[degree] = 1.0;
        let mut adjugate = Matrix::identity(degree, degree);
        for k in 1..=degree {
            numerator[degree - k] = unit * (0..degree).map(|j| adjugate[(output, j)] * b[j]).sum::<f64>();
            adjugate = &a * adjugate;
            let coefficient = -adjugate.trace() / k as f64;
            denominator[degree - k] = coefficient;
            for i in 0..degree {
                adjugate[(i, i)] += coefficient;
            }
        }
        Self { numerator, denominator, degree, unit, long }
    }

    /// |H(iω)| at positive frequencies \[rad/s\]; infinite at a resonance without damping \[s²\].
    pub fn magnitude(&self, frequencies: &[f64]) -> Vec<f64> {
        if let Some(long) = &self.long {
            return mapped(frequencies, &|&w| long.magnitude(w));
        }
        let Self { numerator, denominator, unit, .. } = self;
        let at = |w: f64| (square_at(numerator, w / unit) / square_at(denominator, w / unit)).sqrt();
        // Where a zero meets a pole, as that of a hum that the force does not drive, both are rounding; beside them is the limit.
        let meet = |w: f64| is_rounding(numerator, w / unit) && is_rounding(denominator, w / unit);
        mapped(frequencies, &|&w| if meet(w) { at(w * (1.0 + BESIDE)) } else { at(w) })
    }

    /// Two frequencies that enclose all natural frequencies, close to the ends where damping is small, if there are some \[rad/s\].
    ///
    /// ```text
    /// a(s) = Π (s² + 2ζᵢωᵢ s + ωᵢ²),  a₂ ≥ Σ ωᵢ²,  a₂' ≥ Σ 1/ωᵢ²
    /// ```
    ///
    /// with a₂ the coefficient two below the highest of a, and a₂' two above the lowest over the lowest.
    pub fn natural_span(&self) -> Option<(f64, f64)> {
        if let Some(long) = &self.long {
            return long.natural_span();
        }
        let Self { denominator, degree, unit, .. } = self;
        let greatest = denominator.get(degree.checked_sub(2)?)?.abs().sqrt();
        // A hysteretic displacement at rest adds a factor s, which is zero up to rounding.
        let lowest = (0..*degree).find(|&i| denominator[i].abs() > 1e-9 * denominator[i + 1].abs() * greatest)?;
        let least = (denominator[lowest] / denominator.get(lowest + 2)?).abs().sqrt();
        (least.is_normal() && greatest.is_finite()).then_some((unit * least.min(greatest), unit * greatest))
    }
}

/// The distance from a zero that meets a pole, as a ratio: right there, a hum has an infinite response.
const BESIDE: f64 = 1e-6;

/// A polynomial's share of the sum of its terms' sizes, below which it is taken for rounding.
const ROUNDING: f64 = 1e-12;

/// The largest degree of polynomials that need no unit of time.
const FEW: usize = 8;

/// Ten masses: their polynomials have six digits.
const LONG: usize = 20;

/// A power of two near the greatest natural frequency of a motion, by the norm of `A²` \[rad/s\].
fn unit_of(motion: &Matrix) -> f64 {
    let square = (motion * motion).abs().row_sum().max();
    if square.is_normal() { libm::exp2(libm::round(0.5 * libm::log2(square)) - 1.0) } else { 1.0 }
}

/// |p(iω)|²: even powers of iω are real, odd ones are not.
fn square_at(polynomial: &[f64], frequency: f64) -> f64 {
    let square = -frequency * frequency;
    let (mut even, mut odd) = (0.0, 0.0);
    for pair in polynomial.chunks_exact(2).rev() {
        even = even * square + pair[0];
        odd = odd * square + pair[1];
    }
    even * even + frequency * frequency * odd * odd
}

fn is_rounding(polynomial: &[f64], frequency: f64) -> bool {
    let whole = polynomial.iter().rev().fold(0.0, |sum, c| sum * frequency + c.abs());
    square_at(polynomial, frequency) <= (ROUNDING * whole) * (ROUNDING * whole)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn draws_have_the_moments_of_the_standard_normal() {
        assert!((ROOT.powi(7) - ROOT - 1.0).abs() < 1e-14 && (root(USUAL) - ROOT).abs() < 1e-15);
        for j in 0..5 {
            let mean = |of: &dyn Fn(usize) -> f64| (0..DRAWS).map(of).sum::<f64>() / DRAWS as f64;
            let moment = |p: i32| mean(&|i| normal(i, j, 5).powi(p));
            assert!(moment(1).abs() < 0.06 && (moment(2) - 1.0).abs() < 0.1, "{} {}", moment(1), moment(2));
            for other in 0..j {
                let product = mean(&|i| normal(i, j, 5) * normal(i, other, 5));
                assert!(product.abs() < 0.08, "correlation {product} of {j} and {other}");
            }
        }
    }
}
