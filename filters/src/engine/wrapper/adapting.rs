//! Noise that is learnt from the innovations.

use super::{Learnt, Readings, Recursion, Span, Wrapper};
use crate::engine::dynamics::Dynamics;
use crate::engine::filter::GaussianFilter;
use crate::engine::number::Number;
use crate::engine::update::UpdateResult;
use crate::filter::adaptation::Adaptation;
use crate::filter::learning::Learning;

/// A filter that learns R, Q or both, as [`Adaptation`] has it.
pub struct Adapting<T>(Learning<T>);

impl<T: Number> Adapting<T> {
    /// Where Q is learnt, it becomes a whole matrix.
    pub fn of<P: Dynamics>(
        adaptation: Adaptation,
        filter: &mut GaussianFilter<T, P>,
    ) -> Option<Box<dyn Wrapper<T, P>>> {
        if adaptation.process_noise {
            filter.fill_process_noise();
        }
        let (n, dt) = (filter.belief.size(), filter.design.dt);
        adaptation.is_on().then(|| Box::new(Self(Learning::new(adaptation, n, &filter.noise.sensors, dt))) as _)
    }
}

impl<T: Number, P: Dynamics> Wrapper<T, P> for Adapting<T> {
    fn predict(&mut self, inner: &mut dyn Recursion<T, P>, span: Span<T>) {
        self.0.sample += 1;
        inner.predict(span);
    }

    fn update(&mut self, inner: &mut dyn Recursion<T, P>, readings: Readings<'_, T>) -> UpdateResult<T> {
        let result = inner.update(readings);
        if self.0.learns_now() {
            let GaussianFilter { noise, update, design, .. } = inner.filter();
            let (innovations, [.., gain]) = (update.innovations(), update.parts());
            let white = design.white.map(|(place, _)| place);
            if self.0.adaptation.process_noise {
                let has_measured = T::of(0.0).lt(result.measured);
                self.0.adapt_process(&innovations, gain, has_measured, (&mut noise.matrix, white));
            }
            if self.0.adaptation.sensor_noise {
                self.0.adapt_sensors(&innovations, readings.measured, &mut noise.sensors);
            }
        }
        result
    }

    fn report<'a>(&'a self, learnt: &mut Learnt<'a, T>) {
        learnt.uncertainty = Some(&self.0.uncertainty);
    }
}
