//! The square-root UKF: the mean and the lower triangular root L of the covariance `L Lᵀ`, which no rounding makes indefinite.
//!
//! With the unscented rule every covariance is a sum of squares `A Aᵀ`. Householder reflections bring A to a triangle:
//!
//! ```text
//! predict   [√λ a  √λ b  √λ s  √Q] · Householder = [L⁻  0]
//!
//! update    [√R  b  s] · Householder = [√R'  0],   [√R'  a] · Householder = [√S  0   0],   K = C (√S)⁻¹
//!                                                  [ 0   L]                 [C   L⁺  0]
//! ```
//!
//! with the odd parts a and the even parts b of the pairs of points ([`SigmaPoints`]), a column for each pair, and the shift s
//! of the mean; in an update they are those of the readings.
//!
//! Source: van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation; Kailath,
//! Sayed and Hassibi (2000), *Linear Estimation*, section 12.3 (array algorithms).

use super::belief::GaussianBelief;
use super::columns::{Rooted, lower_root, take_times};
use super::design::{Design, Rule};
use super::dynamics::Dynamics;
use super::level::{Count, Level, apart, each};
use super::model::{Input, Reading, StateModel, Step, read};
use super::number::{Mask, Number, Real};
use super::sigma_points::SigmaPoints;

#[derive(Clone, Debug)]
pub(super) struct SquareRoot<T: Number> {
    rule: Rule,
    size: usize,
    moving: usize,
    /// L, n × n, row by row.
    pub(super) rows: Vec<T>,
    points: SigmaPoints<T>,
    /// A, row by row.
    array: Vec<T>,
    /// The even parts, the shift and the noise of the sensors, row by row.
    even: Vec<T>,
    /// Whether all sensors read components, and thus have no even parts.
    is_linear: bool,
    columns: usize,
    /// The triangle of `array`, row by row.
    triangle: Vec<T>,
    /// The readings in the points, a number for each sensor and pack.
    readings: Vec<T::Pack>,
    /// Those in the centre, where it is apart from the packs.
    of_centre: Vec<T>,
}

/// Lanes hold no root, and one version for all sizes is enough: one for each size was a tenth of the crate's compile time.
pub(super) const fn may_have_root<T: Number, L: Level>() -> bool {
    T::LANES == 1 && !L::IS_KNOWN
}

impl<T: Number> SquareRoot<T> {
    pub(super) fn new(model: &StateModel<impl Dynamics>, rule: Rule, sensors: usize) -> Self {
        let (n, moving, zero) = (model.size, model.moving(), T::of(0.0));
        Self {
            rule,
            size: n,
            moving,
            rows: vec![zero; n * n],
            array: vec![zero; (sensors + n) * (sensors + n).max(3 * n + 1)],
            even: vec![zero; sensors * (sensors + n + 1)],
            is_linear: true,
            columns: n,
            triangle: vec![zero; (sensors + n) * (sensors + n)],
            readings: vec![T::Pack::of(0.0); sensors * SigmaPoints::<T>::packs(n)],
            of_centre: vec![zero; sensors],
            points: SigmaPoints::new(model),
        }
    }

    pub(super) fn take<L: Level>(&mut self, level: L, cov: &[T]) -> Rooted<T::Mask> {
        let Self { rows, triangle, .. } = self;
        let n = level.size(self.size);
        let columns = &mut triangle[..n * n];
        let rooted = lower_root(level, cov, columns, n);
        for i in 0..n {
            for k in 0..n {
                rows[i * n + k] = columns[k * n + i];
            }
        }
        rooted
    }

    /// Moves mean and points by a step; [`Self::spread`] makes a root of them.
    #[inline(always)]
    pub(super) fn advance<L: Level>(
        &mut self,
        level: L,
        model: &StateModel<impl Dynamics>,
        belief: &mut GaussianBelief<T>,
        step: &Step<'_, T>,
    ) {
        let Self { rule, points, rows, .. } = self;
        apart!(level, points.place(level, *rule, &belief.mean, rows));
        points.travel(level, model, step);
        apart!(level, self.take_parts(level, belief));
    }

    #[inline(always)]
    fn take_parts<L: Level>(&mut self, level: L, belief: &mut GaussianBelief<T>) {
        let Self { rule, size, moving, points, rows, array, .. } = self;
        let (n, moving) = (level.size(*size), level.moving(*moving));
        let (width, zero) = (3 * n + 1, T::of(0.0));
        let (mean, rows, array) = (&mut belief.mean[..n], &rows[..n * n], &mut array[..n * width]);
        for i in 0..n {
            let (odd, even) = array[i * width..i * width + 2 * n + 1].split_at_mut(n);
            if i < moving {
                let of = |point| SigmaPoints::of_point(&points.points, &points.centre, n, point, i);
                mean[i] = parts(*rule, odd, even, of);
            } else {
                odd.copy_from_slice(&rows[i * n..(i + 1) * n]);
                even.fill(zero);
            }
        }
    }

    /// Makes a root of the points that have moved: of `λ P + Q`, where this writes the root of Q, n numbers of a row.
    #[inline(always)]
    pub(super) fn spread<L: Level>(&mut self, level: L, fading: T, process: impl Fn(usize, &mut [T])) {
        let Self { size, rows, array, .. } = self;
        let n = level.size(*size);
        let (width, fading) = (3 * n + 1, fading.sqrt());
        let array = &mut array[..n * width];
        for i in 0..n {
            let (points, noise) = array[i * width..(i + 1) * width].split_at_mut(2 * n + 1);
            for entry in points {
                *entry = *entry * fading;
            }
            noise.fill(T::of(0.0));
            process(i, noise);
        }
        triangularise(
            level,
            array,
            [0, width],
            #[inline(always)]
            |i| 2 * n + 2 + i,
            rows,
            n,
        );
    }

    pub(super) fn renew<L: Level>(
        &mut self,
        level: L,
        belief: &mut GaussianBelief<T>,
        place: usize,
        [kept, variance]: [T; 2],
    ) {
        let Self { rows, array, .. } = self;
        let (n, zero) = (belief.size(), T::of(0.0));
        for (i, (row, old)) in array.chunks_exact_mut(n + 1).zip(rows.chunks_exact(n)).enumerate() {
            row[..n].copy_from_slice(old);
            row[n] = zero;
            if i == place {
                row.iter_mut().for_each(|entry| *entry = *entry * kept);
                row[n] = variance.sqrt();
            }
        }
        triangularise(level, array, [0, n + 1], |_| n + 1, rows, n);
        belief.mean[place] = belief.mean[place] * kept + zero;
    }

    /// The lower triangle of `P = L Lᵀ`.
    #[inline(always)]
    pub(super) fn square<L: Level>(&self, level: L, cov: &mut [T]) {
        let n = level.size(self.size);
        let (rows, cov) = (&self.rows[..n * n], &mut cov[..n * n]);
        for j in 0..n {
            for i in j..n {
                cov[j * n + i] = along(rows, n, i, j, j + 1);
            }
        }
    }

    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "those of the update")]
    pub(super) fn read<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        design: &Design<impl Dynamics>,
        belief: &GaussianBelief<T>,
        active: &[usize],
        input: Input<'_, T>,
        expected: &mut [T],
    ) {
        self.is_linear = design.readings.iter().all(Reading::is_of_components);
        if !self.is_linear {
            self.read_points(level, design, belief, active, input);
        }
        let Self { rule, size, rows, array, even, columns, readings, of_centre, .. } = self;
        let (n, m, zero) = (level.size(*size), count.number(), T::of(0.0));
        let (width, Design { model, readings: all, .. }) = (m + n, design);
        let (mean, rows) = (&belief.mean[..n], &rows[..n * n]);
        let (sensors, states) = array[..(m + n) * width].split_at_mut(m * width);
        *columns = 0;
        for sensor in 0..m {
            let (noise, odd) = sensors[sensor * width..(sensor + 1) * width].split_at_mut(m);
            let even = &mut even[sensor * (width + 1)..(sensor + 1) * (width + 1)];
            noise.fill(zero);
            even.fill(zero);
            let reading = &all[active[sensor]];
            if reading.is_of_components() {
                expected[sensor] = read(model, reading, mean, &[], input.force);
                apply(reading, rows, odd);
                *columns = reading.components.iter().fold(*columns, |most, &(place, _)| most.max(place + 1));
            } else {
                let packs = SigmaPoints::<T>::packs(n);
                let first = usize::from(SigmaPoints::<T>::is_apart(n));
                let of = |point: usize| match point.checked_sub(first) {
                    None => of_centre[sensor],
                    Some(at) => T::of_pack(readings[sensor * packs + at / T::POINTS], at % T::POINTS),
                };
                expected[sensor] = parts(*rule, odd, &mut even[m..], of);
                *columns = n;
            }
        }
        for i in 0..n {
            let (noise, odd) = states[i * width..(i + 1) * width].split_at_mut(m);
            noise.fill(zero);
            odd.copy_from_slice(&rows[i * n..(i + 1) * n]);
        }
    }

    #[inline(always)]
    fn read_points<L: Level>(
        &mut self,
        level: L,
        design: &Design<impl Dynamics>,
        belief: &GaussianBelief<T>,
        active: &[usize],
        input: Input<'_, T>,
    ) {
        let Self { rule, size, rows, points, readings, of_centre, .. } = self;
        points.place(level, *rule, &belief.mean, rows);
        if SigmaPoints::<T>::is_apart(level.size(*size)) {
            let (state, rate) = points.rate_of_centre(level, &design.model, input);
            for (row, &sensor) in active.iter().enumerate() {
                of_centre[row] = read(&design.model, &design.readings[sensor], state, rate, input.force);
            }
        }
        let input = input.with(T::pack(|_| input.force));
        let packs = SigmaPoints::<T>::packs(level.size(*size));
        for pack in 0..packs {
            let (state, rate) = points.rate(level, &design.model, pack, input);
            for (row, &sensor) in active.iter().enumerate() {
                readings[row * packs + pack] = read(&design.model, &design.readings[sensor], state, rate, input.force);
            }
        }
    }

    /// In lanes without its measurement the row has no information: R = 1, without covariance.
    #[inline(always)]
    pub(super) fn add_noise<L: Level, C: Count>(
        &mut self,
        level: L,
        count: C,
        sensor: usize,
        variance: T,
        is_there: T::Mask,
    ) {
        let Self { size, array, even, is_linear, .. } = self;
        let width = count.number() + level.size(*size);
        let row = &mut array[sensor * width..(sensor + 1) * width];
        let even = &mut even[sensor * (width + 1)..(sensor + 1) * (width + 1)];
        if !is_there.all() {
            for entry in row.iter_mut().chain(&mut *even) {
                *entry = T::select(is_there, *entry, T::of(0.0));
            }
        }
        let std = T::select(is_there, variance.sqrt(), T::of(1.0));
        (if *is_linear { row } else { even })[sensor] = std;
    }

    /// Ends an update: S, m × m, its lower triangle, and `P⁻ Hᵀ`, n × m.
    #[inline(always)]
    pub(super) fn condition<L: Level, C: Count>(&mut self, level: L, count: C, s: &mut [T], cross: &mut [T]) {
        let Self { size, rows, array, even, columns, is_linear, triangle, .. } = self;
        let (n, m) = (level.size(*size), count.number());
        let (joint, columns) = (m + n, *columns);
        let (triangle, rows) = (&mut triangle[..joint * joint], &mut rows[..n * n]);
        let (s, cross) = (&mut s[..m * m], &mut cross[..m * n]);
        if !*is_linear {
            triangularise(level, even, [m, n + 1], |_| n + 1, triangle, m);
            for sensor in 0..m {
                array[sensor * joint..][..m].copy_from_slice(&triangle[sensor * m..(sensor + 1) * m]);
            }
        }
        triangularise(
            level,
            array,
            [m, n],
            #[inline(always)]
            |row| columns.max((row + 1).saturating_sub(m)),
            triangle,
            joint,
        );
        for column in 0..m {
            for row in column..m {
                s[column * m + row] = along(triangle, joint, row, column, column + 1);
            }
            for i in 0..n {
                cross[column * n + i] = along(triangle, joint, m + i, column, column + 1);
            }
        }
        for i in 0..n {
            for k in 0..n {
                rows[i * n + k] = triangle[(m + i) * joint + m + k];
            }
        }
    }
}

#[inline(always)]
pub(super) fn std<T: Number>(variance: T) -> T {
    T::select(variance.is_normal(), variance.sqrt(), T::of(0.0))
}

/// Writes the odd parts of a number of each point to one row, the even parts and the shift to another, and returns the mean.
#[inline(always)]
fn parts<T: Number>(rule: Rule, odd: &mut [T], even: &mut [T], of: impl Fn(usize) -> T) -> T {
    let (n, inverse) = (odd.len(), 1.0 / rule.spread.sqrt());
    let (half, centre) = (0.5 * inverse, of(0));
    let mut shift = T::of(0.0);
    for pair in 0..n {
        let (high, low) = (of(2 * pair + 1), of(2 * pair + 2));
        odd[pair] = (high - low) * half;
        even[pair] = ((high - centre) + (low - centre)) * half;
        shift = shift + even[pair];
    }
    even[n] = shift * inverse;
    centre + even[n]
}

/// `h L` of a sensor that reads components, from L row by row.
#[inline(always)]
fn apply<T: Number>(reading: &Reading, rows: &[T], out: &mut [T]) {
    let n = out.len();
    if let Some(place) = reading.component {
        out.copy_from_slice(&rows[place * n..(place + 1) * n]);
        return;
    }
    out.fill(T::of(0.0));
    for &(place, factor) in &reading.components {
        for k in 0..n {
            out[k] = out[k] + rows[place * n + k] * factor;
        }
    }
}

/// The product of two rows, of their first `length` numbers; rows are `width` numbers long.
#[inline(always)]
fn along<T: Number>(rows: &[T], width: usize, one: usize, other: usize, length: usize) -> T {
    let mut sum = rows[one * width] * rows[other * width];
    for k in 1..length {
        sum = sum + rows[one * width + k] * rows[other * width + k];
    }
    sum
}

/// The product of two rows in sums that do not wait for each other. The first `lead` numbers, and those after whole blocks of a
/// row of `base` more, are summed one by one: no bit changes where columns are left out that are zero.
#[inline(always)]
fn dot<T: Number>(a: &[T], b: &[T], [lead, base]: [usize; 2]) -> T {
    let ((a_lead, a), (b_lead, b)) = (a.split_at(lead), b[..a.len()].split_at(lead));
    let blocks = a.len().min(base / 4 * 4);
    let ((a, a_rest), (b, b_rest)) = (a.split_at(blocks), b.split_at(blocks));
    let mut sums = [T::of(0.0); 4];
    for (a, b) in a.chunks_exact(4).zip(b.chunks_exact(4)) {
        for lane in 0..4 {
            sums[lane] = sums[lane] + a[lane] * b[lane];
        }
    }
    let mut last = T::of(0.0);
    for (a, b) in a_lead.iter().zip(b_lead) {
        last = last + *a * *b;
    }
    for (a, b) in a_rest.iter().zip(b_rest) {
        last = last + *a * *b;
    }
    (sums[0] + sums[2]) + (sums[1] + sums[3]) + last
}

/// The lower triangular root of `A Aᵀ`, row by row. A has `count` rows of `lead + base` numbers and is overwritten. `reach`
/// limits those of the `base` numbers of a row, and of all rows before it, that are not zero.
///
/// The reflections are those of `[0, A]`, with a column of zeros for each of the triangle. A row d and another row x below it give
///
/// ```text
/// [0, d] → [|d|, 0],   [0, x] → [d·x / |d|, x - d (d·x / d·d)]
/// ```
///
/// so that no row waits for a root. A row that is zero, or too small to square, gives a column of zeros: a component known for
/// certain stays so. Source: Golub and Van Loan (2013), *Matrix Computations*, sections 5.1.2 and 5.2.9.
#[inline(always)]
fn triangularise<T: Number, L: Level>(
    level: L,
    array: &mut [T],
    [lead, base]: [usize; 2],
    reach: impl Fn(usize) -> usize,
    triangle: &mut [T],
    count: usize,
) {
    let (width, zero) = (lead + base, T::of(0.0));
    let (array, triangle) = (&mut array[..count * width], &mut triangle[..count * count]);
    each!(level, 0, count, |j| {
        let whole_blocks = reach(j).div_ceil(4) * 4;
        let used = lead + if whole_blocks <= base / 4 * 4 { whole_blocks } else { base };
        let (before, after) = array.split_at_mut((j + 1) * width);
        let own = &before[j * width..j * width + used];
        let square = dot(own, own, [lead, base]);
        // Not a number counts.
        let counts = !square.lt(T::of(f64::MIN_POSITIVE));
        let inverse = T::select(counts, T::of(1.0) / square, zero);
        let length = T::select(counts, square.sqrt(), zero);
        let scale = length * inverse;
        for k in j + 1..count {
            triangle[j * count + k] = zero;
        }
        triangle[j * count + j] = length;
        for i in j + 1..count {
            let row = &mut after[(i - j - 1) * width..(i - j - 1) * width + used];
            let product = dot(own, row, [lead, base]);
            triangle[i * count + j] = product * scale;
            take_times(row, product * inverse, own);
        }
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::lanes::Lanes;
    use crate::engine::level::{Baseline, Known};

    fn square(rows: &[f64], count: usize) -> Vec<f64> {
        let width = rows.len() / count;
        (0..count * count).map(|at| along(rows, width, at / count, at % count, width)).collect()
    }

    fn triangle<L: Level>(level: L, array: &[f64], shape: [usize; 2], count: usize) -> Vec<f64> {
        let mut out = vec![f64::NAN; count * count];
        triangularise(level, &mut array.to_vec(), shape, |_| shape[1], &mut out, count);
        out
    }

    #[test]
    fn a_triangle_squares_to_the_covariance_of_its_array() {
        let array: Vec<f64> = (0..3 * 7).map(|i| libm::sin(f64::from(7 * i))).collect();
        let cov = square(&array, 3);
        for shape in [[0, 7], [1, 6], [2, 5], [5, 2]] {
            let root = triangle(Baseline, &array, shape, 3);
            assert!(square(&root, 3).iter().zip(&cov).all(|(a, b)| (a - b).abs() < 1e-14), "{shape:?}");
            assert!(root[1] == 0.0 && root[2] == 0.0 && root[5] == 0.0, "{shape:?} {root:?}");
            assert!([0, 4, 8].iter().all(|&at| root[at] > 0.0), "{shape:?} {root:?}");
            assert_eq!(root, triangle(Known::<_, 3, 2>(Baseline), &array, shape, 3));
        }
    }

    #[test]
    fn columns_of_zeros_and_other_lanes_change_no_bit() {
        let (n, m) = (6, 2);
        let of = |row: usize, column: usize| {
            let number = libm::sin((13 * row + 5 * column) as f64);
            if column < m + 1 + row { number } else { 0.0 }
        };
        let array: Vec<f64> = (0..n * (m + n)).map(|at| of(at / (m + n), at % (m + n))).collect();
        let [mut short, mut all] = [vec![f64::NAN; n * n], vec![f64::NAN; n * n]];
        triangularise(Baseline, &mut array.clone(), [m, n], |row| row + 1, &mut short, n);
        triangularise(Baseline, &mut array.clone(), [m, n], |_| n, &mut all, n);
        assert_eq!(short, all);
        let mut lanes: Vec<_> = array.iter().map(|&number| Lanes([number, 0.0, f64::NAN, number])).collect();
        let mut out = vec![Lanes([0.0; 4]); n * n];
        triangularise(Baseline, &mut lanes, [m, n], |row| row + 1, &mut out, n);
        let lane = |lane: usize| out.iter().map(|number| number.lane(lane)).collect::<Vec<_>>();
        assert_eq!([lane(0), lane(1), lane(3)], [all.clone(), vec![0.0; n * n], all]);
    }

    #[test]
    fn a_component_without_variance_keeps_none() {
        let root = triangle(Baseline, &[1.0, -0.7, 0.0, 0.0, 0.3, 1e-170], [0, 2], 3);
        let cov = square(&root, 3);
        assert_eq!([cov[1], cov[4], cov[7]], [0.0; 3]);
        assert!((cov[8] - 0.09).abs() < 1e-15);
    }

    #[test]
    fn a_row_that_is_too_large_to_square_does_not_vanish() {
        for number in [1e200, f64::INFINITY, f64::NAN] {
            let root = triangle(Baseline, &[number, 1.0, 1.0, 1.0], [0, 2], 2);
            assert!(!square(&root, 2).iter().sum::<f64>().is_finite(), "{number}");
        }
    }
}
