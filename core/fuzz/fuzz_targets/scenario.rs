//! Any text is a scenario or an error; a scenario can be written and read again.
#![no_main]

#[path = "../../tests/common/health.rs"]
#[expect(dead_code, reason = "the other target uses the rest")]
mod health;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &str| {
    if let Err(what) = health::check_file(text) {
        panic!("{what}");
    }
});
