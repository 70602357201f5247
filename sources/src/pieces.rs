//! Text that comes in pieces, as lines.

use std::io;

/// Pieces of text one behind the other, each ended by the end of a line.
#[derive(Default)]
pub(crate) struct Pieces {
    rest: Vec<u8>,
    at: usize,
}

impl Pieces {
    /// Reads from the present piece, or from the next one. An empty one is the end.
    pub(crate) fn read(
        &mut self,
        buffer: &mut [u8],
        next: impl FnOnce(&mut Vec<u8>) -> io::Result<()>,
    ) -> io::Result<usize> {
        if self.at == self.rest.len() {
            self.at = 0;
            self.rest.clear();
            next(&mut self.rest)?;
            if !self.rest.is_empty() && !self.rest.ends_with(b"\n") {
                self.rest.push(b'\n');
            }
        }
        let part = &self.rest[self.at..];
        let count = part.len().min(buffer.len());
        buffer[..count].copy_from_slice(&part[..count]);
        self.at += count;
        Ok(count)
    }
}
