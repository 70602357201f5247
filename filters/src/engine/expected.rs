//! The measurements that a belief expects.

use super::belief::GaussianBelief;
use super::columns::{Rooted, add_times, entry, lower_root};
use super::design::{Design, Method, Rule};
use super::dynamics::Dynamics;
use super::level::{Count, Level, apart};
use super::model::{Derivatives, Input, Reading, StateModel, gradient, read};
use super::number::{Mask, Number};

#[derive(Clone, Debug)]
pub(super) struct ExpectedReadings<T> {
    /// h(y⁻), m numbers.
    pub(super) mean: Vec<T>,
    /// `H P⁻ Hᵀ`, m × m, without noise.
    pub(super) cov: Vec<T>,
    /// `P⁻ Hᵀ`, n × m.
    pub(super) cross: Vec<T>,
    pub(super) is_linear: bool,
    /// The component of each sensor, where all sensors read one component each.
    pub(super) places: Vec<usize>,
    pub(super) are_components: bool,
    /// The rows of H of sensors that read more than components, n numbers for each.
    pub(super) rows: Vec<T>,
    pub(super) derivatives: Derivatives<T>,
    /// Memory for points.
    root: Vec<T>,
    state: Vec<T>,
    high: Vec<T>,
    low: Vec<T>,
    shift: Vec<T>,
}

impl<T: Number> ExpectedReadings<T> {
    pub(super) fn new(model: &StateModel<impl Dynamics>, readings: &[Reading]) -> Self {
        let zeros = |count: usize| vec![T::of(0.0); count];
        let places: Vec<usize> = readings.iter().filter_map(|reading| reading.component).collect();
        let (n, sensors) = (model.size, readings.len());
        Self {
            mean: zeros(sensors),
            cov: zeros(sensors * sensors),
            cross: zeros(sensors * n),
            is_linear: true,
            are_components: places.len() == sensors,
            places,
            rows: zeros(sensors * n),
            derivatives: Derivatives::new(model),
            root: zeros(n * n),
            state: zeros(n),
            high: zeros(sensors),
            low: zeros(sensors),
            shift: zeros(sensors),
        }
    }

    #[inline(always)]
    pub(super) fn size(&self) -> usize {
        self.state.len()
    }

    /// Takes the prediction of some sensors' measurements while this input acts. Sigma points through a linear function
    /// give its exact moments, which H gives for less. Returns the lanes for which points can be drawn.
    #[inline(always)]
    pub(super) fn take<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        design: &Design<impl Dynamics>,
        belief: &GaussianBelief<T>,
        active: &[usize],
        input: Input<'_, T>,
    ) -> Rooted<T::Mask> {
        let rooted = Rooted { holds: T::Mask::of(true), is_finite: T::Mask::of(true) };
        self.is_linear = true;
        if const { L::IS_KNOWN } && self.are_components {
            self.select(level, count, belief, active);
            return rooted;
        }
        if !design.readings.iter().all(Reading::is_of_components) {
            if const { L::HAS_POINTS }
                && let Method::SigmaPoints(rule) | Method::SquareRoot(rule) = design.method
            {
                self.is_linear = false;
                return apart!(level, self.transform(level, rule, design, belief, active, input));
            }
            self.derivatives.take(level, &design.model, &belief.mean, &input);
        }
        apart!(level, self.linearise(level, count, design, belief, active, input.force, None));
        rooted
    }

    #[inline(always)]
    fn select<L: Level, C: Count>(&mut self, level: L, count: C, belief: &GaussianBelief<T>, active: &[usize]) {
        let (n, m) = (level.size(self.size()), count.number());
        let Self { mean, cov, cross, places, .. } = self;
        let (active, mean, cov, cross) = (&active[..m], &mut mean[..m], &mut cov[..m * m], &mut cross[..m * n]);
        let (state, p) = (&belief.mean[..n], &belief.cov[..n * n]);
        for row in 0..m {
            let place = places[active[row]];
            mean[row] = state[place];
            let out = &mut cross[row * n..(row + 1) * n];
            select_column(p, n, place, out);
        }
        for row in 0..m {
            let place = places[active[row]];
            for column in 0..=row {
                cov[column * m + row] = cross[column * n + place];
            }
        }
    }

    /// H of a sensor, n numbers, written over `out`.
    pub(super) fn row_into<'a>(&self, reading: &Reading, row: usize, out: impl Iterator<Item = &'a mut T>)
    where
        T: 'a,
    {
        let n = self.size();
        for (k, entry) in out.enumerate() {
            *entry = T::of(0.0);
            if reading.is_of_components() {
                for &(_, factor) in reading.components.iter().filter(|(place, _)| *place == k) {
                    *entry = *entry + factor;
                }
            } else {
                *entry = self.rows[row * n + k];
            }
        }
    }

    /// The prediction of an EKF: h at the mean, or from another state, `h(at) + H (y⁻ - at)`, and H.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "those of the update")]
    pub(super) fn linearise<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        design: &Design<impl Dynamics>,
        belief: &GaussianBelief<T>,
        active: &[usize],
        force: T,
        at: Option<&[T]>,
    ) {
        let (n, m, Design { model, readings, .. }) = (level.size(self.size()), count.number(), design);
        let Self { mean, cov, cross, rows, derivatives, .. } = self;
        let (active, mean, cov, cross, rows) =
            (&active[..m], &mut mean[..m], &mut cov[..m * m], &mut cross[..m * n], &mut rows[..m * n]);
        let belief = (&belief.mean[..n], &belief.cov[..n * n]);
        for row in 0..m {
            let (reading, range) = (&readings[active[row]], row * n..(row + 1) * n);
            let h = &mut rows[range.clone()];
            let own = if reading.is_of_components() { None } else { at };
            let state = own.unwrap_or(belief.0);
            mean[row] = read(model, reading, state, &derivatives.rate, force);
            if !reading.is_of_components() {
                gradient(model, reading, state, derivatives, force, h);
            }
            if let Some(at) = own {
                for k in 0..n {
                    mean[row] = mean[row] + (belief.0[k] - at[k]) * h[k];
                }
            }
            times_cov(reading, h, belief.1, &mut cross[range]);
        }
        for row in 0..m {
            let (reading, h) = (&readings[active[row]], &rows[row * n..(row + 1) * n]);
            for column in 0..=row {
                cov[column * m + row] = times(model, reading, h, &cross[column * n..(column + 1) * n]);
            }
        }
    }

    /// The prediction of a UKF, by sigma points that are drawn again.
    ///
    /// ```text
    /// h = h(y⁻) + s,  s = Σ W d,  S = Σ W d dᵀ + o s sᵀ,  P⁻ Hᵀ = Σ W (χ - y⁻) dᵀ,  d = h(χ) - h(y⁻)
    /// ```
    #[inline(always)]
    fn transform<L: Level>(
        &mut self,
        level: L,
        rule: Rule,
        design: &Design<impl Dynamics>,
        belief: &GaussianBelief<T>,
        active: &[usize],
        input: Input<'_, T>,
    ) -> Rooted<T::Mask> {
        let Self { mean: expected, cov, cross, derivatives, root, state, high, low, shift, .. } = self;
        let (n, m) = (level.size(state.len()), active.len());
        let (mean, root, state) = (&belief.mean[..n], &mut root[..n * n], &mut state[..n]);
        let Derivatives { rate, plain, .. } = derivatives;
        let rooted = lower_root(level, &belief.cov[..n * n], root, n);
        let distance = rule.spread.sqrt();
        let weight = 0.5 / rule.spread;
        read_all(level, design, active, mean, input, plain, rate, expected);
        shift[..m].fill(T::of(0.0));
        cov[..m * m].fill(T::of(0.0));
        cross[..m * n].fill(T::of(0.0));
        for column in root.chunks_exact(n) {
            for (side, readings) in [(distance, &mut *high), (-distance, &mut *low)] {
                for i in 0..n {
                    state[i] = mean[i] + column[i] * side;
                }
                read_all(level, design, active, state, input, plain, rate, readings);
            }
            for row in 0..m {
                (high[row], low[row]) = (high[row] - expected[row], low[row] - expected[row]);
                shift[row] = shift[row] + (high[row] + low[row]);
                for other in 0..=row {
                    let both = high[row] * high[other] + low[row] * low[other];
                    cov[other * m + row] = cov[other * m + row] + both;
                }
                let across = (high[row] - low[row]) * (weight * distance);
                add_times(&mut cross[row * n..(row + 1) * n], across, column);
            }
        }
        for row in 0..m {
            shift[row] = shift[row] * weight;
            expected[row] = expected[row] + shift[row];
            for other in 0..=row {
                let both = shift[row] * shift[other] * rule.offset;
                cov[other * m + row] = cov[other * m + row] * weight + both;
            }
        }
        rooted
    }
}

/// `h x` of a sensor's row h of H, which counts where the sensor reads more than components, with n numbers x.
#[inline(always)]
fn times<T: Number>(model: &StateModel<impl Dynamics>, reading: &Reading, h: &[T], x: &[T]) -> T {
    if reading.is_of_components() {
        return read(model, reading, x, &[], T::of(0.0));
    }
    let mut sum = T::of(0.0);
    for k in 0..x.len() {
        sum = sum + h[k] * x[k];
    }
    sum
}

/// `P hᵀ` of a sensor's row h of H, n numbers.
#[inline(always)]
pub(super) fn times_cov<T: Number>(reading: &Reading, h: &[T], cov: &[T], out: &mut [T]) {
    let n = out.len();
    if let Some(place) = reading.component {
        select_column(cov, n, place, out);
    } else if reading.is_of_components() {
        for i in 0..n {
            let mut sum = T::of(0.0);
            for &(place, factor) in &reading.components {
                sum = sum + entry(cov, n, i, place) * factor;
            }
            out[i] = sum;
        }
    } else {
        for i in 0..n {
            let mut sum = entry(cov, n, i, 0) * h[0];
            for k in 1..n {
                sum = sum + entry(cov, n, i, k) * h[k];
            }
            out[i] = sum;
        }
    }
}

/// A column of a symmetric n × n matrix. The compiler may know the first ones.
#[inline(always)]
pub(super) fn select_column<T: Copy>(cov: &[T], n: usize, place: usize, out: &mut [T]) {
    match place {
        0 => copy_column(cov, n, 0, out),
        1 => copy_column(cov, n, 1, out),
        _ => copy_column(cov, n, place, out),
    }
}

#[inline(always)]
fn copy_column<T: Copy>(a: &[T], n: usize, j: usize, out: &mut [T]) {
    for i in 0..n {
        out[i] = entry(a, n, i, j);
    }
}

#[inline(always)]
#[expect(clippy::too_many_arguments, reason = "slices of one memory, which cannot be borrowed together")]
fn read_all<T: Number, L: Level>(
    level: L,
    design: &Design<impl Dynamics>,
    active: &[usize],
    state: &[T],
    input: Input<'_, T>,
    plain: &mut [T],
    rate: &mut [T],
    readings: &mut [T],
) {
    design.model.rate(level, state, input, plain, rate);
    for (row, &sensor) in active.iter().enumerate() {
        readings[row] = read(&design.model, &design.readings[sensor], state, rate, input.force);
    }
}
