//! Filters written once, for one run or for several side by side.
//!
//! ```text
//! number, lanes, dual      the numbers that equations are written for
//! dynamics, model          how a state moves, and what sensors read
//! design, filter           predict and update
//!   linearised             the prediction of KF and EKF        (exponential, coupled)
//!   sigma_points           the prediction of UKF and CKF       (runge_kutta)
//!   square_root            the SR-UKF
//!   expected, update       the measurements, and the belief after them
//!   wrapper                options, each a filter around a filter
//! belief                   mean and covariance, noise, and a belief over logarithms in units
//! list, builder            equations as lists of operations
//! ```
//!
//! A step is straight-line code over a [`Number`](number::Number): an `f64`, or [`Lanes`](lanes::Lanes) of it (in a page, a pair).
//! Where runs differ (a missing measurement, a variance of zero, a longer series), each lane selects its own, so that all give the
//! bits that they have alone. No operation is fused, so that all [instructions](level::Level) give the same bits too.

#![expect(
    clippy::needless_range_loop,
    reason = "closures of iterators that are not inlined have no vector instructions; indices are those of the equations"
)]

pub mod belief;
pub mod builder;
pub mod columns;
mod coupled;
pub mod design;
pub mod dual;
pub mod dynamics;
mod expected;
pub mod exponential;
pub mod filter;
pub mod lanes;
pub mod level;
pub(crate) mod linearised;
pub mod list;
pub mod model;
pub mod number;
#[cfg(target_arch = "wasm32")]
pub mod pair;
pub mod passage;
pub mod robust;
pub mod runge_kutta;
pub(crate) mod sigma_points;
mod square_root;
pub mod update;
pub(crate) mod weights;
pub mod wrapper;
