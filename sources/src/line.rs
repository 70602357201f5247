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
