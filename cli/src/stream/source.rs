//! Where lines come from: standard input, a file or a pipe, a TCP connection, UDP datagrams.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::net::{TcpStream, UdpSocket};
use std::path::Path;

use crate::input::is_standard_input;

/// Limits a line \[bytes\]; the rest of a longer one is skipped.
pub(super) const LONGEST: usize = 65_536;

/// Opens a source by its name: `-`, a file, `tcp://HOST:PORT` to connect to, `udp://HOST:PORT` to listen at.
pub(super) fn open(source: &Path) -> io::Result<Box<dyn BufRead>> {
    let name = source.to_str().unwrap_or_default();
    if let Some(address) = name.strip_prefix("tcp://") {
        return Ok(Box::new(BufReader::new(TcpStream::connect(address)?)));
    }
    if let Some(address) = name.strip_prefix("udp://") {
        let datagrams = Datagrams { socket: UdpSocket::bind(address)?, rest: Vec::new(), at: 0 };
        return Ok(Box::new(BufReader::new(datagrams)));
    }
    if is_standard_input(source) {
        return Ok(Box::new(BufReader::new(io::stdin())));
    }
    Ok(Box::new(BufReader::new(File::open(source)?)))
}

/// Datagrams one behind the other, each ended by the end of a line.
struct Datagrams {
    socket: UdpSocket,
    rest: Vec<u8>,
    at: usize,
}

impl Read for Datagrams {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        if self.at == self.rest.len() {
            self.rest.resize(LONGEST, 0);
            let length = self.socket.recv(&mut self.rest)?;
            self.rest.truncate(length);
            if !self.rest.ends_with(b"\n") {
                self.rest.push(b'\n');
            }
            self.at = 0;
        }
        let part = &self.rest[self.at..];
        let count = part.len().min(buffer.len());
        buffer[..count].copy_from_slice(&part[..count]);
        self.at += count;
        Ok(count)
    }
}

/// Reads a line without its end, of one byte more than [`LONGEST`] at most. Returns whether there was one.
pub(super) fn read_line(input: &mut dyn BufRead, line: &mut Vec<u8>) -> io::Result<bool> {
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

    #[test]
    fn a_datagram_is_a_line() {
        let socket = UdpSocket::bind("127.0.0.1:0").expect("there is a port");
        let to = socket.local_addr().expect("it has an address");
        let from = UdpSocket::bind("127.0.0.1:0").expect("there is a port");
        for part in [&b"t,force"[..], b"0,1\n0.01,2\n"] {
            from.send_to(part, to).expect("it can be sent");
        }
        let mut input = BufReader::new(Datagrams { socket, rest: Vec::new(), at: 0 });
        let mut line = Vec::new();
        for expected in ["t,force", "0,1", "0.01,2"] {
            assert!(read_line(&mut input, &mut line).expect("it can be read"));
            assert_eq!(line, expected.as_bytes());
        }
    }
}
