//! Any bytes become a sound record, or a sentence says why not.
#![no_main]

#[path = "../../tests/common/import.rs"]
mod import;

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Err(what) = import::check_import(bytes) {
        panic!("{what}");
    }
});
