//! A plant of a program's own, which knows plain numbers only.

use super::Rates;
use crate::PlantKind;
use crate::mathematics::engine::number::Number;

/// A plant that is called lane by lane, with its Jacobian by hand.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Own(pub PlantKind);

impl Own {
    /// The rates, and their derivatives by the components, column by column, with `rows` numbers a column.
    pub fn linearise<T: Number>(self, state: &[T], force: T, rate: &mut [T], columns: &mut [T], rows: usize) {
        self.rates(state, force, rate);
        let Self(kind) = self;
        let (own, motion) = (kind.channels().len(), kind.motion());
        let (mut numbers, mut jacobian) = (vec![0.0; own], vec![0.0; motion * own]);
        for lane in 0..T::LANES {
            take_lane(state, lane, &mut numbers);
            jacobian.fill(0.0);
            kind.plant().motion_jacobian(&numbers, &mut jacobian);
            for i in 0..motion {
                for j in 0..own {
                    columns[j * rows + i].set_lane(lane, jacobian[i * own + j]);
                }
            }
        }
    }
}

impl<T: Number> Rates<T> for Own {
    fn components(self) -> usize {
        self.0.channels().len()
    }

    fn moving(self) -> usize {
        self.0.motion()
    }

    fn is_small(self) -> bool {
        false
    }

    fn rates(self, state: &[T], force: T, rate: &mut [T]) {
        let Self(kind) = self;
        let (mut numbers, mut rates) = (vec![0.0; kind.channels().len()], vec![0.0; kind.motion()]);
        for lane in 0..T::LANES {
            take_lane(state, lane, &mut numbers);
            kind.plant().motion_rate(&numbers, force.lane(lane), &mut rates);
            for (rate, own) in rate.iter_mut().zip(&rates) {
                rate.set_lane(lane, *own);
            }
        }
    }
}

fn take_lane<T: Number>(state: &[T], lane: usize, numbers: &mut [f64]) {
    for (number, own) in numbers.iter_mut().zip(state) {
        *number = own.lane(lane);
    }
}
