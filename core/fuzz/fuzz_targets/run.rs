//! Any scenario runs to its end, and every sample is healthy or its filter has stopped with a reason.
#![no_main]

#[path = "../../tests/common/health.rs"]
#[expect(dead_code, reason = "the other target uses the rest")]
mod health;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    let (scenario, gap) = health::scenario_of(bytes);
    if let Err(what) = health::check_scenario(&scenario, gap) {
        panic!("{what}\n{}", scenario.to_toml().unwrap_or_default());
    }
});
