//! Ratios of polynomials.

use crate::mathematics::linalg::Matrix;
use crate::{Channel, Model};

/// The transfer function of a plant at rest, as a ratio of polynomials.
///
/// ```text
/// H(s) = C (s I - A)⁻¹ B = b(s) / a(s),  a(s) = det(s I - A)
/// ```
///
/// The polynomials are those of `s / unit`. The unit is a frequency near those of the plant, so that the coefficients
/// of a high degree neither overflow nor underflow.
#[derive(Clone, Debug, PartialEq)]
pub struct TransferFunction {
    /// Coefficients of b, that of s⁰ first, padded with a zero to an even number; in s².
    numerator: Vec<f64>,
    /// Coefficients of a, in the same order and number.
    denominator: Vec<f64>,
    /// The degree of a.
    degree: usize,
    /// A power of two \[rad/s\].
    unit: f64,
}

impl TransferFunction {
    /// From the force to the displacement of the first mass, linearised about a state of rest.
    ///
    /// Source: Faddeev and Faddeeva (1963), *Computational Methods of Linear Algebra*, section 47 (the method of
    /// Leverrier and Faddeev).
    pub(super) fn of(model: &Model, rest: &[f64]) -> Self {
        let degree = model.motion();
        let jacobian = model.jacobian(rest, 0.0);
        let push = model.by_force(rest);
        let motion = jacobian.view((0, 0), (degree, degree)).into_owned();
        // A few masses need no unit: their polynomials are exact enough.
        let unit = if degree <= FEW { 1.0 } else { unit_of(&motion) };
        let (a, b) = (motion / unit, push.rows(0, degree) / (unit * unit));
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
        Self { numerator, denominator, degree, unit }
    }

    /// |H(iω)| at some frequencies \[rad/s\], which must be positive; infinite at the resonance of a plant without damping
    /// \[s²\].
    pub fn magnitude(&self, frequencies: &[f64]) -> Vec<f64> {
        let mut magnitude = Vec::with_capacity(frequencies.len());
        self.magnitude_into(frequencies, &mut magnitude);
        magnitude
    }

    /// [`Self::magnitude`], written over the contents of `magnitude`
    pub(super) fn magnitude_into(&self, frequencies: &[f64], magnitude: &mut Vec<f64>) {
        let Self { numerator, denominator, degree: _, unit } = self;
        let at = |w: f64| (square_at(numerator, w / unit) / square_at(denominator, w / unit)).sqrt();
        // Where a zero meets a pole, as that of a hum that the force does not drive, both are rounding; beside them is the limit.
        let meet = |w: f64| is_rounding(numerator, w / unit) && is_rounding(denominator, w / unit);
        magnitude.clear();
        magnitude.extend(frequencies.iter().map(|&w| if meet(w) { at(w * (1.0 + BESIDE)) } else { at(w) }));
    }

    /// Two frequencies that enclose all natural frequencies, close to the least and the greatest where damping is small
    /// \[rad/s\]; `None` without a natural frequency.
    ///
    /// ```text
    /// a(s) = Π (s² + 2ζᵢωᵢ s + ωᵢ²),  a₂ ≥ Σ ωᵢ²,  a₂' ≥ Σ 1/ωᵢ²
    /// ```
    ///
    /// with a₂ the coefficient two below the highest of a, and a₂' two above the lowest over the lowest.
    pub fn natural_span(&self) -> Option<(f64, f64)> {
        let Self { denominator, degree, unit, .. } = self;
        let greatest = denominator.get(degree.checked_sub(2)?)?.abs().sqrt();
        // A hysteretic displacement at rest adds a factor s, which is zero up to rounding.
        let lowest = (0..*degree).find(|&i| denominator[i].abs() > 1e-9 * denominator[i + 1].abs() * greatest)?;
        let least = (denominator[lowest] / denominator.get(lowest + 2)?).abs().sqrt();
        (least.is_normal() && greatest.is_finite()).then_some((unit * least.min(greatest), unit * greatest))
    }
}

/// The distance from a zero that meets a pole, as a ratio.
const BESIDE: f64 = 1e-6;

/// A polynomial's share of the sum of its terms' sizes, below which it is taken for rounding.
const ROUNDING: f64 = 1e-12;

/// The largest degree of polynomials that need no unit of time.
const FEW: usize = 8;

/// A power of two near the greatest natural frequency of a motion, by the norm of `A²` \[rad/s\].
fn unit_of(motion: &Matrix) -> f64 {
    let square = (motion * motion).abs().row_sum().max();
    if square.is_normal() { libm::exp2(libm::round(0.5 * libm::log2(square)) - 1.0) } else { 1.0 }
}

/// |p(iω)|²: even powers of iω are real, odd ones are not.
#[inline]
fn square_at(polynomial: &[f64], frequency: f64) -> f64 {
    let square = -frequency * frequency;
    let (mut even, mut odd) = (0.0, 0.0);
    for pair in polynomial.chunks_exact(2).rev() {
        even = even * square + pair[0];
        odd = odd * square + pair[1];
    }
    even * even + frequency * frequency * odd * odd
}

/// Whether nothing but rounding is left of a polynomial of iω.
fn is_rounding(polynomial: &[f64], frequency: f64) -> bool {
    let whole = polynomial.iter().rev().fold(0.0, |sum, c| sum * frequency + c.abs());
    square_at(polynomial, frequency) <= (ROUNDING * whole) * (ROUNDING * whole)
}
