//! Kalmanscope's app, which draws the results of the core.
//!
//! Data flows one way. The controls edit a copy of the scenario, the [`session::Session`] runs it, the views draw the
//! session. Every change is a [`request::Request`], which is applied after the frame.

#![allow(missing_docs, reason = "the explorer is a program: its library is for its tests")]

pub mod app;
mod bar;
pub mod controls;
mod drawer;
mod equation;
pub mod export;
pub mod figure;
pub mod film;
mod finder;
pub mod import;
pub mod inbox;
mod keys;
mod kinds;
pub mod laboratory;
pub mod layout;
mod legend;
mod measure;
mod menu;
mod notice;
mod panes;
pub mod plot;
pub mod probe;
pub mod record_store;
pub mod request;
pub mod ruler;
mod ruler_table;
pub mod screen_text;
pub mod sensor;
pub mod session;
pub mod share;
mod spark;
mod story;
pub mod team;
pub mod text;
pub mod theme;
mod thumbnail;
mod timeline;
mod transport;
mod trouble;
pub mod tutor;
mod verdict;
pub mod view;
pub mod views;
pub mod visibility;
mod widgets;

pub use app::App;
