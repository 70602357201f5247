//! The unscented Kalman filter on the root of its covariance.

use std::borrow::Cow;

use super::correction::Last;
use super::kalman;
use super::kind::time_of_linearised;
use super::{Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Observation, Rule, Step};
use crate::Model;
use crate::mathematics::integrate::RungeKutta;
use crate::mathematics::linalg::{
    Matrix, Vector, add_product, add_to_root, fit, fit_vector, lower_root, multiply_symmetric, multiply_transposed,
    rotate, rotation,
};

/// A Gaussian held as mean and lower triangular root L of its covariance `L Lᵀ`, which no rounding can make indefinite.
///
/// With the unscented rule every covariance is a sum of squares, so that a root is only ever updated by addition,
/// column by column with Givens rotations. The measurement is one such triangularisation of sensors and state together:
///
/// ```text
/// [√R  √W ζ]            [√S   0 ]
/// [ 0  √W ξ] · Givens = [ C   L⁺],   K = C (√S)⁻¹
/// ```
///
/// with the deviations ζ of the readings and ξ of the sigma points, the offset of the mean among them.
///
/// Source: van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation;
/// Kailath, Sayed and Hassibi (2000), *Linear Estimation*, section 12.3 (array algorithms).
#[derive(Clone, Debug)]
pub struct SquareRoot {
    /// Mean and covariance, which follow from the root.
    belief: Gaussian,
    root: Matrix,
    /// The sigma points, and their images.
    points: Matrix,
    readings: Matrix,
    array: Array,
    method: RungeKutta,
    rates: Vec<f64>,
    /// A deviation, and the sum of all.
    deviation: Vec<f64>,
    shift: Vec<f64>,
    /// Q and its root, kept until Q changes.
    process: Option<(Matrix, Matrix)>,
    expected: Vector,
}

impl SquareRoot {
    /// The root of a Gaussian.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where it has none.
    pub fn new(belief: &Gaussian) -> Result<Self, FilterError> {
        let none = || Matrix::zeros(0, 0);
        Ok(Self {
            belief: belief.clone(),
            root: lower_root(&belief.cov)?,
            points: none(),
            readings: none(),
            array: Array { sensors: none(), cross: none(), state: none() },
            method: RungeKutta::default(),
            rates: Vec::new(),
            deviation: Vec::new(),
            shift: Vec::new(),
            process: None,
            expected: Vector::zeros(0),
        })
    }

    /// Draws the sigma points, each a column: the centre, and the pair of each column of the root.
    fn draw(&mut self) {
        let Self { belief: Gaussian { mean, .. }, root, points, .. } = self;
        let n = mean.len();
        let distance = Rule::Unscented.constants(n).0.sqrt();
        fit(points, n, 2 * n + 1);
        let (centre, pairs) = points.as_mut_slice().split_at_mut(n);
        centre.copy_from_slice(mean.as_slice());
        for (pair, column) in pairs.chunks_exact_mut(2 * n).zip(root.as_slice().chunks_exact(n)) {
            let (plus, minus) = pair.split_at_mut(n);
            for i in 0..n {
                let from = column[i] * distance;
                (plus[i], minus[i]) = (centre[i] + from, centre[i] - from);
            }
        }
    }

    /// Makes the covariance that of the root.
    fn square(&mut self) {
        let Self { belief: Gaussian { cov, .. }, root, .. } = self;
        multiply_symmetric(cov, 1.0, root, root);
        cov.fill_upper_triangle_with_lower_triangle();
    }

    /// `P ← λ P + Q`
    fn spread(&mut self, Noise { process, fading, .. }: &Noise) -> Result<(), FilterError> {
        let Self { root, deviation, process: known, .. } = self;
        *root *= fading.sqrt();
        if known.as_ref().is_none_or(|(of, _)| of != process) {
            *known = Some((process.clone(), lower_root(process)?));
        }
        for column in known.iter().flat_map(|(_, root)| root.as_slice().chunks_exact(process.nrows())) {
            deviation.clear();
            deviation.extend_from_slice(column);
            add_to_root(root, deviation);
        }
        Ok(())
    }
}

impl Belief for SquareRoot {
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let n = model.size();
        self.draw();
        let Self { belief: Gaussian { mean, .. }, root, points, method, deviation, shift, .. } = self;
        let (_, weight, _) = Rule::Unscented.constants(n);
        step.advance(model, points, method);
        let (centre, others) = points.as_slice().split_at(n);
        shift.clear();
        shift.resize(n, 0.0);
        root.as_mut_slice().fill(0.0);
        for image in others.chunks_exact(n) {
            take_deviation(deviation, shift, image, centre, weight);
            add_to_root(root, deviation);
        }
        for i in 0..n {
            mean[i] = centre[i] + shift[i];
        }
        add_to_root(root, shift);
        self.spread(noise)?;
        self.square();
        Ok(())
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let (n, m) = (model.size(), observation.len());
        self.draw();
        let Self { belief, root, points, readings, array, rates, deviation, shift, expected, .. } = self;
        let (spread, weight, _) = Rule::Unscented.constants(n);
        observation.read_all_into(model, points, rates, readings);
        let (centre, others) = readings.as_slice().split_at(m);
        array.begin(n, observation);
        shift.clear();
        shift.resize(m, 0.0);
        let distance = (spread * weight).sqrt();
        for (j, reading) in others.chunks_exact(m).enumerate() {
            take_deviation(deviation, shift, reading, centre, weight);
            let sign = if j % 2 == 0 { distance } else { -distance };
            deviation.extend(root.column(j / 2).iter().map(|column| column * sign));
            array.add(deviation);
        }
        fit_vector(expected, m);
        for i in 0..m {
            expected[i] = centre[i] + shift[i];
        }
        shift.resize(m + n, 0.0);
        array.add(shift);

        let Array { sensors, cross, state } = array;
        let Last { innovation, innovation_cov, gain, has_jacobian, factor, .. } = &mut correction.last;
        observation.innovation_into(expected, innovation);
        multiply_transposed(innovation_cov, sensors, sensors);
        innovation_cov.fill_upper_triangle_with_lower_triangle();
        kalman::refactor(factor, innovation_cov)?;
        multiply_transposed(gain, cross, sensors);
        factor.divide_in_place(gain);
        *has_jacobian = false;
        add_product(belief.mean.as_mut_slice(), gain, innovation.as_slice());
        std::mem::swap(root, state);
        correction.report_last(observation.sensors());
        self.square();
        self.belief.check()
    }

    fn renew(&mut self, place: usize, variance: f64) -> Result<(), FilterError> {
        let Self { belief, root, deviation, .. } = self;
        belief.mean[place] = 0.0;
        root.row_mut(place).fill(0.0);
        deviation.clear();
        deviation.resize(root.nrows(), 0.0);
        deviation[place] = variance.sqrt();
        add_to_root(root, deviation);
        self.square();
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        Cow::Borrowed(&self.belief)
    }
}

/// Writes the weighted distance of a point's image from the centre's image to `deviation`, and adds it to `Σ W d`.
fn take_deviation(deviation: &mut Vec<f64>, shift: &mut [f64], image: &[f64], centre: &[f64], weight: f64) {
    let scale = weight.sqrt();
    deviation.clear();
    deviation.extend(image.iter().zip(centre).map(|(image, centre)| (image - centre) * scale));
    for ((shift, image), centre) in shift.iter_mut().zip(image).zip(centre) {
        *shift += (image - centre) * weight;
    }
}

/// The lower triangular root of the joint covariance of m readings and n components.
#[derive(Clone, Debug)]
struct Array {
    sensors: Matrix,
    cross: Matrix,
    state: Matrix,
}

impl Array {
    /// Begins with the sensors' noise alone.
    fn begin(&mut self, n: usize, observation: &Observation) {
        let Self { sensors, cross, state } = self;
        let m = observation.len();
        fit(sensors, m, m);
        fit(cross, n, m);
        fit(state, n, n);
        for part in [&mut *sensors, cross, state] {
            part.as_mut_slice().fill(0.0);
        }
        for (i, variance) in observation.variances().iter().enumerate() {
            sensors[(i, i)] = variance.sqrt();
        }
    }

    /// Rotates a deviation of readings and state into the array. This overwrites the deviation.
    fn add(&mut self, deviation: &mut [f64]) {
        let Self { sensors, cross, state } = self;
        let (m, n) = (sensors.nrows(), state.nrows());
        let (reading, deviation) = deviation.split_at_mut(m);
        let columns = sensors.as_mut_slice().chunks_exact_mut(m).zip(cross.as_mut_slice().chunks_exact_mut(n));
        for (j, (sensors, cross)) in columns.enumerate() {
            if let Some((cos, sin)) = rotation(&mut sensors[j], reading[j]) {
                // `rotation` has already written the rotated number itself.
                rotate(cos, sin, &mut sensors[j + 1..], &mut reading[j + 1..]);
                rotate(cos, sin, cross, deviation);
            } else if !sensors[j].is_finite() {
                return;
            }
        }
        add_to_root(state, deviation);
    }
}

pub(super) static SR_UKF: FilterInfo = FilterInfo {
    key: "sr_ukf",
    name: "SR-UKF",
    description: "a UKF on the root of its covariance, which no rounding makes indefinite",
    reference: "van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation",
    is_sampled: false,
    has_own_likelihood: false,
    evaluations: |_, n| 4 * (2 * n + 1),
    time: |_, n| 4.0 * time_of_linearised(n),
    has_propagation: false,
    begin: |initial, _, _| Ok(Box::new(SquareRoot::new(&initial)?)),
};
