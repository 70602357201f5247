//! Where live readings come from, and where estimates go.
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
mod cells;
mod line;
mod lines;

// A page has no way to these.
#[cfg(not(target_arch = "wasm32"))]
mod broadcast;
#[cfg(not(target_arch = "wasm32"))]
mod datagrams;
#[cfg(not(target_arch = "wasm32"))]
mod messages;
#[cfg(not(target_arch = "wasm32"))]
mod open;
#[cfg(not(target_arch = "wasm32"))]
mod phone;
#[cfg(not(target_arch = "wasm32"))]
mod pieces;
#[cfg(not(target_arch = "wasm32"))]
mod serial;

pub use accelerations::{Accelerations, NoAxes};
#[cfg(not(target_arch = "wasm32"))]
pub use broadcast::Broadcast;
pub use line::{LONGEST, read_line};
pub use lines::{BadLine, Lines, Told};
#[cfg(not(target_arch = "wasm32"))]
pub use open::open;
