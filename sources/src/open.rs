//! Sources by their names: files, TCP, UDP, and serial ports, as an Arduino has one.

use std::fs::File;
use std::io::{self, BufRead, BufReader, Read};
use std::net::{TcpStream, UdpSocket};
use std::time::Duration;

use serialport::SerialPort;

use crate::line::LONGEST;

/// Opens a source by its name: `-`, a file, `tcp://HOST:PORT` to connect to, `udp://HOST:PORT` to listen at,
/// `serial:PORT?baud=RATE`.
///
/// # Errors
/// Where it cannot be opened.
pub fn open(name: &str) -> io::Result<Box<dyn BufRead + Send>> {
    Ok(match name.split_once(':') {
        _ if name == "-" => Box::new(BufReader::new(io::stdin())),
        Some(("tcp", address)) => Box::new(BufReader::new(TcpStream::connect(address.trim_start_matches('/'))?)),
        Some(("udp", address)) => Box::new(BufReader::new(Datagrams::bind(address.trim_start_matches('/'))?)),
        Some(("serial", port)) => Box::new(BufReader::new(open_serial(port)?)),
        // Only `//` makes a kind of source: `C:\record.csv` is a file.
        Some((scheme, rest)) if rest.starts_with("//") => {
            let reason = format!("there is no source of the kind {scheme}://, only tcp://, udp:// and serial:");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        _ => Box::new(BufReader::new(File::open(name)?)),
    })
}

/// The datagrams that arrive at an address, each ended by the end of a line. An empty one is an empty line.
struct Datagrams {
    socket: UdpSocket,
    /// The present datagram; the reader has taken its first `read` bytes.
    datagram: Vec<u8>,
    read: usize,
}

impl Datagrams {
    fn bind(address: &str) -> io::Result<Self> {
        Ok(Self { socket: UdpSocket::bind(address)?, datagram: Vec::new(), read: 0 })
    }
}

impl Read for Datagrams {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let Self { socket, datagram, read } = self;
        if *read == datagram.len() {
            // UDP has no datagram beyond 65 507 bytes, so none is cut.
            datagram.resize(LONGEST, 0);
            // After an error, the zeros of the buffer must not be read as a datagram.
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

/// The rate where none is named \[baud\].
const BAUD: u32 = 115_200;

/// Opens `/dev/ttyUSB0?baud=115200`.
fn open_serial(name: &str) -> io::Result<Serial> {
    let (port, rate) = port_and_rate(name)?;
    Ok(Serial(serialport::new(port, rate).timeout(Duration::from_secs(1)).open()?))
}

fn port_and_rate(name: &str) -> io::Result<(&str, u32)> {
    let Some((port, rest)) = name.split_once('?') else { return Ok((name, BAUD)) };
    let rate = rest.strip_prefix("baud=").and_then(|rate| rate.parse().ok());
    let bad = || io::Error::new(io::ErrorKind::InvalidInput, format!("“{rest}” is not baud=RATE, such as baud=115200"));
    Ok((port, rate.ok_or_else(bad)?))
}

/// A port that waits for as long as nothing comes.
struct Serial(Box<dyn SerialPort>);

impl Read for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.0.read(buffer) {
                // A serial port must have a time limit, but an instrument may be silent for longer.
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {}
                read => return read,
            }
        }
    }
}
