//! Kalmanscope's app: draws what the core computes.
//!
//! Data flows one way. The controls write the scenario, the [`session::Session`] runs it, the views draw the session and may
//! ask for a [`command::Command`], which is carried out after the frame.

pub mod app;
mod bar;
pub mod command;
pub mod controls;
mod keys;
pub mod library;
mod places;
pub mod polyline;
mod saved;
pub mod series;
pub mod session;
pub mod summary;
pub mod text;
pub mod theme;
pub mod transport;
pub mod tutor;
pub mod views;

pub use app::App;
