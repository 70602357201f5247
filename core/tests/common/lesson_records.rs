//! The programs that make records of lessons.

#[path = "../../../lessons/src/records/earthquake.rs"]
pub(crate) mod earthquake;
#[path = "../../../lessons/src/records/oscillator.rs"]
pub(crate) mod oscillator;
#[path = "../../../lessons/src/records/random.rs"]
pub(crate) mod random;
#[path = "../../../lessons/src/records/staircase.rs"]
pub(crate) mod staircase;
