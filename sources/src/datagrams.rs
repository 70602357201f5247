//! UDP.

use std::io::{self, Read};
use std::net::UdpSocket;

use crate::line::LONGEST;

/// The datagrams that arrive at an address, each ended by the end of a line. An empty one is an empty line.
pub(crate) struct Datagrams {
    socket: UdpSocket,
    /// The present datagram, of which the reader has this much.
    datagram: Vec<u8>,
    read: usize,
}

impl Datagrams {
    pub(crate) fn bind(address: &str) -> io::Result<Self> {
        Ok(Self { socket: UdpSocket::bind(address)?, datagram: Vec::new(), read: 0 })
    }
}

impl Read for Datagrams {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let Self { socket, datagram, read } = self;
        if *read == datagram.len() {
            datagram.resize(LONGEST, 0);
            let length = socket.recv(datagram).inspect_err(|_| *read = LONGEST)?;
            datagram.truncate(length);
            *read = 0;
            if !datagram.ends_with(b"\n") {
                datagram.push(b'\n');
            }
        }
        let part = &datagram[*read..];
        let count = part.len().min(buffer.len());
        buffer[..count].copy_from_slice(&part[..count]);
        *read += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use std::io::BufReader;

    use super::*;
    use crate::line::read_line;

    #[test]
    fn a_datagram_is_a_line_or_several() {
        let datagrams = Datagrams::bind("127.0.0.1:0").expect("there is a port");
        let to = datagrams.socket.local_addr().expect("it has an address");
        let from = UdpSocket::bind("127.0.0.1:0").expect("there is a port");
        for part in [&b"t,force"[..], b"", b"0,1\n0.01,2\n"] {
            from.send_to(part, to).expect("it can be sent");
        }
        let mut input = BufReader::new(datagrams);
        let mut line = Vec::new();
        for expected in ["t,force", "", "0,1", "0.01,2"] {
            assert!(read_line(&mut input, &mut line).expect("it can be read"));
            assert_eq!(line, expected.as_bytes());
        }
    }
}
