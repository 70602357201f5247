//! UDP.

use std::io::{self, Read};
use std::net::UdpSocket;

use crate::line::LONGEST;
use crate::pieces::Pieces;

/// The datagrams that arrive at an address. An empty one tells nothing.
pub(crate) struct Datagrams {
    socket: UdpSocket,
    pieces: Pieces,
}

impl Datagrams {
    pub(crate) fn bind(address: &str) -> io::Result<Self> {
        Ok(Self { socket: UdpSocket::bind(address)?, pieces: Pieces::default() })
    }
}

impl Read for Datagrams {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let Self { socket, pieces } = self;
        pieces.read(buffer, |piece| {
            piece.resize(LONGEST, 0);
            let length = socket.recv(piece)?;
            piece.truncate(length);
            if length == 0 {
                piece.push(b'\n');
            }
            Ok(())
        })
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
