//! Free decays of an accelerometer that was plucked, and in the sound of a thing that was struck; the sweep of a printer.

mod decay;
mod modes;
mod ring;
mod sweep;

pub(crate) use decay::side_of;
pub use decay::{Decay, NoDecay};
pub use modes::Mode;
pub(crate) use modes::{Fit, highest};
pub use ring::Ring;
pub use sweep::Sweep;
