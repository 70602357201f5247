//! The update: a belief conditioned on the measurements of one sample.

mod descent;

use descent::Descent;

use super::belief::GaussianBelief;
use super::columns::{Rooted, add_times, divide, factor, lower_root, mirror, square, subtract_products, take_times};
use super::design::{Design, Method};
use super::dynamics::Dynamics;
use super::expected::{ExpectedReadings, select_column, times_cov};
use super::level::{Baseline, Count, Exactly, Level, apart, each};
use super::model::Input;
use super::number::{Mask, Number};
use super::passage::Passage;
use super::square_root::{SquareRoot, may_have_root};
use super::weights::Innovations;
use crate::FilterError;
use crate::filter_error::of_root;

#[derive(Clone, Copy, Debug)]
pub struct UpdateResult<T: Number> {
    /// `eᵀ S⁻¹ e`; zero without a measurement.
    pub nis: T,
    /// det S; one without a measurement.
    pub determinant: T,
    /// m, the number of measurements.
    pub measured: T,
    /// The lanes for which the last step holds.
    pub holds: T::Mask,
}

/// The belief that an update conditions, with the root of its covariance if it has one, and whether the step holds.
pub(super) struct Target<'a, T: Number, P> {
    pub(super) design: &'a Design<P>,
    pub(super) belief: &'a mut GaussianBelief<T>,
    pub(super) root: Option<&'a mut SquareRoot<T>>,
    pub(super) checks: &'a mut Checks<T::Mask>,
}

#[derive(Clone, Copy, Debug)]
pub(super) struct MeasuredReadings<'a, T> {
    /// The recorded input meanwhile.
    pub(super) input: Input<'a, T>,
    pub(super) measured: &'a [T],
    pub(super) variances: &'a [T],
}

#[derive(Clone, Debug)]
pub struct Update<T> {
    pub active: Vec<usize>,
    expected: ExpectedReadings<T>,
    /// S, m × m, and its factor.
    pub(super) innovation_cov: Vec<T>,
    pub(super) factor: Vec<T>,
    /// e, whitened in the end.
    pub(super) innovation: Vec<T>,
    pub(super) white: Vec<T>,
    variances: Vec<T>,
    /// K, n × m.
    pub(super) gain: Vec<T>,
    excess: Vec<T>,
    descent: Option<Box<Descent<T>>>,
    pub(super) passage: Option<Box<Passage<T>>>,
}

impl<T: Number> Update<T> {
    pub(super) fn new(Design { model, readings, method, .. }: &Design<impl Dynamics>) -> Self {
        let (n, sensors) = (model.size, readings.len());
        let zeros = |count: usize| vec![T::of(0.0); count];
        let iterates = matches!(method, Method::Linearised(_, 2..));
        Self {
            active: Vec::with_capacity(sensors),
            expected: ExpectedReadings::new(model, readings),
            innovation_cov: zeros(sensors * sensors),
            factor: zeros(sensors * sensors),
            innovation: zeros(sensors),
            white: zeros(sensors),
            variances: zeros(sensors),
            gain: zeros(sensors * n),
            excess: zeros(sensors * n),
            descent: iterates.then(|| Box::new(Descent::new(n))),
            passage: None,
        }
    }

    #[inline(always)]
    pub(super) fn condition<L: Level>(
        &mut self,
        level: L,
        target: &mut Target<'_, T, impl Dynamics>,
        observation: MeasuredReadings<'_, T>,
    ) -> UpdateResult<T> {
        if self.descent.is_none() && self.passage.is_none() {
            return self.condition_once(level, target, observation);
        }
        self.descend(level.plain(), target, observation)
    }

    #[inline(always)]
    fn condition_once<L: Level>(
        &mut self,
        level: L,
        target: &mut Target<'_, T, impl Dynamics>,
        observation: MeasuredReadings<'_, T>,
    ) -> UpdateResult<T> {
        let active = &mut self.active;
        let measured = observation.measured;
        let mut is_whole = active.len() == measured.len();
        for value in measured {
            is_whole &= !(!value.is_number()).all();
        }
        if !is_whole {
            gather(active, observation.measured);
        }
        match active.len() {
            0 => apart!(level, without_readings(level, target)),
            1 if const { L::IS_KNOWN } => self.condition_counted(level, Exactly::<1>, target, observation),
            2 if const { L::IS_KNOWN } => self.condition_counted(level, Exactly::<2>, target, observation),
            // More are rare: each count has its own copy of all that follows, and these share one for all sizes.
            count => self.condition_counted(level.plain(), count, target, observation),
        }
    }

    #[inline(always)]
    fn condition_counted<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        target: &mut Target<'_, T, impl Dynamics>,
        observation: MeasuredReadings<'_, T>,
    ) -> UpdateResult<T> {
        if const { may_have_root::<T, L>() }
            && let Some(root) = target.root.take()
        {
            let result = apart!(level, self.rotate(level, count, target, root, observation));
            target.root = Some(root);
            return result;
        }
        let Self { active, expected, .. } = self;
        let Target { design, belief, checks, .. } = target;
        checks.expected = expected.take(level, count, design, belief, active, observation.input);
        apart!(level, {
            let measured = self.compare(level, count, observation);
            self.correct(level, count, design, belief, measured, checks)
        })
    }

    #[inline(always)]
    fn rotate<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        target: &mut Target<'_, T, impl Dynamics>,
        root: &mut SquareRoot<T>,
        observation: MeasuredReadings<'_, T>,
    ) -> UpdateResult<T> {
        let Self { active, expected, innovation_cov, innovation, variances, .. } = self;
        let Target { design, belief, checks, .. } = target;
        let (m, zero) = (count.number(), T::of(0.0));
        let (active, innovation, mean) = (&active[..m], &mut innovation[..m], &mut expected.mean[..m]);
        expected.is_linear = false;
        root.read(level, count, design, belief, active, observation.input, mean);
        let mut measured = zero;
        for row in 0..m {
            let (value, variance) = (observation.measured[active[row]], observation.variances[active[row]]);
            let is_there = value.is_number();
            measured = measured + T::select(is_there, T::of(1.0), zero);
            innovation[row] = T::select(is_there, value - mean[row], zero);
            variances[row] = T::select(is_there, variance, T::of(1.0));
            root.add_noise(level, count, row, variance, is_there);
        }
        root.condition(level, count, innovation_cov, &mut expected.cross);
        let scores = self.weigh(level, count, belief, checks);
        root.square(level, &mut belief.cov);
        result(level, belief, scores, measured, checks)
    }

    /// `e = z - h(y⁻)` and `S = H P⁻ Hᵀ + R`; returns m. Where a lane lacks a measurement, e = 0, R = 1, without covariance.
    #[inline(always)]
    fn compare<L: Level, C: Count>(&mut self, level: L, count: C, observation: MeasuredReadings<'_, T>) -> T {
        let Self { active, expected, innovation_cov: s, innovation, variances, .. } = self;
        let (m, n) = (count.number(), level.size(expected.size()));
        let (zero, one) = (T::of(0.0), T::of(1.0));
        let mut number = zero;
        let (active, innovation, variances) = (&active[..m], &mut innovation[..m], &mut variances[..m]);
        let (s, mean) = (&mut s[..m * m], &expected.mean[..m]);
        s.copy_from_slice(&expected.cov[..m * m]);
        for row in 0..m {
            let value = observation.measured[active[row]];
            let is_there = value.is_number();
            innovation[row] = value - mean[row];
            variances[row] = observation.variances[active[row]];
            if is_there.all() {
                number = number + one;
                continue;
            }
            number = number + T::select(is_there, one, zero);
            innovation[row] = T::select(is_there, innovation[row], zero);
            variances[row] = T::select(is_there, variances[row], one);
            for cross in &mut expected.cross[row * n..(row + 1) * n] {
                *cross = T::select(is_there, *cross, zero);
            }
            for other in 0..m {
                s[other * m + row] = T::select(is_there, s[other * m + row], zero);
                s[row * m + other] = T::select(is_there, s[row * m + other], zero);
            }
        }
        for row in 0..m {
            s[row * m + row] = s[row * m + row] + variances[row];
        }
        number
    }

    /// `K = P⁻ Hᵀ S⁻¹`, `y = y⁻ + K e` and the covariance.
    #[inline(always)]
    fn correct<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        design: &Design<impl Dynamics>,
        belief: &mut GaussianBelief<T>,
        measured: T,
        checks: &mut Checks<T::Mask>,
    ) -> UpdateResult<T> {
        let scores = self.weigh(level, count, belief, checks);
        if self.expected.is_linear {
            self.joseph(level, count, design, belief);
        } else {
            // Sigma points have no H, of which Joseph's form is made.
            self.subtract(level, count, belief);
        }
        result(level, belief, scores, measured, checks)
    }

    /// `K = P⁻ Hᵀ S⁻¹` and `y = y⁻ + K e`. Returns NIS and det S.
    ///
    /// Source: Kalman (1960), A new approach to linear filtering and prediction problems.
    #[inline(always)]
    fn weigh<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        belief: &mut GaussianBelief<T>,
        checks: &mut Checks<T::Mask>,
    ) -> [T; 2] {
        let Self { expected, innovation_cov, factor: lower, innovation, white, gain, .. } = self;
        let (m, n) = (count.number(), level.size(belief.size()));
        let gain = &mut gain[..m * n];
        lower[..m * m].copy_from_slice(&innovation_cov[..m * m]);
        let lower = &mut lower[..m * m];
        let (determinant, factored) = factor(lower, m);
        let cross = &expected.cross[..m * n];
        // One by one: a page would call its browser to copy more than a few.
        each!(level, 0, m * n, |i| gain[i] = cross[i]);
        divide(lower, m, gain, n);
        for row in 0..m {
            add_times(&mut belief.mean[..n], innovation[row], &gain[row * n..(row + 1) * n]);
        }
        white[..m].copy_from_slice(&innovation[..m]);
        let nis = square(lower, m, &mut white[..m]);
        (checks.factored, checks.is_likely) = (factored, nis.is_finite());
        if const { T::LANES == 1 } {
            mirror(Baseline, &mut innovation_cov[..m * m], m);
        }
        [nis, determinant]
    }

    /// Replaces P by `(I - K H) P (I - K H)ᵀ + K R Kᵀ`, which stays positive semidefinite even if sensors are far more
    /// precise than the belief; written as two updates of the sensors' rank:
    ///
    /// ```text
    /// M = P - K (P Hᵀ)ᵀ,  P⁺ = M - (M Hᵀ - K R) Kᵀ
    /// ```
    ///
    /// Source: Bucy and Joseph (1968), *Filtering for Stochastic Processes with Applications to Guidance*.
    #[inline(always)]
    fn joseph<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        design: &Design<impl Dynamics>,
        belief: &mut GaussianBelief<T>,
    ) {
        let Self { active, expected, variances, gain, excess, .. } = self;
        let (m, n) = (count.number(), level.size(belief.size()));
        let (cov, gain, excess) = (&mut belief.cov[..n * n], &gain[..m * n], &mut excess[..m * n]);
        let (active, variances) = (&active[..m], &variances[..m]);
        subtract_products(cov, gain, &expected.cross, n, m);
        for row in 0..m {
            let sensor = active[row];
            let (excess, gain) = (&mut excess[row * n..(row + 1) * n], &gain[row * n..(row + 1) * n]);
            if const { L::IS_KNOWN } && expected.are_components {
                select_column(cov, n, expected.places[sensor], excess);
            } else {
                times_cov(&design.readings[sensor], &expected.rows[row * n..(row + 1) * n], cov, excess);
            }
            take_times(excess, variances[row], gain);
        }
        subtract_products(cov, excess, gain, n, m);
    }

    #[inline(always)]
    fn subtract<L: Level, C: Count>(&mut self, level: L, count: C, belief: &mut GaussianBelief<T>) {
        let Self { innovation_cov: s, gain, excess, .. } = self;
        let (m, n) = (count.number(), level.size(belief.size()));
        for row in 0..m {
            let excess = &mut excess[row * n..(row + 1) * n];
            excess.fill(T::of(0.0));
            for k in 0..m {
                let entry = if k >= row { s[row * m + k] } else { s[k * m + row] };
                add_times(excess, entry, &gain[k * n..(k + 1) * n]);
            }
        }
        subtract_products(&mut belief.cov[..n * n], excess, gain, n, m);
    }

    /// e, m numbers; S, m × m, in lanes only its lower triangle; K, n × m.
    pub fn parts(&self) -> [&[T]; 3] {
        let m = self.active.len();
        let n = self.expected.size();
        [&self.innovation[..m], &self.innovation_cov[..m * m], &self.gain[..m * n]]
    }

    pub(super) fn innovations(&self) -> Innovations<'_, T> {
        let Self { active, innovation, innovation_cov, factor, variances, .. } = self;
        let m = active.len();
        Innovations {
            sensors: active,
            innovation: &innovation[..m],
            innovation_cov: &innovation_cov[..m * m],
            factor: &factor[..m * m],
            variances: &variances[..m],
        }
    }

    /// S of a lane, and the innovation, of the sensors that measure in it.
    pub(super) fn of_lane(&self, lane: usize) -> (Vec<f64>, Vec<f64>) {
        let m = self.active.len();
        let cov = self.innovation_cov[..m * m].iter().map(|entry| entry.lane(lane)).collect();
        (cov, self.innovation[..m].iter().map(|e| e.lane(lane)).collect())
    }

    /// ln det S of a lane, which is a number even where the determinant is none.
    #[cold]
    pub fn ln_determinant(&self, lane: usize) -> f64 {
        let m = self.active.len();
        -(0..m).map(|row| libm::log(self.factor[row * m + row].lane(lane))).sum::<f64>()
    }
}

#[inline(never)]
fn gather<T: Number>(active: &mut Vec<usize>, measured: &[T]) {
    active.clear();
    active.extend((0..measured.len()).filter(|&sensor| !(!measured[sensor].is_number()).all()));
}

#[inline(always)]
fn result<T: Number, L: Level>(
    level: L,
    belief: &GaussianBelief<T>,
    [nis, determinant]: [T; 2],
    measured: T,
    checks: &mut Checks<T::Mask>,
) -> UpdateResult<T> {
    [checks.is_finite, checks.is_positive] = belief.check(level);
    UpdateResult { nis, determinant, measured, holds: checks.all() }
}

#[inline(always)]
fn without_readings<T: Number, L: Level>(level: L, target: &mut Target<'_, T, impl Dynamics>) -> UpdateResult<T> {
    let Target { belief, root, checks, .. } = target;
    if const { may_have_root::<T, L>() }
        && let Some(root) = root
    {
        root.square(level, &mut belief.cov);
    }
    **checks = Checks { predicted: checks.predicted, ..Checks::new() };
    result(level, belief, [T::of(0.0), T::of(1.0)], T::of(0.0), checks)
}

/// Why a step does not hold.
#[derive(Clone, Copy, Debug)]
pub(super) struct Checks<M> {
    /// Sigma points can be drawn for the prediction.
    pub(super) predicted: Rooted<M>,
    /// Sigma points can be drawn for the update.
    pub(super) expected: Rooted<M>,
    pub(super) factored: M,
    pub(super) is_finite: M,
    pub(super) is_positive: M,
    pub(super) is_likely: M,
}

impl<M: Mask> Checks<M> {
    pub(super) fn new() -> Self {
        let yes = M::of(true);
        let rooted = Rooted { holds: yes, is_finite: yes };
        Self { predicted: rooted, expected: rooted, factored: yes, is_finite: yes, is_positive: yes, is_likely: yes }
    }

    #[inline(always)]
    pub(super) fn all(&self) -> M {
        let Self { predicted, expected, factored, is_finite, is_positive, is_likely } = *self;
        predicted.holds & expected.holds & factored & is_finite & is_positive & is_likely
    }

    pub(super) fn but_likely(&self) -> M {
        Self { is_likely: M::of(true), ..*self }.all()
    }

    /// The first part that does not hold for a lane. `update` gives S of that lane with its size, and the innovation.
    pub(super) fn reason(&self, lane: usize, update: &dyn Fn() -> (Vec<f64>, Vec<f64>)) -> FilterError {
        for rooted in [self.predicted, self.expected] {
            if !rooted.holds.lane(lane) {
                return of_root(rooted.is_finite.lane(lane), FilterError::IndefiniteCovariance);
            }
        }
        if !self.factored.lane(lane) {
            let (cov, innovation) = update();
            let rooted = lower_root(Baseline, &cov, &mut vec![0.0; cov.len()], innovation.len());
            return if rooted.holds {
                FilterError::SingularInnovation
            } else {
                of_root(rooted.is_finite, FilterError::IndefiniteInnovation)
            };
        }
        if !self.is_finite.lane(lane) {
            FilterError::NotFinite
        } else if !self.is_positive.lane(lane) {
            FilterError::IndefiniteCovariance
        } else if update().1.iter().all(|innovation| innovation.is_finite()) {
            FilterError::ImpossibleMeasurement
        } else {
            FilterError::NotFinite
        }
    }
}
