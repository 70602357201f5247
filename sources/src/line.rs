//! Lines of a limited length.

use std::io::{self, BufRead};

/// Limits a line \[bytes\]; the rest of a longer one is skipped.
pub const LONGEST: usize = 65_536;

/// Reads a line without its end, of one byte more than [`LONGEST`] at most. Returns whether there was one.
///
/// # Errors
/// Those of the source.
pub fn read_line(input: &mut dyn BufRead, line: &mut Vec<u8>) -> io::Result<bool> {
    line.clear();
    let mut some = false;
    loop {
        let buffer = match input.fill_buf() {
            Err(error) if error.kind() == io::ErrorKind::Interrupted => continue,
            buffer => buffer?,
        };
        if buffer.is_empty() {
            return Ok(some);
        }
        some = true;
        let end = buffer.iter().position(|byte| *byte == b'\n');
        let part = &buffer[..end.unwrap_or(buffer.len())];
        let room = (LONGEST + 1).saturating_sub(line.len());
        line.extend_from_slice(&part[..part.len().min(room)]);
        let read = end.map_or(buffer.len(), |end| end + 1);
        input.consume(read);
        if end.is_some() {
            return Ok(true);
        }
    }
}

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

#[cfg(test)]
mod tests {
    use std::io::BufReader;

    use super::*;

    #[test]
    fn lines_end_and_long_ones_are_cut() {
        let text = format!("a\n\n{}\nb", "x".repeat(3 * LONGEST));
        let mut input = BufReader::with_capacity(100, text.as_bytes());
        let mut line = Vec::new();
        let mut lengths = Vec::new();
        while read_line(&mut input, &mut line).expect("it can be read") {
            lengths.push(line.len());
        }
        assert_eq!(lengths, [1, 0, LONGEST + 1, 1]);
    }
}
