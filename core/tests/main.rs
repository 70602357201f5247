//! The tests of the core from outside: one program, which is linked once and keeps all processors busy. `Cargo.toml` says
//! which ones have programs of their own. `cargo test -p kalmanscope-core --test all NAME::` runs those of one file.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

// Several of the files below use these modules, and the fuzzer uses some of them.
#[path = "common/ambient.rs"]
mod ambient;
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
#[path = "../benches/situations/mod.rs"]
#[expect(dead_code, reason = "benches take their arguments from it")]
mod situations;
#[path = "common/start_values.rs"]
mod start_values;

mod agreement;
mod augmentations;
mod bank;
mod bounded;
mod causes;
mod clocks;
mod decay;
mod delays;
mod diagnosis;
mod diagnostics;
mod docs;
mod documents;
mod equations;
mod estimates;
mod events;
mod faults;
mod files;
mod findings;
mod forgetting;
mod free_runs;
mod frequency_response;
mod gallery;
mod hindsight;
mod import_health;
mod invariants;
mod job;
mod jump;
mod kalman_filter;
mod learnt_noise;
mod live;
mod look_ahead;
mod measured;
mod million_steps;
mod monte_carlo;
mod motion;
mod online;
mod options;
mod oracles;
mod outliers;
mod own;
mod plucks;
mod populations;
mod reference;
mod scenario;
mod settings;
mod snapshots;
mod spectra;
mod start_value_records;
mod truth;
mod verdicts;
mod white_force;
