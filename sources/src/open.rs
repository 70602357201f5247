//! Sources by their names.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::net::TcpStream;

use crate::datagrams::Datagrams;
use crate::serial;

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
        Some(("serial", port)) => Box::new(BufReader::new(serial::open(port)?)),
        Some((scheme, rest)) if rest.starts_with("//") => {
            let reason = format!("there is no source of the kind {scheme}://, only tcp://, udp:// and serial:");
            return Err(io::Error::new(io::ErrorKind::InvalidInput, reason));
        }
        _ => Box::new(BufReader::new(File::open(name)?)),
    })
}
