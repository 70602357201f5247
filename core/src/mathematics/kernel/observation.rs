//! The measurements of one sample.

use crate::mathematics::kernel::MAX_SENSORS;
use crate::mathematics::kernel::gaussian::{Matrix, Vector};
use crate::mathematics::kernel::model::{Model, Output};

/// A sensor that has delivered a measurement: where it reads, its place among the sensors, its variance.
#[derive(Clone, Copy, Debug)]
pub(super) struct Active {
    pub(super) sensor: usize,
    pub(super) output: Output,
    pub(super) variance: f64,
}

/// The M measurements of one sample that are not missing.
#[derive(Clone, Copy, Debug)]
pub struct Observation<const M: usize> {
    pub(super) active: [Active; M],
    pub(super) values: Vector<M>,
    pub(super) force: f64,
    /// The number of measurements; the rest of a padded observation reads zero with a variance of one.
    pub(super) count: usize,
}

impl<const M: usize> Observation<M> {
    /// The readings of the sensors in a state.
    #[inline]
    pub(super) fn read<P: Model<N>, const N: usize>(&self, model: &P, state: &Vector<N>) -> Vector<M> {
        let count = self.count();
        if let Some(components) = self.components() {
            return Vector::from_fn(|row, _| if row < count { state[components[row]] } else { 0.0 });
        }
        let rate = model.rate(state, self.force);
        Vector::from_fn(|row, _| match self.active[row].output {
            _ if row >= count => 0.0,
            Output::State(i) => state[i],
            Output::Rate(i) => rate[i],
        })
    }

    /// The number of measurements. Only observations of [`MAX_SENSORS`] rows are padded; for the others it is a
    /// constant.
    #[inline]
    pub(super) fn count(&self) -> usize {
        if M < MAX_SENSORS { M } else { self.count }
    }

    /// The measurements, without the padding.
    #[inline]
    pub(super) fn measured(&self) -> &[Active] {
        &self.active[..self.count()]
    }

    /// The component of the state that each sensor reads, if every sensor reads one.
    #[inline]
    pub(super) fn components(&self) -> Option<[usize; M]> {
        let mut components = [0; M];
        for (component, sensor) in components.iter_mut().zip(self.measured()) {
            let Output::State(i) = sensor.output else { return None };
            *component = i;
        }
        Some(components)
    }

    /// Adds R to a covariance of the readings.
    #[inline]
    pub(super) fn add_noise(&self, cov: &mut Matrix<M, M>) {
        for (row, sensor) in self.active.iter().enumerate() {
            cov[(row, row)] += sensor.variance;
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::mathematics::filter::{Adaptation, FilterError, Rule};
    use crate::mathematics::kernel::gaussian::{Gaussian, Matrix, Vector};
    use crate::mathematics::kernel::model::{Model, Output};
    use crate::mathematics::kernel::plant::{ALL, Visitor, visit};
    use crate::mathematics::kernel::{Belief, Correction, Filter, Linearised, Noise, SigmaPoints};

    /// A belief with padded observations.
    struct Padded<B>(B);

    impl<P: Model<N>, B: Belief<P, N>, const N: usize> Belief<P, N> for Padded<B> {
        const PADDED: bool = true;

        fn predict(&mut self, model: &P, force: f64, dt: f64, noise: &Noise<N>) -> Result<(), FilterError> {
            self.0.predict(model, force, dt, noise)
        }

        fn condition<const M: usize>(
            &mut self,
            model: &P,
            observation: &super::Observation<M>,
            correction: &mut Correction<N>,
        ) -> Result<(), FilterError> {
            self.0.condition(model, observation, correction)
        }

        fn gaussian(&self) -> std::borrow::Cow<'_, Gaussian<N>> {
            self.0.gaussian()
        }
    }

    /// All numbers of a filter and its padded twin over some steps.
    struct Twins(Vec<Option<Output>>);

    impl Visitor for Twins {
        type Output = [Vec<f64>; 6];

        fn visit<P: Model<N>, const N: usize>(self, model: P) -> [Vec<f64>; 6] {
            let Self(outputs) = self;
            let mean = Vector::<N>::from_fn(|i, _| P::CHANNELS[i].usual().mean);
            let std = Vector::<N>::from_fn(|i, _| 0.1 * P::CHANNELS[i].usual().std);
            let process = Matrix::from_diagonal(&(std.component_mul(&std) * 1e-4));
            let noise = Noise { process, sensors: vec![1e-4, 4e-3, 1e-2], fading: 1.003 };
            let belief = || Gaussian::independent(mean, &std);
            let linearised = |iterations| Linearised::new(belief(), iterations);
            let points = || SigmaPoints::new(belief(), Rule::Unscented);
            [
                run(&model, linearised(1), &noise, &outputs),
                run(&model, Padded(linearised(1)), &noise, &outputs),
                run(&model, linearised(3), &noise, &outputs),
                run(&model, Padded(linearised(3)), &noise, &outputs),
                run(&model, points(), &noise, &outputs),
                run(&model, Padded(points()), &noise, &outputs),
            ]
        }
    }

    fn run<P: Model<N>, B: Belief<P, N>, const N: usize>(
        model: &P,
        belief: B,
        noise: &Noise<N>,
        outputs: &[Option<Output>],
    ) -> Vec<f64> {
        let mut filter =
            Filter::new(model.clone(), belief, 0.01, noise.clone(), outputs.to_vec(), Adaptation::default());
        let mut correction = Correction::NOTHING;
        let mut all = Vec::new();
        for k in 0..60 {
            let number = |seed: i32| libm::sin(f64::from(k * k + seed * k));
            let measured = [0.01 * number(3), if k % 7 == 0 { f64::NAN } else { 0.1 * number(5) }, number(1)];
            filter.predict(number(2)).unwrap();
            filter.update(number(2), &measured, &mut correction).unwrap();
            let gaussian = filter.belief().gaussian();
            all.extend(gaussian.mean.iter().chain(gaussian.cov.iter()));
            all.extend(correction.gain.as_flattened());
            all.extend([correction.nis, correction.determinant]);
            all.extend(correction.innovation.iter().chain(correction.innovation_cov.as_flattened()));
        }
        all
    }

    #[test]
    fn a_padded_update_has_the_bits_of_the_other() {
        let components = vec![Some(Output::State(0)), Some(Output::State(1)), Some(Output::State(0))];
        let rates = vec![Some(Output::State(0)), Some(Output::State(1)), Some(Output::Rate(1))];
        for kind in ALL {
            for outputs in [&components, &rates] {
                let runs = visit(kind, 0.0, Twins(outputs.clone())).expect("the plant has a kernel");
                for pair in runs.chunks(2) {
                    // NaN where a sensor was skipped; a zero may have either sign.
                    let same = |a: &f64, b: &f64| a == b || (a.is_nan() && b.is_nan());
                    assert_eq!(pair[0].len(), pair[1].len());
                    assert!(pair[0].iter().zip(&pair[1]).all(|(a, b)| same(a, b)), "{kind:?}, {outputs:?}");
                }
            }
        }
    }
}
