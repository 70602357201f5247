//! The tests of the core from outside: one program, which is linked once and keeps all processors busy. `Cargo.toml` says
//! which ones have programs of their own. `cargo test -p kalmanscope-core --test all NAME::` runs those of one file.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

// Several of the files below use these modules, and the tests of the diagnosis and the fuzzer use some of them.
#[path = "common/health.rs"]
mod health;
#[path = "common/import.rs"]
mod import;
#[path = "common/numbers.rs"]
mod numbers;
#[path = "common/phone.rs"]
mod phone;
#[path = "common/run.rs"]
mod run;
#[path = "common/threads.rs"]
mod threads;

mod agreement;
mod augmentations;
mod bank;
mod bounded;
mod clocks;
mod delays;
mod diagnostics;
mod documents;
mod equations;
mod estimates;
mod events;
mod faults;
mod files;
mod forces;
mod forgetting;
mod free_runs;
mod frequency_response;
mod hindsight;
mod import_health;
mod invariants;
mod jump;
mod kalman_filter;
mod learnt_noise;
mod live;
mod million_steps;
mod monte_carlo;
mod motion;
mod online;
mod options;
mod oracles;
mod outliers;
mod own;
mod populations;
mod reference;
mod scenario;
mod settings;
mod spectra;
mod truth;
mod white_force;
