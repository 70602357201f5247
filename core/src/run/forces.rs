//! Recorded forces on single masses, besides the input on all of them, by the places of a model's state.

use kalmanscope_filters::filter::{ForceOn, Input};
use kalmanscope_filters::{Channel, ForcedMass, Hold};
use kalmanscope_records::Record;
use kalmanscope_records::record::Parts;

/// The forces on the masses that a model has.
#[derive(Clone, Debug, Default)]
pub(crate) struct Forces {
    on: Vec<ForceOn>,
    masses: Vec<ForcedMass>,
    is_held: bool,
}

/// The inputs at both ends of a part of a step, the input and the readings after it.
pub(crate) struct PartInputs<'a> {
    pub(crate) share: f64,
    pub(crate) ends: [Input<'a>; 2],
    pub(crate) now: Input<'a>,
    pub(crate) readings: &'a [f64],
}

impl Forces {
    pub(crate) fn of(channels: &[Channel], masses: &[ForcedMass], hold: Hold) -> Self {
        let place = |mass: &ForcedMass| Some((Channel::velocity(mass.mass()).place_in(channels)?, *mass));
        let (places, masses): (Vec<usize>, _) = masses.iter().filter_map(place).unzip();
        let on = places.into_iter().map(|place| ForceOn { place, ends: [0.0; 2] }).collect();
        Self { on, masses, is_held: hold == Hold::Zero }
    }

    /// Takes the values at the samples before `k` and at `k`, recorded `delay` samples before.
    pub(crate) fn take(&mut self, record: &Record, k: usize, delay: i32) {
        if !self.on.is_empty() {
            record.forces_to(k, delay, &self.masses, &mut self.on);
        }
    }

    /// Sets the values at the beginning and at the end of a step.
    pub(crate) fn set(&mut self, values: impl Iterator<Item = (ForcedMass, [f64; 2])>) {
        for (mass, ends) in values {
            let own = self.masses.iter().zip(&mut self.on).filter(|(own, _)| **own == mass);
            own.for_each(|(_, on)| on.ends = ends);
        }
    }

    pub(crate) fn is_finite(&self) -> bool {
        self.on.iter().flat_map(|on| on.ends).all(f64::is_finite)
    }

    /// From the sample before to this one, with the force on all masses at both.
    #[inline(always)]
    pub(crate) fn over<T>(&self, [begin, end]: [T; 2]) -> [Input<'_, T>; 2] {
        [self.at(begin, 0.0), self.at(end, if self.is_held { 0.0 } else { 1.0 })]
    }

    /// At this sample.
    #[inline(always)]
    pub(crate) fn now<T>(&self, force: T) -> Input<'_, T> {
        self.at(force, 1.0)
    }

    /// At a share of the step; held forces change at its end.
    fn within<T>(&self, force: T, share: f64) -> Input<'_, T> {
        self.at(force, if self.is_held { 0.0 } else { share })
    }

    /// The inputs through the parts of a step.
    pub(crate) fn through<'a>(&'a self, parts: &'a Parts) -> impl Iterator<Item = PartInputs<'a>> {
        let (last, mut from) = (parts.iter().count().saturating_sub(1), 0.0);
        parts.iter().enumerate().map(move |(place, (part, readings))| {
            let ([begin, end], to) = (part.forces, from + part.share);
            let ends = [self.within(begin, from), self.within(end, to)];
            let now = if place == last { self.now(part.force) } else { self.within(part.force, to) };
            from = to;
            PartInputs { share: part.share, ends, now, readings }
        })
    }

    #[inline(always)]
    fn at<T>(&self, force: T, at: f64) -> Input<'_, T> {
        Input { force, on: &self.on, at }
    }
}
