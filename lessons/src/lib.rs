//! Lessons on Kalman filters: experiments in steps, and checks that hold each of them to what it says.
//!
//! A lesson is a file in `assets/lessons/`: a scenario, and steps that say what to look at, what to change, what happens
//! and why. The text makes claims, so each step carries them as checks too, which [`verify`] runs over several seeds.
//!
//! ```
//! # fn main() -> Result<(), kalmanscope_lessons::LessonError> {
//! let lesson = kalmanscope_lessons::lessons().remove(0)?;
//! let at_first = lesson.scenario_at(0)?;
//! for claim in kalmanscope_lessons::verify(&lesson, 1..=1)? {
//!     assert!(claim.holds(), "{claim}");
//! }
//! # assert!(!at_first.filters.is_empty());
//! # Ok(())
//! # }
//! ```

mod adjustment;
mod check;
mod claim;
mod cost;
mod error;
mod lesson;
mod library;
mod measure;
mod outcome;
mod path;

pub use adjustment::{Adjustment, Change};
pub use check::{Check, Expected, Measure, Times, Value};
pub use claim::{Claim, verify};
pub use cost::evaluations_per_step;
pub use error::LessonError;
pub use lesson::{Base, Lesson, Mode, Step, View};
pub use library::{LESSONS, SCENARIOS, lessons};
pub use outcome::Outcome;
