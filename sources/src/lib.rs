//! Where live readings come from: lines of text, and what they mean.
//!
//! ```
//! use kalmanscope_sources::Accelerations;
//! let mut accelerations = Accelerations::default();
//! for line in ["t,ax,ay,az", "0.00,0,0,9.81", "0.01,0,0.1,9.80", "0.02,0,0.2,9.79"] {
//!     accelerations.take(line.as_bytes(), 0.0)?;
//! }
//! assert_eq!(accelerations.readings().len(), 3);
//! # Ok::<(), kalmanscope_sources::NoAxes>(())
//! ```

mod accelerations;
mod line;
mod lines;

// A page has no way to these.
#[cfg(not(target_arch = "wasm32"))]
mod open;

pub use accelerations::{Accelerations, NoAxes};
pub use line::{BadLine, LONGEST, read_line};
pub use lines::{LineReader, StreamRow};
#[cfg(not(target_arch = "wasm32"))]
pub use open::open;
