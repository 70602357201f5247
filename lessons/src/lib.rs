//! Lessons on Kalman filters: experiments in steps, with checks of every claim.
//!
//! A lesson is a file in `assets/lessons/`: a scenario, and steps with something to look at, something to change, what
//! happens and why. The text makes claims, so each step also states them as checks, which [`verify`] tries over several
//! seeds: a check holds in nearly all records, or in the `share` that it states.
//!
//! ```toml
//! title = "Fading memory"
//! group = "Practice"
//! summary = "One sentence for the menu."
//! scenario = "stiffness-loss"                      # or a table: a scenario of its own
//! adjust = { remove_filters = ["UKF"] }            # what is different at first
//!
//! [[steps]]
//! look = "What to look at."
//! happens = "What is seen."
//! why = "And why."
//! views = ["parameters", "innovations"]
//! mode = "live"                                    # or "whole"
//! checks = [{ filter = "EKF", measure = "verdict", is = "consistent" }]
//!
//! [[steps]]                                        # changes accumulate
//! look = "What to look at now."
//! change = { label = "λ = 1", set = { "filters.EKF.fading" = 1.0 } }
//! happens = "Its band is narrower before the loss."
//! why = "And why."
//! checks = [
//!   { filter = "EKF", measure = "std", channel = "natural_frequency", at = 29.0, before = true, below = 0.8 },
//! ]
//! ```
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
mod built_in;
mod check;
mod claim;
mod cost;
mod error;
mod evaluate;
mod lesson;
mod library;
mod measure;
mod outcome;
mod path;
mod value;
mod verify;

pub use adjustment::{Adjustment, Change};
pub use built_in::{BUILT_IN, BuiltIn};
pub use check::{Check, Times};
pub use claim::Claim;
pub use cost::evaluations_per_step;
pub use error::LessonError;
pub use lesson::{Base, Lesson, Presentation, Step, ViewName};
pub use library::{LESSONS, lessons};
pub use measure::Measure;
pub use outcome::Outcome;
pub use value::{Expected, Value};
pub use verify::{verify, verify_all};
