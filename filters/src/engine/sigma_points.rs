//! The prediction of UKF and CKF: sigma points, each moved by one Runge-Kutta step.

use super::belief::GaussianBelief;
use super::columns::{Rooted, add_times, lower_root};
use super::design::Rule;
use super::dynamics::Dynamics;
use super::level::{Level, apart, each};
use super::model::{Input, StateModel, Step};
use super::number::{Number, Real};
use super::runge_kutta::RungeKutta;

#[derive(Clone, Debug)]
pub(crate) struct SigmaPoints<T: Number> {
    /// L, n × n. After a step the points' odd parts, n numbers for each pair: of components that do not move they are L.
    pub(super) root: Vec<T>,
    /// The points' even parts: a row of n numbers for each component that moves.
    even: Vec<T>,
    shift: Vec<T>,
    /// The points, n numbers for each pack of them. The centre comes first, then those on both sides of it, pair by pair.
    pub(super) points: Vec<T::Pack>,
    method: RungeKutta<T::Pack>,
    /// The centre, where the other points fill their packs without it.
    pub(super) centre: Vec<T>,
    of_centre: RungeKutta<T>,
}

impl<T: Number> SigmaPoints<T> {
    pub(crate) fn new(model: &StateModel<impl Dynamics>) -> Self {
        let (n, moving) = (model.size, model.moving());
        let zeros = |count: usize| vec![T::of(0.0); count];
        Self {
            root: zeros(n * n),
            even: zeros(moving * n),
            shift: zeros(moving),
            points: vec![T::Pack::of(0.0); Self::packs(n) * n],
            method: RungeKutta::new(model),
            centre: zeros(n),
            of_centre: RungeKutta::new(model),
        }
    }

    /// Carries a belief over a step; returns the lanes for which points can be drawn.
    ///
    /// ```text
    /// χ± = y ± c L e_i,  L Lᵀ = P,  g(χ±) = g(y) + eᵢ ± oᵢ
    /// s = 2 W Σ eᵢ,  y⁻ = g(y) + s,  P⁻ = 2 W Σ (oᵢ oᵢᵀ + eᵢ eᵢᵀ) + o s sᵀ
    /// ```
    ///
    /// The even parts eᵢ and the odd parts oᵢ are about the centre's image. For components that do not move, the odd
    /// parts are `c L` and the even ones zero, so that their covariance stays.
    ///
    /// Source: Julier and Uhlmann (2004), Unscented filtering and nonlinear estimation; Arasaratnam and Haykin (2009), Cubature
    /// Kalman filters.
    #[inline(always)]
    pub(crate) fn advance<L: Level>(
        &mut self,
        level: L,
        rule: Rule,
        model: &StateModel<impl Dynamics>,
        belief: &mut GaussianBelief<T>,
        step: &Step<'_, T>,
    ) -> Rooted<T::Mask> {
        let rooted = apart!(level, self.draw(level, rule, model, belief));
        self.travel(level, model, step);
        apart!(level, {
            self.take_parts(level, rule, model);
            self.sum(level, rule, model, belief);
        });
        rooted
    }

    #[inline(always)]
    pub(super) fn travel<L: Level>(&mut self, level: L, model: &StateModel<impl Dynamics>, step: &Step<'_, T>) {
        if Self::is_apart(level.size(model.size)) {
            let Self { centre, of_centre, .. } = self;
            apart!(level, of_centre.advance(level, model, centre, step));
        }
        let step = step.with(
            #[inline(always)]
            |force| T::pack(|_| force),
        );
        let Self { points, method, .. } = self;
        for points in points.chunks_exact_mut(level.size(model.size)) {
            apart!(level, method.advance(level, model, points, &step));
        }
    }

    /// The points of a pack, and the rates of their moving components under this input.
    #[inline(always)]
    pub(super) fn rate<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        pack: usize,
        input: Input<'_, T::Pack>,
    ) -> (&[T::Pack], &[T::Pack]) {
        let Self { points, method, .. } = self;
        let state = &points[pack * model.size..(pack + 1) * model.size];
        (state, method.rate(level, model, state, input))
    }

    /// The centre, and the rates of its moving components under this input, where it is [apart](Self::is_apart).
    #[inline(always)]
    pub(super) fn rate_of_centre<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        input: Input<'_, T>,
    ) -> (&[T], &[T]) {
        let Self { centre, of_centre, .. } = self;
        (centre, of_centre.rate(level, model, centre, input))
    }

    #[inline(always)]
    pub(super) fn packs(n: usize) -> usize {
        if Self::is_apart(n) { 2 * n / T::POINTS } else { (2 * n + 1).div_ceil(T::POINTS) }
    }

    /// Whether the points but the centre fill their packs: it moves alone then, and n = 4 has two packs, not three.
    #[inline(always)]
    pub(super) fn is_apart(n: usize) -> bool {
        T::POINTS > 1 && (2 * n).is_multiple_of(T::POINTS)
    }

    #[inline(always)]
    fn draw<L: Level>(
        &mut self,
        level: L,
        rule: Rule,
        model: &StateModel<impl Dynamics>,
        belief: &GaussianBelief<T>,
    ) -> Rooted<T::Mask> {
        let n = level.size(model.size);
        let Self { root, points, centre, .. } = self;
        let rooted = lower_root(level, &belief.cov[..n * n], &mut root[..n * n], n);
        let root = &root[..n * n];
        place(
            level,
            rule,
            n,
            &belief.mean,
            points,
            centre,
            #[inline(always)]
            |pair, i| root[pair * n + i],
        );
        rooted
    }

    /// Places the points of a mean and a root, n × n, row by row.
    #[inline(always)]
    pub(super) fn place<L: Level>(&mut self, level: L, rule: Rule, mean: &[T], rows: &[T]) {
        let n = level.size(mean.len());
        let rows = &rows[..n * n];
        place(
            level,
            rule,
            n,
            mean,
            &mut self.points,
            &mut self.centre,
            #[inline(always)]
            |pair, i| rows[i * n + pair],
        );
    }

    #[inline(always)]
    pub(super) fn of_point(points: &[T::Pack], centre: &[T], n: usize, point: usize, i: usize) -> T {
        if Self::is_apart(n) {
            return match point {
                0 => centre[i],
                _ => T::of_pack(points[(point - 1) / T::POINTS * n + i], (point - 1) % T::POINTS),
            };
        }
        T::of_pack(points[point / T::POINTS * n + i], point % T::POINTS)
    }

    /// Takes the odd and even parts of the moving components; with these, `Σ` needs no weights.
    #[inline(always)]
    fn take_parts<L: Level>(&mut self, level: L, rule: Rule, model: &StateModel<impl Dynamics>) {
        let Self { root, even, points, centre, .. } = self;
        let (n, moving) = (level.size(model.size), level.moving(model.moving()));
        let half = 0.5 / rule.spread.sqrt();
        let even = &mut even[..moving * n];
        for point in 0..n {
            for i in 0..moving {
                let of = |point: usize| Self::of_point(points, centre, n, point, i);
                let (high, low) = (of(2 * point + 1), of(2 * point + 2));
                even[i * n + point] = (high + low - of(0) * 2.0) * half;
                root[point * n + i] = (high - low) * half;
            }
        }
    }

    #[inline(always)]
    fn sum<L: Level>(
        &mut self,
        level: L,
        rule: Rule,
        model: &StateModel<impl Dynamics>,
        belief: &mut GaussianBelief<T>,
    ) {
        let Self { root: odd, even, points, shift, centre, .. } = self;
        let (n, moving) = (level.size(model.size), level.moving(model.moving()));
        let (mean, cov) = (&mut belief.mean[..n], &mut belief.cov[..n * n]);
        let (odd, even) = (&odd[..n * n], &even[..moving * n]);
        let shift = &mut shift[..moving];
        let inverse = 1.0 / rule.spread.sqrt();
        for j in 0..moving {
            let mut sum = even[j * n];
            for point in 1..n {
                sum = sum + even[j * n + point];
            }
            shift[j] = sum * inverse;
            mean[j] = Self::of_point(points, centre, n, 0, j) + shift[j];
        }
        for j in 0..moving {
            let column = &mut cov[j * n + j..(j + 1) * n];
            for i in j..n {
                column[i - j] = odd[i] * odd[j];
            }
            // Lanes sum in registers, a lone run several numbers of a column at a time.
            if const { T::LANES == 1 } {
                for point in 1..n {
                    add_times(column, odd[point * n + j], &odd[point * n + j..(point + 1) * n]);
                }
            } else {
                for i in j..n {
                    for point in 1..n {
                        column[i - j] = column[i - j] + odd[point * n + i] * odd[point * n + j];
                    }
                }
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

/// Places points in pairs about a mean. `root` gives a component of the direction of a pair.
#[inline(always)]
fn place<T: Number, L: Level>(
    level: L,
    rule: Rule,
    n: usize,
    mean: &[T],
    points: &mut [T::Pack],
    centre: &mut [T],
    root: impl Fn(usize, usize) -> T,
) {
    let distance = rule.spread.sqrt();
    let packs = SigmaPoints::<T>::packs(n);
    let (mean, points) = (&mean[..n], &mut points[..packs * n]);
    let first = usize::from(SigmaPoints::<T>::is_apart(n));
    if first == 1 {
        centre[..n].copy_from_slice(mean);
    }
    each!(level, 0, packs, |pack| {
        for i in 0..n {
            points[pack * n + i] = T::pack(
                #[inline(always)]
                |k| match pack * T::POINTS + k + first {
                    point if point == 0 || point > 2 * n => mean[i],
                    point if point % 2 == 1 => mean[i] + root((point - 1) / 2, i) * distance,
                    point => mean[i] - root((point - 1) / 2, i) * distance,
                },
            );
        }
    });
}
