//! Filters written once, for one run or for several side by side.
//!
//! ```text
//! number, lanes, dual      the numbers that equations are written for
//! plants, model            how a state moves, and what sensors read
//! design, filter           predict and update
//!   linearised             the prediction of KF and EKF        (exponential, impulse, differentiated)
//!   sigma_points           the prediction of UKF and CKF       (runge_kutta)
//!   expected, update       the measurements, and the belief after them
//!   fault                  why a step does not hold
//! run, scores              a whole record, and what it tells
//! list, builder, notes     equations as lists of operations
//! setup                    the filter of a scenario
//! estimator                one run, which reports sample by sample   (in_units)
//! single                   one run, whose belief stands elsewhere
//! states                   many states of one run, several at a time
//! ```
//!
//! A step is straight-line code over a [`Number`](number::Number): an `f64`, or [`Lanes`](lanes::Lanes) of it. Where runs differ
//! in what they need (a measurement that is missing, a variance of zero, a longer series), each lane selects its own, so that
//! all give the bits that they have alone. No operation is fused, so that all [instructions](level::Level) give the same bits too.
//! Memory to work in is kept in a filter; matrices stand column by column in slices.

#![expect(
    clippy::needless_range_loop,
    reason = "closures of iterators that are not inlined have no vector instructions; indices are those of the equations"
)]

pub mod belief;
pub mod builder;
pub mod columns;
pub mod course;
pub mod design;
mod differentiated;
pub mod dual;
pub(crate) mod error_square;
mod expected;
pub mod exponential;
mod fault;
pub mod filter;
pub mod function;
pub mod impulse;
pub mod lanes;
pub mod level;
pub mod linearised;
pub mod list;
pub mod model;
pub mod notes;
pub mod number;
mod plain;
pub mod plants;
pub mod propagation;
pub mod runge_kutta;
pub mod sigma_points;
pub(crate) mod single;
pub(crate) mod states;
pub mod step;
pub(crate) mod update;
