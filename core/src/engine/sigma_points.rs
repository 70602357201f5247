//! The prediction of UKF and CKF: sigma points, each moved by one Runge-Kutta step.

use super::belief::Belief;
use super::columns::{Rooted, lower_root};
use super::design::Rule;
use super::level::Level;
use super::model::Model;
use super::number::Number;
use super::runge_kutta::RungeKutta;
use super::step::Step;

/// Memory in which sigma points are drawn and moved.
#[derive(Clone, Debug)]
pub struct SigmaPoints<T> {
    /// L, n × n. Of the components that move, the points' odd parts take its place.
    root: Vec<T>,
    /// The points' even parts: a row of n numbers for each component that moves.
    even: Vec<T>,
    centre: Vec<T>,
    high: Vec<T>,
    low: Vec<T>,
    shift: Vec<T>,
    method: RungeKutta<T>,
}

impl<T: Number> SigmaPoints<T> {
    /// Memory for a model.
    pub fn new(model: &Model) -> Self {
        let (n, moving) = (model.size, model.moving());
        let zeros = |count: usize| vec![T::of(0.0); count];
        Self {
            root: zeros(n * n),
            even: zeros(moving * n),
            centre: zeros(n),
            high: zeros(n),
            low: zeros(n),
            shift: zeros(moving),
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
        let n = model.size;
        let rooted = level.apart(
            #[inline(always)]
            || lower_root(&belief.cov, &mut self.root, n),
        );
        self.centre.copy_from_slice(&belief.mean);
        self.move_centre(level, model, step);
        for point in 0..n {
            self.move_pair(level, rule, model, &belief.mean, point, step);
        }
        level.apart(
            #[inline(always)]
            || self.sum(rule, model, belief),
        );
        rooted
    }

    /// The odd parts of the points after a step, n numbers for each pair.
    pub fn odd(&self) -> &[T] {
        &self.root
    }

    #[inline(always)]
    fn move_centre<L: Level>(&mut self, level: L, model: &Model, step: &Step<T>) {
        let Self { centre, method, .. } = self;
        level.apart(
            #[inline(always)]
            || method.advance(model, centre, step),
        );
    }

    /// Moves the points on both sides of the mean; takes their odd and even parts, by which `Σ` needs no weights.
    #[inline(always)]
    fn move_pair<L: Level>(&mut self, level: L, rule: Rule, model: &Model, mean: &[T], point: usize, step: &Step<T>) {
        let Self { root, even, centre, high, low, method, .. } = self;
        let (n, moving) = (model.size, model.moving());
        let distance = rule.spread.sqrt();
        let half = 0.5 / distance;
        level.apart(
            #[inline(always)]
            || {
                let column = &mut root[point * n..(point + 1) * n];
                for i in 0..n {
                    let far = column[i] * distance;
                    (high[i], low[i]) = (mean[i] + far, mean[i] - far);
                }
                for state in [&mut *high, &mut *low] {
                    method.advance(model, state, step);
                }
                for i in 0..moving {
                    even[i * n + point] = (high[i] + low[i] - centre[i] * 2.0) * half;
                    column[i] = (high[i] - low[i]) * half;
                }
            },
        );
    }

    /// The mean and covariance of the points that have moved.
    #[inline(always)]
    fn sum(&mut self, rule: Rule, model: &Model, belief: &mut Belief<T>) {
        let Self { root: odd, even, centre, shift, .. } = self;
        let (n, moving, Belief { mean, cov }) = (model.size, model.moving(), belief);
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
            for i in j..n {
                let mut sum = odd[i] * odd[j];
                for point in 1..n {
                    sum = sum + odd[point * n + i] * odd[point * n + j];
                }
                if i < moving {
                    for point in 0..n {
                        sum = sum + even[i * n + point] * even[j * n + point];
                    }
                    sum = sum + shift[i] * shift[j] * rule.offset;
                }
                cov[j * n + i] = sum;
            }
        }
    }
}
