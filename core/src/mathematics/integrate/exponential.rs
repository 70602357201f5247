//! The matrix exponential and its integrals.

use super::{INVERSE_FACTORIAL, ImpulseResponse, doublings};
use crate::mathematics::linalg::{Matrix, copy, fit, multiply};

/// `Φ = exp(A dt)` and the integrals that give the effect, after `dt`, of an input that is constant or linear in time.
#[derive(Clone, Debug)]
pub(crate) struct Integrals {
    /// Φ, n × n.
    pub transition: Matrix,
    /// `Γ₁ = ∫₀^dt exp(A s) ds = dt φ₁(A dt)`, n × n: the effect of a constant.
    pub constant: Matrix,
    /// `Γ₂ = ∫₀^dt Γ₁(s) ds = dt² φ₂(A dt)`, n × n: the effect of a slope. Meaningless if the caller did not want it.
    pub slope: Matrix,
    powers: Powers,
}

/// `m`, its first powers, and memory to work in.
#[derive(Clone, Debug)]
struct Powers {
    first: Matrix,
    second: Matrix,
    third: Matrix,
    fourth: Matrix,
    work: Matrix,
}

impl Default for Integrals {
    /// Those of no component.
    fn default() -> Self {
        let none = || Matrix::zeros(0, 0);
        let powers = Powers { first: none(), second: none(), third: none(), fourth: none(), work: none() };
        Self { transition: none(), constant: none(), slope: none(), powers }
    }
}

/// The exponential of `A dt` and its integrals, for any n × n matrix `A`, singular or not.
///
/// ```text
/// Γ₂(t) = Σ Aⁿ tⁿ⁺²/(n+2)!,  Γ₁ = t I + A Γ₂,  Φ = I + A Γ₁
/// Γ₂(2t) = Γ₂ + t Γ₁ + Φ Γ₂,  Γ₁(2t) = Γ₁ + Φ Γ₁
/// ```
///
/// A Taylor series of Γ₂, or of Γ₁ if no slope is wanted, over a step so short that its terms exhaust double precision,
/// then doubled.
///
/// Source: Moler and Van Loan (2003), Nineteen dubious ways to compute the exponential of a matrix, method 3; Van Loan
/// (1978), Computing integrals involving the matrix exponential; Paterson and Stockmeyer (1973), On the number of nonscalar
/// multiplications necessary to evaluate polynomials.
pub(crate) fn exponential_integrals(a: &Matrix, dt: f64) -> Integrals {
    let mut integrals = Integrals::default();
    integrals.compute(a, dt, true);
    integrals
}

impl Integrals {
    /// [`exponential_integrals`], written over `self`; Γ₂ only `with_slope`.
    pub(crate) fn compute(&mut self, a: &Matrix, dt: f64, with_slope: bool) {
        let n = a.nrows();
        for matrix in [&mut self.transition, &mut self.constant, &mut self.slope] {
            fit(matrix, n, n);
        }
        if n == 2 && a[(0, 0)] == 0.0 && a[(0, 1)] == 1.0 {
            return self.of_oscillator(a[(1, 0)], a[(1, 1)], dt, with_slope);
        }
        let (doublings, quartets) = self.powers.scale(a, dt);
        let Self { transition, constant, slope, powers } = self;
        let mut t = dt / libm::exp2(f64::from(doublings));
        if with_slope {
            powers.series(slope, quartets, 2);
            *slope *= t * t;
        } else {
            powers.series(constant, quartets, 1);
            *constant *= t;
        }
        for _ in 0..doublings {
            if with_slope {
                plus_product(constant, t, a, slope);
            }
            plus_product(transition, 1.0, a, constant);
            let sum = if with_slope { &mut *slope } else { &mut *constant };
            multiply(&mut powers.work, transition, sum);
            *sum += &powers.work;
            if with_slope {
                for (slope, constant) in slope.iter_mut().zip(constant.iter()) {
                    *slope += constant * t;
                }
            }
            t *= 2.0;
        }
        if with_slope {
            plus_product(constant, dt, a, slope);
        }
        plus_product(transition, 1.0, a, constant);
    }

    /// Those of `A = [0, 1; a, b]`, which follow from the response to an impulse.
    ///
    /// ```text
    /// Φ = [1 + a q, h; a h, 1 + a q + b h],  Γ₁ = [h - b q, q; a q, h],  Γ₂ = [q - b p, p; a p, q]
    /// ```
    fn of_oscillator(&mut self, a: f64, b: f64, dt: f64, with_slope: bool) {
        let Self { transition, constant, slope, .. } = self;
        let ImpulseResponse { value: h, integral: q } = ImpulseResponse::new(a, b, dt);
        transition.copy_from_slice(&[1.0 + a * q, a * h, h, 1.0 + a * q + b * h]);
        constant.copy_from_slice(&[h - b * q, a * q, q, h]);
        if with_slope {
            let p = ImpulseResponse::second_integral(a, b, dt);
            slope.copy_from_slice(&[q - b * p, a * p, p, q]);
        }
    }
}

impl Powers {
    /// Limits the norm of m², so that the first term that a number of quartets leaves out is below rounding.
    const QUARTETS: [(f64, usize); 3] = [(1.5e-3, 2), (0.08, 3), (f64::INFINITY, 4)];

    /// Makes `m = A t` with t so short that four quartets of terms exhaust double precision. Returns how often the step was
    /// halved for that, and how many quartets do.
    fn scale(&mut self, a: &Matrix, dt: f64) -> (u32, usize) {
        let Self { first, second, third, fourth, .. } = self;
        copy(first, a);
        *first *= dt;
        multiply(second, first, first);
        let square = norm(second);
        // Rows of different units make the norm of m large, but not that of its square.
        let doublings = doublings(norm(first).min(square.sqrt()));
        // A power of two: a step that it divides is not rounded.
        let scale = libm::exp2(-f64::from(doublings));
        if doublings > 0 {
            *first *= scale;
            *second *= scale * scale;
        }
        multiply(third, second, first);
        multiply(fourth, second, second);
        let square = square * (scale * scale);
        let quartets = Self::QUARTETS.iter().find(|(longest, _)| square <= *longest).map_or(4, |&(_, count)| count);
        (doublings, quartets)
    }

    /// `Σ mⁿ/(n+k)!` over four times as many n, from zero on; four powers at a time.
    fn series(&mut self, sum: &mut Matrix, quartets: usize, k: usize) {
        let Self { first, second, third, fourth, work } = self;
        let n = first.nrows();
        sum.as_mut_slice().fill(0.0);
        for quartet in (0..quartets).rev() {
            if quartet + 1 < quartets {
                multiply(work, fourth, sum);
                std::mem::swap(work, sum);
            }
            let [c0, c1, c2, c3] = std::array::from_fn(|i| INVERSE_FACTORIAL[4 * quartet + i + k]);
            let powers = first.as_slice().iter().zip(second.as_slice()).zip(third.as_slice());
            for (sum, ((first, second), third)) in sum.as_mut_slice().iter_mut().zip(powers) {
                *sum += first * c1 + second * c2 + third * c3;
            }
            for i in 0..n {
                sum[(i, i)] += c0;
            }
        }
    }
}

/// Makes `out` the matrix `t I + A B`.
fn plus_product(out: &mut Matrix, t: f64, a: &Matrix, b: &Matrix) {
    multiply(out, a, b);
    for i in 0..a.nrows() {
        out[(i, i)] += t;
    }
}

/// The largest sum of a column's absolute values.
fn norm(a: &Matrix) -> f64 {
    let sum = |column: &[f64]| column.iter().map(|entry| entry.abs()).sum::<f64>();
    a.as_slice().chunks_exact(a.nrows().max(1)).map(sum).fold(0.0, |max, sum| if max >= sum { max } else { sum })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rotation_and_a_nilpotent_have_closed_forms() {
        let turn = Matrix::from_row_slice(2, 2, &[0.0, 1.0, -1.0, 0.0]);
        for angle in [1e-9, 0.3, 2.0, 40.0] {
            let Integrals { transition, constant, slope, .. } = exponential_integrals(&turn, angle);
            let (sin, cos) = libm::sincos(angle);
            let off = |found: &Matrix, expected: [f64; 4]| (found - Matrix::from_row_slice(2, 2, &expected)).amax();
            assert!(off(&transition, [cos, sin, -sin, cos]) < 1e-13, "{angle}");
            assert!(off(&constant, [sin, 1.0 - cos, cos - 1.0, sin]) < 1e-13, "{angle}");
            let (rest, lag) = (1.0 - cos, angle - sin);
            assert!(off(&slope, [rest, lag, -lag, rest]) < 1e-12, "{angle}");
        }
        let shift = Matrix::from_row_slice(2, 2, &[0.0, 1.0, 0.0, 0.0]);
        let Integrals { transition, constant, slope, .. } = exponential_integrals(&shift, 3.0);
        assert_eq!(transition, Matrix::from_row_slice(2, 2, &[1.0, 3.0, 0.0, 1.0]));
        assert_eq!(constant, Matrix::from_row_slice(2, 2, &[3.0, 4.5, 0.0, 3.0]));
        assert_eq!(slope, Matrix::from_row_slice(2, 2, &[4.5, 4.5, 0.0, 4.5]));
    }

    #[test]
    fn a_rate_without_bounds_gives_no_number_and_no_endless_loop() {
        for entry in [f64::INFINITY, 1e307, 1e60, f64::NAN] {
            let Integrals { transition, .. } = exponential_integrals(&Matrix::repeat(2, 2, entry), 3.0);
            assert!(!transition.sum().is_finite(), "{entry}");
        }
    }
}
