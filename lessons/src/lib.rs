#![doc = include_str!("../README.md")]
//!
//! ## In a program
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
mod error;
mod grid;
mod lesson;
mod library;
mod outcome;
mod picture;
mod question;
pub mod records;
mod verify;

pub use adjustment::Adjustment;
pub use built_in::{BUILT_IN, BuiltIn, EQUATIONS};
pub use check::Check;
pub use claim::Claim;
pub use error::LessonError;
pub use grid::{GridCells, Map};
pub use lesson::{Base, Lesson, LessonStep, Presentation, ViewName};
pub use library::{LESSONS, LibraryFile, lessons};
pub use outcome::AnalysedRun;
pub use picture::{LessonPicture, PictureCourse};
pub use question::Question;
pub use verify::{verify, verify_all, verify_with};
