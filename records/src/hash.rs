//! Hashes of bytes (FNV-1a), which find accidents and no intent.

/// A hash of a file's bytes (FNV-1a, 64 bits), whole or in pieces, to recognise the same file; it does not protect against forgery.
#[derive(Clone, Copy, Debug)]
pub struct Hash(u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xCBF2_9CE4_8422_2325)
    }
}

impl Hash {
    /// Adds the next bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        let Self(sum) = self;
        *sum = bytes.iter().fold(*sum, |sum, &byte| (sum ^ u64::from(byte)).wrapping_mul(0x0100_0000_01B3));
    }

    pub fn value(self) -> u64 {
        self.0
    }

    /// The hash of the bytes so far, in hexadecimal.
    pub fn text(self) -> String {
        format!("{:016x}", self.0)
    }
}

/// A hash of 32 bits, as links have it.
pub fn short_hash(bytes: &[u8]) -> u32 {
    bytes.iter().fold(0x811C_9DC5, |hash, &byte| (hash ^ u32::from(byte)).wrapping_mul(0x0100_0193))
}
