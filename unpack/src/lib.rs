//! Unpacks a file in LZMA's own format (`.lzma`) part by part, as its bytes come from a server.

use lzma_rust2::{Action, LzmaStream, Status};
use wasm_bindgen::prelude::wasm_bindgen;

/// Bytes that are unpacked at once.
const PORTION: usize = 1 << 16;

/// A file of which a part has come.
#[wasm_bindgen]
pub struct Unpacker(LzmaStream);

#[wasm_bindgen]
impl Unpacker {
    /// Nothing has come yet.
    #[expect(clippy::new_without_default, reason = "JavaScript's `new` is its only caller")]
    #[wasm_bindgen(constructor)]
    pub fn new() -> Self {
        Self(LzmaStream::new_mem_limit(u32::MAX, None))
    }

    /// Takes the next packed bytes, as many as have come, and returns the bytes that they unpack to. Bytes behind the end of
    /// the file are left out.
    ///
    /// # Errors
    /// Returns a sentence if the bytes are not LZMA's, then for each further call too.
    pub fn push(&mut self, mut packed: &[u8]) -> Result<Vec<u8>, String> {
        let mut all = Vec::new();
        let mut portion = vec![0; PORTION];
        loop {
            let step = self
                .0
                .process(packed, &mut portion, Action::Run)
                .map_err(|error| format!("this is not packed with LZMA: {error}"))?;
            all.extend_from_slice(&portion[..step.bytes_produced]);
            packed = &packed[step.bytes_consumed..];
            let is_starved = step.bytes_produced == 0 && packed.is_empty();
            if step.status == Status::StreamEnd || is_starved {
                return Ok(all);
            }
        }
    }

    /// Whether the whole file has come.
    pub fn is_complete(&self) -> bool {
        self.0.is_finished() && !self.0.has_output()
    }
}
