//! Ratios of polynomials.

use crate::Channel;
use crate::gaussian::{Matrix, Vector};
use crate::model::Model;

/// The most components that move in any plant.
const MOST: usize = 8;
/// Room for the coefficients of a polynomial of that degree, half of them of even powers.
const COEFFICIENTS: usize = 2 * (MOST / 2 + 1);

/// The transfer function of a plant at rest, as a ratio of polynomials.
///
/// ```text
/// H(s) = C (s I - A)⁻¹ B = b(s) / a(s),  a(s) = det(s I - A)
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TransferFunction {
    /// Coefficients of b, that of s⁰ first.
    numerator: [f64; COEFFICIENTS],
    /// Coefficients of a.
    denominator: [f64; COEFFICIENTS],
    /// The degree of a.
    degree: usize,
}

impl TransferFunction {
    /// From the force to the displacement of the first mass, linearised at a state of rest.
    ///
    /// Source: Faddeev and Faddeeva (1963), *Computational Methods of Linear Algebra*, section 47 (the method of
    /// Leverrier and Faddeev).
    pub(super) fn of<P: Model<N>, const N: usize>(model: &P, rest: &Vector<N>) -> Self {
        const { assert!(P::MOTION <= MOST) };
        let jacobian = model.jacobian(rest);
        let push = model.rate(rest, 1.0) - model.rate(rest, 0.0);
        let mut a = Matrix::<MOST, MOST>::zeros();
        let mut b = Vector::<MOST>::zeros();
        for j in 0..P::MOTION {
            b[j] = push[j];
            for i in 0..P::MOTION {
                a[(i, j)] = jacobian[(i, j)];
            }
        }
        let output = P::CHANNELS.iter().position(|&c| c == Channel::Displacement).unwrap_or(0);
        let mut numerator = [0.0; COEFFICIENTS];
        let mut denominator = [0.0; COEFFICIENTS];
        denominator[P::MOTION] = 1.0;
        // Components beyond those that move have no rate, and so no part in any trace.
        let mut adjugate = Matrix::<MOST, MOST>::identity();
        for k in 1..=P::MOTION {
            numerator[P::MOTION - k] = adjugate.row(output).transpose().dot(&b);
            adjugate = a * adjugate;
            let coefficient = -adjugate.trace() / k as f64;
            denominator[P::MOTION - k] = coefficient;
            for i in 0..MOST {
                adjugate[(i, i)] += coefficient;
            }
        }
        Self { numerator, denominator, degree: P::MOTION }
    }

    /// |H(iω)| at some frequencies \[rad/s\], which must be positive; infinite at the resonance of a plant without damping
    /// \[s²\].
    pub fn magnitude(&self, frequencies: &[f64]) -> Vec<f64> {
        let mut magnitude = Vec::with_capacity(frequencies.len());
        self.magnitude_into(frequencies, &mut magnitude);
        magnitude
    }

    /// [`Self::magnitude`] in place of what `magnitude` holds.
    pub(super) fn magnitude_into(&self, frequencies: &[f64], magnitude: &mut Vec<f64>) {
        let Self { numerator, denominator, degree: _ } = self;
        magnitude.clear();
        magnitude.extend(frequencies.iter().map(|&w| (square_at(numerator, w) / square_at(denominator, w)).sqrt()));
    }

    /// Two frequencies that have all natural frequencies between them, close to the least and the greatest where damping is
    /// small \[rad/s\]; `None` where there is nothing that swings.
    ///
    /// ```text
    /// a(s) = Π (s² + 2ζᵢωᵢ s + ωᵢ²),  a₂ ≥ Σ ωᵢ²,  a₂' ≥ Σ 1/ωᵢ²
    /// ```
    ///
    /// with a₂ the coefficient two below the highest of a, and a₂' two above the lowest over the lowest.
    pub fn natural_span(&self) -> Option<(f64, f64)> {
        let Self { denominator, degree, .. } = self;
        let greatest = denominator.get(degree.checked_sub(2)?)?.abs().sqrt();
        // A hysteretic displacement at rest adds a factor s, zero to rounding.
        let lowest = (0..*degree).find(|&i| denominator[i].abs() > 1e-9 * denominator[i + 1].abs() * greatest)?;
        let least = (denominator[lowest] / denominator.get(lowest + 2)?).abs().sqrt();
        (least.is_normal() && greatest.is_finite()).then_some((least.min(greatest), greatest))
    }
}

/// |p(iω)|²: even powers of iω are real, odd ones are not.
#[inline]
fn square_at(polynomial: &[f64; COEFFICIENTS], frequency: f64) -> f64 {
    let square = -frequency * frequency;
    let (mut even, mut odd) = (0.0, 0.0);
    for i in (0..COEFFICIENTS / 2).rev() {
        even = even * square + polynomial[2 * i];
        odd = odd * square + polynomial[2 * i + 1];
    }
    even * even + frequency * frequency * odd * odd
}
