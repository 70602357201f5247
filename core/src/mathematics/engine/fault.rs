//! Why a step does not hold.

use super::columns::{Rooted, lower_root};
use super::level::Baseline;
use super::number::Mask;
use crate::FilterError;

#[derive(Clone, Copy, Debug)]
pub(super) struct Checks<M> {
    /// Sigma points can be drawn for the prediction.
    pub(super) predicted: Rooted<M>,
    /// Sigma points can be drawn for the update.
    pub(super) expected: Rooted<M>,
    /// S is positive definite.
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

pub(super) fn of_root(is_finite: bool, indefinite: FilterError) -> FilterError {
    if is_finite { indefinite } else { FilterError::NotFinite }
}
