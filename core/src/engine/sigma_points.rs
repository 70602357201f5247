//! The prediction of UKF and CKF: sigma points, each moved by one Runge-Kutta step.

use super::belief::Belief;
use super::columns::{Rooted, add_times, lower_root};
use super::design::Rule;
use super::level::Level;
use super::model::Model;
use super::number::{Number, Real};
use super::runge_kutta::RungeKutta;
use super::step::Step;

/// Memory in which sigma points are drawn and moved.
#[derive(Clone, Debug)]
pub struct SigmaPoints<T: Number> {
    /// L, n × n. Of the components that move, the points' odd parts take its place.
    root: Vec<T>,
    /// The points' even parts: a row of n numbers for each component that moves.
    even: Vec<T>,
    /// What moves, of the centre and then of the points on both sides of it, pair by pair.
    images: Vec<T>,
    shift: Vec<T>,
    /// Some points, and the memory in which they move.
    state: Vec<T::Pack>,
    method: RungeKutta<T::Pack>,
}

impl<T: Number> SigmaPoints<T> {
    /// Memory for a model.
    pub fn new(model: &Model) -> Self {
        let (n, moving) = (model.size, model.moving());
        let zeros = |count: usize| vec![T::of(0.0); count];
        Self {
            root: zeros(n * n),
            even: zeros(moving * n),
            images: zeros(moving * (2 * n + 1)),
            shift: zeros(moving),
            state: vec![T::Pack::of(0.0); n],
            method: RungeKutta::new(model),
        }
    }

    /// Carries a belief over a step; returns the lanes for which points can be drawn.
    ///
    /// ```text
    /// χ± = y ± c L e_i,  L Lᵀ = P,  g(χ±) = g(y) + eᵢ ± oᵢ
    /// s = 2 W Σ eᵢ,  y⁻ = g(y) + s,  P⁻ = 2 W Σ (oᵢ oᵢᵀ + eᵢ eᵢᵀ) + o s sᵀ
    /// ```
    ///
    /// The even parts eᵢ and the odd parts oᵢ are about the centre's image. In what does not move the odd parts are `c L` and
    /// the even ones zero, so that its covariance stays.
    ///
    /// Source: Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation; Arasaratnam and Haykin (2009), Cubature
    /// Kalman filters.
    #[inline(always)]
    pub fn advance<L: Level>(
        &mut self,
        level: L,
        rule: Rule,
        model: &Model,
        belief: &mut Belief<T>,
        step: &Step<T>,
    ) -> Rooted<T::Mask> {
        let n = level.size(model.size);
        let rooted = level.apart(
            #[inline(always)]
            || lower_root(&belief.cov[..n * n], &mut self.root[..n * n], n),
        );
        for first in (0..=2 * n).step_by(T::POINTS) {
            self.move_pack(level, rule, model, &belief.mean, first, step);
        }
        level.apart(
            #[inline(always)]
            || {
                self.take_parts(level, rule, model);
                self.sum(level, rule, model, belief);
            },
        );
        rooted
    }

    /// The odd parts of the points after a step, n numbers for each pair.
    pub fn odd(&self) -> &[T] {
        &self.root
    }

    /// Moves as many points as go at once, from the first of them on. The centre comes first, then the points on both sides of
    /// it, pair by pair.
    #[inline(always)]
    fn move_pack<L: Level>(&mut self, level: L, rule: Rule, model: &Model, mean: &[T], first: usize, step: &Step<T>) {
        let Self { root, images, state, method, .. } = self;
        let (n, moving) = (level.size(model.size), level.moving(model.moving()));
        let distance = rule.spread.sqrt();
        level.apart(
            #[inline(always)]
            || {
                let (mean, root, state) = (&mean[..n], &root[..n * n], &mut state[..n]);
                for i in 0..n {
                    state[i] = T::pack(
                        #[inline(always)]
                        |k| match first + k {
                            point if point == 0 || point > 2 * n => mean[i],
                            point if point % 2 == 1 => mean[i] + root[(point - 1) / 2 * n + i] * distance,
                            point => mean[i] - root[(point - 1) / 2 * n + i] * distance,
                        },
                    );
                }
                let forces = step.forces.map(
                    #[inline(always)]
                    |force| T::pack(|_| force),
                );
                method.advance(level, model, state, &Step { forces, has_slope: step.has_slope, dt: step.dt });
                for (k, image) in images[first * moving..].chunks_exact_mut(moving).take(T::POINTS).enumerate() {
                    for i in 0..moving {
                        image[i] = T::of_pack(state[i], k);
                    }
                }
            },
        );
    }

    /// Takes the odd and even parts of what moves, by which `Σ` needs no weights.
    #[inline(always)]
    fn take_parts<L: Level>(&mut self, level: L, rule: Rule, model: &Model) {
        let Self { root, even, images, .. } = self;
        let (n, moving) = (level.size(model.size), level.moving(model.moving()));
        let half = 0.5 / rule.spread.sqrt();
        let (centre, pairs) = images[..moving * (2 * n + 1)].split_at(moving);
        let even = &mut even[..moving * n];
        for (point, pair) in pairs.chunks_exact(2 * moving).enumerate() {
            for i in 0..moving {
                let (high, low) = (pair[i], pair[moving + i]);
                even[i * n + point] = (high + low - centre[i] * 2.0) * half;
                root[point * n + i] = (high - low) * half;
            }
        }
    }

    /// The mean and covariance of the points that have moved.
    #[inline(always)]
    fn sum<L: Level>(&mut self, level: L, rule: Rule, model: &Model, belief: &mut Belief<T>) {
        let Self { root: odd, even, images, shift, .. } = self;
        let (n, moving) = (level.size(model.size), level.moving(model.moving()));
        let (mean, cov) = (&mut belief.mean[..n], &mut belief.cov[..n * n]);
        let (odd, even) = (&odd[..n * n], &even[..moving * n]);
        let (centre, shift) = (&images[..moving], &mut shift[..moving]);
        let inverse = 1.0 / rule.spread.sqrt();
        for j in 0..moving {
            let mut sum = even[j * n];
            for point in 1..n {
                sum = sum + even[j * n + point];
            }
            shift[j] = sum * inverse;
            mean[j] = centre[j] + shift[j];
        }
        for j in 0..moving {
            let column = &mut cov[j * n + j..(j + 1) * n];
            for i in j..n {
                column[i - j] = odd[i] * odd[j];
            }
            for point in 1..n {
                add_times(column, odd[point * n + j], &odd[point * n + j..(point + 1) * n]);
            }
            for i in j..moving {
                let mut sum = column[i - j];
                for point in 0..n {
                    sum = sum + even[i * n + point] * even[j * n + point];
                }
                column[i - j] = sum + shift[i] * shift[j] * rule.offset;
            }
        }
    }
}
