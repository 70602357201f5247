//! Least squares: linear, and by steps of Levenberg and Marquardt.

use crate::engine::columns;

/// The normal equations `A x = b` of N unknowns, with `A = Σ w r rᵀ` and `b = Σ w r v` of rows r with values v and weights w.
#[derive(Clone, Copy, Debug)]
pub struct NormalEquations<const N: usize> {
    /// The columns of A, whose lower triangle counts.
    normal: [[f64; N]; N],
    right: [f64; N],
}

impl<const N: usize> NormalEquations<N> {
    pub const fn zero() -> Self {
        Self { normal: [[0.0; N]; N], right: [0.0; N] }
    }

    pub fn add(&mut self, row: [f64; N], value: f64, weight: f64) {
        for (j, (column, right)) in self.normal.iter_mut().zip(&mut self.right).enumerate() {
            let share = weight * row[j];
            column.iter_mut().zip(&row).skip(j).for_each(|(sum, other)| *sum += share * other);
            *right += share * value;
        }
    }

    /// With `(1 + damping) A + floor` on the diagonal of A: the step is shorter, and towards the steepest descent. Source:
    /// Marquardt (1963), An algorithm for least-squares estimation of nonlinear parameters.
    pub fn damped(mut self, damping: f64, floor: f64) -> Self {
        for i in 0..N {
            self.normal[i][i] = self.normal[i][i] * (1.0 + damping) + floor;
        }
        self
    }

    /// x, or `None` where A is not positive definite.
    pub fn solution(mut self) -> Option<[f64; N]> {
        divide(self.normal.as_flattened_mut(), &mut self.right, 1).then_some(self.right)
    }

    /// The diagonal of A⁻¹: the variances of x if those of the values are 1 / w. `None` where A is not positive definite.
    pub fn variances(mut self) -> Option<[f64; N]> {
        let (mut inverse, mut variances) = ([[0.0; N]; N], [0.0; N]);
        (0..N).for_each(|i| inverse[i][i] = 1.0);
        let is_definite = divide(self.normal.as_flattened_mut(), inverse.as_flattened_mut(), N);
        (0..N).for_each(|i| variances[i] = inverse[i][i]);
        is_definite.then_some(variances)
    }
}

/// The least cost that steps of Levenberg and Marquardt reach, and where: after `tries`, or where one gains less than `least_gain`.
///
/// `look` gives the cost at a point and what else is known there; `equations` are of a step, damped with this `floor`; `step` takes it.
///
/// Source: Levenberg (1944), A method for the solution of certain non-linear problems in least squares; Marquardt (1963).
pub fn descend<P, K, const N: usize>(
    start: P,
    (tries, floor): (usize, f64),
    least_gain: impl Fn(f64) -> f64,
    look: impl Fn(&P) -> (f64, K),
    equations: impl Fn(&P, &K) -> NormalEquations<N>,
    step: impl Fn(&P, [f64; N]) -> Option<P>,
) -> (f64, P) {
    let (mut cost, known) = look(&start);
    let (mut normal, mut at, mut damping) = (equations(&start, &known), start, 1e-3);
    for _ in 0..tries {
        let Some(next) = normal.damped(damping, floor).solution().and_then(|by| step(&at, by)) else { break };
        let (next_cost, known) = look(&next);
        if next_cost < cost {
            let gain = cost - next_cost;
            (at, cost) = (next, next_cost);
            damping *= 0.1;
            if gain < least_gain(cost) {
                break;
            }
            normal = equations(&at, &known);
        } else {
            damping *= 10.0;
            if damping > 1e9 {
                break;
            }
        }
    }
    (cost, at)
}

/// `X A⁻¹` in place of X of some rows. Returns whether A is positive definite.
fn divide(normal: &mut [f64], x: &mut [f64], rows: usize) -> bool {
    let n = x.len() / rows;
    let (_, is_definite) = columns::factor(normal, n);
    columns::divide(normal, n, x, rows);
    is_definite
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_parabola_is_found_and_the_variances_are_those_of_the_inverse() {
        let mut equations = NormalEquations::<3>::zero();
        for t in [-2.0, -1.0, 0.0, 1.0, 2.0] {
            equations.add([1.0, t, t * t], 3.0 - t + 0.5 * t * t, 4.0);
        }
        let [a, b, c] = equations.solution().unwrap();
        assert!((a - 3.0).abs() + (b + 1.0).abs() + (c - 0.5).abs() < 1e-14);
        // A = 4 [5, 0, 10; 0, 10, 0; 10, 0, 34]
        let [a, b, c] = equations.variances().unwrap();
        assert!((a - 34.0 / 280.0).abs() + (b - 0.025).abs() + (c - 1.0 / 56.0).abs() < 1e-15, "{a} {b} {c}");
    }

    #[test]
    fn what_the_rows_do_not_determine_has_no_solution_unless_it_is_damped() {
        let mut equations = NormalEquations::<2>::zero();
        equations.add([1.0, 1.0], 2.0, 1.0);
        assert_eq!((equations.solution(), equations.variances()), (None, None));
        assert!(equations.damped(1e-3, 1e-9).solution().is_some_and(|[a, b]| (a - b).abs() < 1e-12));
        equations.add([f64::NAN, 0.0], 0.0, 1.0);
        assert_eq!(equations.solution(), None);
    }
}
