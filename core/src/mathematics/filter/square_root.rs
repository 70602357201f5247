//! The unscented Kalman filter on the root of its covariance, predicted and updated by the engine.

use std::borrow::Cow;

use super::kind::time_of_linearised;
use super::moments::Engine;
use super::{Belief, Correction, FilterError, FilterInfo, Gaussian, Noise, Observation, Rule, Step};
use crate::Model;
use crate::mathematics::engine::design::Method;
use crate::mathematics::linalg::{Matrix, lower_root};

/// A Gaussian held as mean and lower triangular root L of its covariance `L Lᵀ`, which no rounding can make indefinite.
///
/// With the unscented rule every covariance is a sum of squares, so that a root is only ever updated by addition. The
/// engine has the arrays.
///
/// Source: van der Merwe and Wan (2001), The square-root unscented Kalman filter for state and parameter-estimation;
/// Kailath, Sayed and Hassibi (2000), *Linear Estimation*, section 12.3 (array algorithms).
#[derive(Clone, Debug)]
pub struct SquareRoot {
    /// Mean and covariance, which follow from the root.
    belief: Gaussian,
    /// Lᵀ, whose columns are the rows of L.
    rows: Matrix,
    /// Copies of both, for an update that is done again.
    kept: Option<(Gaussian, Matrix)>,
    engine: Option<Box<Engine>>,
}

impl SquareRoot {
    /// The root of a Gaussian.
    ///
    /// # Errors
    /// [`FilterError::IndefiniteCovariance`] and [`FilterError::NotFinite`] where it has none.
    pub fn new(belief: &Gaussian) -> Result<Self, FilterError> {
        Ok(Self { belief: belief.clone(), rows: lower_root(&belief.cov)?.transpose(), kept: None, engine: None })
    }

    /// Makes the covariance symmetric to the last bit.
    fn complete(&mut self) {
        self.belief.cov.fill_upper_triangle_with_lower_triangle();
    }
}

/// The engine's method for a model.
fn method(model: &Model) -> Method {
    Method::SquareRoot(Rule::Unscented.of_size(model.size()))
}

impl Belief for SquareRoot {
    fn predict(&mut self, model: &Model, step: Step, noise: &Noise) -> Result<(), FilterError> {
        let Self { belief, rows, engine, .. } = self;
        let single = Engine::of(engine, method(model), model, None).single();
        single.advance(belief.slices_with(rows.as_mut_slice()), &step.of_engine())?;
        single.spread(belief.slices_with(rows.as_mut_slice()), noise.process.as_slice(), noise.fading)?;
        self.complete();
        Ok(())
    }

    fn condition(
        &mut self,
        model: &Model,
        observation: &Observation,
        correction: &mut Correction,
    ) -> Result<(), FilterError> {
        let Self { belief, rows, engine, .. } = self;
        let engine = Engine::of(engine, method(model), model, Some(observation.all_readings()));
        engine.condition(belief.slices_with(rows.as_mut_slice()), observation, correction)?;
        self.complete();
        Ok(())
    }

    fn renew(&mut self, place: usize, variance: f64) -> Result<(), FilterError> {
        // A belief that has never moved has no engine: its covariance is that of the settings.
        let Self { belief, rows, engine, .. } = self;
        match engine {
            Some(engine) => engine.single().renew(belief.slices_with(rows.as_mut_slice()), place, variance),
            None => {
                belief.renew(place, variance);
                *rows = lower_root(&belief.cov)?.transpose();
            }
        }
        self.complete();
        Ok(())
    }

    fn gaussian(&self) -> Cow<'_, Gaussian> {
        Cow::Borrowed(&self.belief)
    }

    fn replace(&mut self, gaussian: &Gaussian) -> Result<bool, FilterError> {
        self.rows = lower_root(&gaussian.cov)?.transpose();
        self.belief.copy_from(gaussian);
        Ok(true)
    }

    fn store(&mut self) -> bool {
        let Self { belief, rows, kept, .. } = self;
        let (kept_belief, kept_rows) = kept.get_or_insert_with(|| (belief.clone(), rows.clone()));
        kept_belief.copy_from(belief);
        kept_rows.copy_from(rows);
        true
    }

    fn restore(&mut self) {
        if let Some((belief, rows)) = &self.kept {
            self.belief.copy_from(belief);
            self.rows.copy_from(rows);
        }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::mathematics::filter::{Adaptation, Filter, Moments};
    use crate::mathematics::linalg::Vector;
    use crate::{Channel, FilterSettings, Hold, InputKind, PlantKind, Quantity};

    /// The largest difference to the UKF over some steps, each component against its standard deviation. The last component is
    /// certain.
    fn difference(
        plant: PlantKind,
        eta: f64,
        sensors: &[Quantity],
        adaptation: Adaptation,
        augment: &[Channel],
    ) -> Result<f64, FilterError> {
        let settings = FilterSettings { eta, augment: augment.to_vec(), ..FilterSettings::default() };
        let model = settings.model(plant, InputKind::default());
        let (channels, n) = (model.channels().to_vec(), model.size());
        let mean = Vector::from_fn(n, |i, _| channels[i].usual().mean);
        let mut std = Vector::from_fn(n, |i, _| 0.1 * channels[i].usual().std);
        std[n - 1] = 0.0;
        let process = Vector::from_fn(n, |i, _| if i % 2 == 0 { 0.0 } else { 1e-4 * std[i] * std[i] });
        let known = [(Quantity::DISPLACEMENT, 1e-4), (Quantity::VELOCITY, 4e-3), (Quantity::ACCELERATION, 1e-2)];
        let variances = known.iter().filter(|(quantity, _)| sensors.contains(quantity)).map(|(_, r)| *r).collect();
        let noise = Noise { process: Matrix::from_diagonal(&process), sensors: variances, fading: 1.003 };
        let belief = Gaussian::independent(mean, &std);
        let root: Box<dyn Belief> = Box::new(SquareRoot::new(&belief)?);
        let points: Box<dyn Belief> = Box::new(Moments::sigma_points(belief, Rule::Unscented));
        let [mut root, mut points] = [root, points]
            .map(|belief| Filter::new(model.clone(), belief, 0.01, Hold::First, noise.clone(), sensors, adaptation));
        let [mut one, mut other] = [Correction::default(), Correction::default()];
        let mut worst = 0.0_f64;
        for k in 0..60 {
            let number = |seed: i32| libm::sin(f64::from(k * k + seed * k));
            let velocity = if k % 7 == 0 { f64::NAN } else { 0.1 * number(5) };
            let measured = [0.01 * number(3), velocity, number(1)];
            for (filter, correction) in [(&mut root, &mut one), (&mut points, &mut other)] {
                filter.predict([number(2), number(4)])?;
                filter.update(number(4), &measured[..sensors.len()], correction)?;
            }
            let (a, b) = (root.belief().gaussian(), points.belief().gaussian());
            let scale = b.cov.diagonal().map(|variance| if variance > 0.0 { variance.sqrt() } else { 1.0 });
            for j in 0..n {
                worst = worst.max((a.mean[j] - b.mean[j]).abs() / scale[j]);
                for i in 0..n {
                    worst = worst.max((a.cov[(i, j)] - b.cov[(i, j)]).abs() / (scale[i] * scale[j]));
                }
            }
            assert_eq!(a.cov.column(n - 1), Vector::zeros(n));
            assert!((one.nis - other.nis).abs() < 1e-9 * other.nis.max(1.0));
        }
        Ok(worst)
    }

    const PLANTS: [PlantKind; 5] =
        [PlantKind::SDOF, PlantKind::DUFFING, PlantKind::BOUC_WEN, PlantKind::SHEAR_2, PlantKind::SHEAR_4];

    #[test]
    fn a_root_squares_to_the_covariance_of_the_ukf() -> Result<(), FilterError> {
        let components = [Quantity::DISPLACEMENT, Quantity::VELOCITY];
        let rates = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];
        for plant in PLANTS {
            for eta in [0.0, 0.02] {
                for sensors in [&components[..], &rates, &rates[2..]] {
                    let off = difference(plant, eta, sensors, Adaptation::default(), &[])?;
                    assert!(off < 1e-11, "{plant:?}, η = {eta}, {sensors:?}: {off}");
                }
            }
        }
        Ok(())
    }

    #[test]
    fn a_reading_of_several_components_is_their_sum() -> Result<(), FilterError> {
        let sensors = [Quantity::DISPLACEMENT, Quantity::VELOCITY, Quantity::ACCELERATION];
        let biases = sensors.map(Quantity::bias);
        for plant in PLANTS {
            for count in 1..=sensors.len() {
                let augment = [&biases[..], &[Channel::INPUT_OFFSET]].concat();
                let off = difference(plant, 0.0, &sensors[..count], Adaptation::default(), &augment)?;
                assert!(off < 1e-11, "{plant:?}, {count} sensors: {off}");
            }
        }
        Ok(())
    }

    #[test]
    fn a_full_process_noise_is_added_too() -> Result<(), FilterError> {
        let learns = Adaptation { process_noise: true, ..Adaptation::default() };
        // The last component has no variance, and an adaptive filter learns zero for it too.
        let off = difference(PlantKind::SDOF, 0.0, &[Quantity::DISPLACEMENT, Quantity::VELOCITY], learns, &[])?;
        assert!(off < 1e-9, "{off}");
        Ok(())
    }

    #[test]
    fn a_component_that_is_drawn_again_knows_nothing_of_the_others() -> Result<(), FilterError> {
        let (mut root, model) = (moved()?, crate::Model::new(PlantKind::SDOF));
        let mut expected = root.gaussian().into_owned();
        for _ in 0..2 {
            expected.renew(1, 0.25);
            root.renew(1, 0.25)?;
            let off = (&root.gaussian().cov - &expected.cov).amax();
            assert!(off < 1e-15 && root.gaussian().mean == expected.mean, "{off}");
            let noise = Noise { process: Matrix::zeros(4, 4), sensors: vec![], fading: 1.0 };
            root.predict(&model, Step { forces: [1.0, 1.0], hold: Hold::Zero, dt: 0.01 }, &noise)?;
            expected = root.gaussian().into_owned();
        }
        Ok(())
    }

    /// A belief whose components know of each other, before its first step.
    fn moved() -> Result<SquareRoot, FilterError> {
        let rows = Matrix::from_fn(4, 4, |i, j| libm::sin((3 * i + 5 * j) as f64));
        SquareRoot::new(&Gaussian { mean: Vector::from_element(4, 1.0), cov: &rows * rows.transpose() })
    }

    #[test]
    fn what_is_no_covariance_has_no_root() {
        let of = |cov| SquareRoot::new(&Gaussian { mean: Vector::zeros(2), cov }).map(|_| ());
        let indefinite = Matrix::from_row_slice(2, 2, &[1.0, 2.0, 2.0, 1.0]);
        assert_eq!(of(indefinite), Err(FilterError::IndefiniteCovariance));
        assert_eq!(of(Matrix::repeat(2, 2, f64::NAN)), Err(FilterError::NotFinite));
    }
}
