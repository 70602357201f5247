//! The masses of a plant, and the channels of their motion.

use kalmanscope_core::{Channel, Run};

pub(super) use kalmanscope_core::channel::MAX_MASSES;

pub(super) fn displacement(mass: usize) -> Channel {
    Channel::displacement(mass.min(MAX_MASSES - 1))
}

pub(super) fn masses(run: &Run) -> usize {
    let known = |mass: usize| run.record().truth(displacement(mass)).is_some();
    let there = |mass: &usize| if known(0) { known(*mass) } else { run.channels().contains(&displacement(*mass)) };
    (0..MAX_MASSES).take_while(there).count().max(1)
}
