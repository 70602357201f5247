//! Ensembles, lanes, Monte Carlo, tuning and the posterior: one program, which is linked once. `cargo test -p kalmanscope-lab --test all
//! NAME::` runs those of one file.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod ensemble;
mod lanes;
mod monte_carlo;
mod next_sensor;
mod posterior;
mod runner;
mod threads;
mod tune;
