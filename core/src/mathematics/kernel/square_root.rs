//! The unscented Kalman filter on the root of its covariance.

use std::borrow::Cow;

use super::kalman::{factor, report};
use super::{Belief, Correction, Noise, Observation};
use crate::mathematics::filter::{FilterError, Rule};
use crate::mathematics::kernel::gaussian::{Gaussian, Matrix, Reflection, Vector, add_to_root, lower_root, square};
use crate::mathematics::kernel::model::{Model, Output};

/// A Gaussian held as mean and lower triangular root L of its covariance `L Lᵀ`, which no rounding can make indefinite.
///
/// With the unscented rule every covariance is a sum of squares, so that a root is only ever updated by addition. Sums
/// over pairs of points (as in [`super::SigmaPoints`]) make arrays that Householder reflections bring to triangles,
/// first those of the parts b and s, which only moving components and accelerometers have:
///
/// ```text
/// [√Q, √λ b, √λ s, √λ a] · Householder = [L⁻, 0],  columns of a and b a pair of points each
///
/// [√R  b  s  a]               [√S   0 ]
/// [ 0  0  0  L] · Householder = [ C   L⁺],   K = C (√S)⁻¹,  a and b of the readings
/// ```
///
/// Source: van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation;
/// Kailath, Sayed and Hassibi (2000), *Linear Estimation*, section 12.3 (array algorithms).
#[derive(Clone, Debug)]
pub struct SquareRoot<const N: usize> {
    mean: Vector<N>,
    root: Matrix<N, N>,
}

impl<const N: usize> SquareRoot<N> {
    /// The root of a Gaussian.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] where it has none.
    pub fn new(belief: &Gaussian<N>) -> Result<Self, FilterError> {
        Ok(Self { mean: belief.mean, root: lower_root(&belief.cov)? })
    }

    /// Checks that the numbers of the belief are valid.
    ///
    /// # Errors
    /// [`FilterError::NotFinite`].
    fn check(&self) -> Result<(), FilterError> {
        // No covariance is larger than the larger of its two variances.
        let variances: f64 = self.root.data.0.as_flattened().iter().map(|l| l * l).sum();
        if (self.mean.sum() + variances).is_finite() { Ok(()) } else { Err(FilterError::NotFinite) }
    }
}

/// The square roots of a diagonal Q. `None` if Q is not diagonal, as in an adaptive filter, or has an entry without a
/// root.
#[inline]
fn diagonal_root<const N: usize>(process: &Matrix<N, N>) -> Option<Vector<N>> {
    let diagonal = process.diagonal();
    let is_variance = |q: f64| q == 0.0 || (q > 0.0 && q.is_normal());
    let is_diagonal = (1..N).all(|j| (0..j).all(|i| process[(i, j)] == 0.0 && process[(j, i)] == 0.0));
    (is_diagonal && diagonal.iter().all(|&q| is_variance(q))).then(|| diagonal.map(f64::sqrt))
}

/// Adds a Q that is not diagonal.
#[cold]
#[inline(never)]
fn add_process<const N: usize>(root: &mut Matrix<N, N>, process: &Matrix<N, N>) -> Result<(), FilterError> {
    add_to_root(root, &mut lower_root(process)?.transpose(), N);
    Ok(())
}

/// The mean and the pairs of points after a step, one a row, so that one component of all points is a column.
struct Pairs<const N: usize> {
    centre: Vector<N>,
    high: Matrix<N, N>,
    low: Matrix<N, N>,
}

/// Moves the points `y ± distance L e_i` by a step.
#[inline]
fn move_pairs<P: Model<N>, const N: usize>(
    model: &P,
    mean: &Vector<N>,
    root: &Matrix<N, N>,
    distance: f64,
    force: f64,
    dt: f64,
) -> Pairs<N> {
    let [mut high, mut low] = [Matrix::<N, N>::zeros(); 2];
    for j in 0..N {
        for i in 0..N {
            let step = root[(j, i)] * distance;
            high[(i, j)] = mean[j] + step;
            low[(i, j)] = mean[j] - step;
        }
    }
    let centre = model.runge_kutta_step(mean, force, dt);
    let high = model.runge_kutta_steps(&high, force, dt);
    let low = model.runge_kutta_steps(&low, force, dt);
    Pairs { centre, high, low }
}

impl<P: Model<N>, const N: usize> Belief<P, N> for SquareRoot<N> {
    const PADDED: bool = true;

    #[inline]
    fn predict(&mut self, model: &P, force: f64, dt: f64, noise: &Noise<N>) -> Result<(), FilterError> {
        let Self { mean, root } = self;
        let distance = Rule::Unscented.constants(N).0.sqrt();
        let Pairs { centre, high, low } = move_pairs(model, mean, root, distance, force, dt);
        let fading = noise.fading.sqrt();
        let inverse = 1.0 / distance;
        let half = 0.5 * inverse;
        let moving = if model.eta() == 0.0 { P::MOTION } else { N };
        // Parameters that do not decay keep their rows of the root.
        let mut odd = root.transpose() * fading;
        for j in 0..moving {
            for i in 0..N {
                odd[(i, j)] = (high[(i, j)] - low[(i, j)]) * (half * fading);
            }
        }
        let mut even = high;
        let mut shift = Matrix::<1, N>::zeros();
        *mean = centre;
        for j in 0..P::MOTION {
            for i in 0..N {
                even[(i, j)] = (high[(i, j)] + low[(i, j)] - 2.0 * centre[j]) * half;
            }
            shift[j] = even.column(j).sum() * inverse;
            mean[j] += shift[j];
            shift[j] *= fading;
        }
        even *= fading;
        let process = diagonal_root(&noise.process);
        *root = Matrix::from_diagonal(&process.unwrap_or_else(Vector::zeros));
        add_to_root(root, &mut even, P::MOTION);
        add_to_root(root, &mut shift, P::MOTION);
        add_to_root(root, &mut odd, N);
        if process.is_none() { add_process(root, &noise.process) } else { Ok(()) }
    }

    #[inline]
    fn condition<const M: usize>(
        &mut self,
        model: &P,
        observation: &Observation<M>,
        correction: &mut Correction<N>,
    ) -> Result<(), FilterError> {
        let Self { mean, root } = self;
        let mut state = root.transpose();
        let Readings { mean: expected, root: mut sensors, mut odd } = read(model, mean, &state, observation);
        let mut cross = Matrix::<N, M>::zeros();
        // Padding has no deviation.
        for j in 0..observation.count {
            let Some(reflection) = Reflection::new(sensors[(j, j)], odd.data.0[j]) else { continue };
            sensors[(j, j)] = reflection.length();
            if reflection.length() == f64::INFINITY {
                break;
            }
            for i in j + 1..observation.count {
                reflection.apply(&mut sensors.data.0[j][i], &mut odd.data.0[i]);
            }
            for i in 0..N {
                reflection.apply(&mut cross.data.0[j][i], &mut state.data.0[i]);
            }
        }
        let innovation = observation.values - expected;
        let innovation_cov = sensors * sensors.transpose();
        let factor = factor(&innovation_cov, M)?;
        let gain = factor.divide(&(cross * sensors.transpose()));
        *mean += gain * innovation;
        *root = Matrix::zeros();
        add_to_root(root, &mut state, N);
        report(observation.measured(), &innovation, &innovation_cov, &factor, &gain, correction);
        self.check()
    }

    fn gaussian(&self) -> Cow<'_, Gaussian<N>> {
        Cow::Owned(Gaussian { mean: self.mean, cov: square(&self.root) })
    }
}

/// The expectation of M readings, before the state's own part has been added to their root.
struct Readings<const N: usize, const M: usize> {
    mean: Vector<M>,
    /// The root of `R + b bᵀ + s sᵀ`.
    root: Matrix<M, M>,
    /// a, a pair of points a row.
    odd: Matrix<N, M>,
}

/// Readings of points drawn from the state with the transposed root `rows`.
#[inline]
fn read<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    mean: &Vector<N>,
    rows: &Matrix<N, N>,
    observation: &Observation<M>,
) -> Readings<N, M> {
    let noise = Vector::<M>::from_fn(|row, _| observation.active[row].variance.sqrt());
    let mut readings =
        Readings { mean: Vector::zeros(), root: Matrix::from_diagonal(&noise), odd: Matrix::<N, M>::zeros() };
    let mut is_linear = true;
    for (row, sensor) in observation.measured().iter().enumerate() {
        match sensor.output {
            Output::State(i) => {
                readings.mean[row] = mean[i];
                readings.odd.set_column(row, &rows.column(i));
            }
            Output::Rate(_) => is_linear = false,
        }
    }
    if !is_linear {
        read_rates(model, mean, rows, observation, &mut readings);
    }
    readings
}

/// Adds the readings that are rates, which need the sigma points.
#[inline(never)]
fn read_rates<P: Model<N>, const N: usize, const M: usize>(
    model: &P,
    mean: &Vector<N>,
    rows: &Matrix<N, N>,
    observation: &Observation<M>,
    readings: &mut Readings<N, M>,
) {
    let distance = Rule::Unscented.constants(N).0.sqrt();
    let inverse = 1.0 / distance;
    let half = 0.5 * inverse;
    let centre = model.rate(mean, observation.force);
    let mut even = Matrix::<N, M>::zeros();
    let mut shift = Matrix::<1, M>::zeros();
    for point in 0..N {
        let step = rows.row(point).transpose() * distance;
        let high = model.rate(&(mean + step), observation.force);
        let low = model.rate(&(mean - step), observation.force);
        for (row, sensor) in observation.measured().iter().enumerate() {
            if let Output::Rate(i) = sensor.output {
                readings.odd[(point, row)] = (high[i] - low[i]) * half;
                even[(point, row)] = ((high[i] - centre[i]) + (low[i] - centre[i])) * half;
                shift[row] += even[(point, row)] * inverse;
            }
        }
    }
    for (row, sensor) in observation.measured().iter().enumerate() {
        if let Output::Rate(i) = sensor.output {
            readings.mean[row] = centre[i] + shift[row];
        }
    }
    add_to_root(&mut readings.root, &mut even, observation.count);
    add_to_root(&mut readings.root, &mut shift, observation.count);
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PlantKind;
    use crate::mathematics::filter::Adaptation;
    use crate::mathematics::kernel::plant::{ALL, Visitor, visit};
    use crate::mathematics::kernel::{Filter, SigmaPoints};

    /// The largest difference to the UKF over some steps, each component against its standard deviation.
    struct Difference(Vec<Option<Output>>, Adaptation);

    impl Visitor for Difference {
        type Output = f64;

        fn visit<P: Model<N>, const N: usize>(self, model: P) -> f64 {
            let Self(outputs, adaptation) = self;
            let mean = Vector::<N>::from_fn(|i, _| P::CHANNELS[i].usual().mean);
            let mut std = Vector::<N>::from_fn(|i, _| 0.1 * P::CHANNELS[i].usual().std);
            std[N - 1] = 0.0;
            let process = Vector::<N>::from_fn(|i, _| if i % 2 == 0 { 0.0 } else { 1e-4 * std[i] * std[i] });
            let noise =
                Noise { process: Matrix::from_diagonal(&process), sensors: vec![1e-4, 4e-3, 1e-2], fading: 1.003 };
            let belief = Gaussian::independent(mean, &std);
            let root = SquareRoot::new(&belief).unwrap();
            let points = SigmaPoints::new(belief, Rule::Unscented);
            let mut root = Filter::new(model.clone(), root, 0.01, noise.clone(), outputs.clone(), adaptation);
            let mut points = Filter::new(model, points, 0.01, noise, outputs, adaptation);
            let (mut one, mut other) = (Correction::NOTHING, Correction::NOTHING);
            let mut worst = 0.0_f64;
            for k in 0..60 {
                let number = |seed: i32| libm::sin(f64::from(k * k + seed * k));
                let measured = [0.01 * number(3), if k % 7 == 0 { f64::NAN } else { 0.1 * number(5) }, number(1)];
                root.predict(number(2)).unwrap();
                points.predict(number(2)).unwrap();
                root.update(number(2), &measured, &mut one).unwrap();
                points.update(number(2), &measured, &mut other).unwrap();
                let (a, b) = (Belief::<P, N>::gaussian(root.belief()), Belief::<P, N>::gaussian(points.belief()));
                let scale = b.cov.diagonal().map(|variance| if variance > 0.0 { variance.sqrt() } else { 1.0 });
                for j in 0..N {
                    worst = worst.max((a.mean[j] - b.mean[j]).abs() / scale[j]);
                    for i in 0..N {
                        worst = worst.max((a.cov[(i, j)] - b.cov[(i, j)]).abs() / (scale[i] * scale[j]));
                    }
                }
                assert_eq!(a.cov.column(N - 1), Vector::<N>::zeros());
                assert!((one.nis - other.nis).abs() < 1e-9 * other.nis.max(1.0));
            }
            worst
        }
    }

    #[test]
    fn a_root_squares_to_the_covariance_of_the_ukf() {
        let components = vec![Some(Output::State(0)), Some(Output::State(1))];
        let rates = vec![Some(Output::State(0)), Some(Output::State(1)), Some(Output::Rate(1))];
        for kind in ALL {
            for eta in [0.0, 0.02] {
                for outputs in [&components, &rates] {
                    let difference = Difference(outputs.clone(), Adaptation::default());
                    let off = visit(kind, eta, difference).expect("the plant has a kernel");
                    assert!(off < 1e-11, "{kind:?}, η = {eta}, {outputs:?}: {off}");
                }
            }
        }
    }

    #[test]
    fn a_full_process_noise_is_added_too() {
        let learns = Adaptation { process_noise: true, ..Adaptation::default() };
        // The last component has no variance, and an adaptive filter learns zero for it too.
        let outputs = vec![Some(Output::State(0)), Some(Output::State(1))];
        let off = visit(PlantKind::SDOF, 0.0, Difference(outputs, learns)).expect("the plant has a kernel");
        assert!(off < 1e-9, "{off}");
    }
}
