//! Sources by their names.

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::net::TcpStream;

use crate::datagrams::Datagrams;
use crate::messages::Messages;
use crate::phone::Phone;
use crate::serial;

/// Opens a source by its name: `-`, a file, `tcp://HOST:PORT` to connect to, `udp://HOST:PORT` to listen at, `ws://HOST:PORT`,
/// `serial:PORT?baud=RATE`, `http://PHONE:8080` of a phone with phyphox.
///
/// # Errors
/// Where it cannot be opened.
pub fn open(name: &str) -> io::Result<Box<dyn BufRead + Send>> {
    Ok(match name.split_once(':') {
        _ if name == "-" => Box::new(BufReader::new(io::stdin())),
        Some(("tcp", address)) => Box::new(BufReader::new(TcpStream::connect(address.trim_start_matches('/'))?)),
        Some(("udp", address)) => Box::new(BufReader::new(Datagrams::bind(address.trim_start_matches('/'))?)),
        Some(("ws", _)) => Box::new(BufReader::new(Messages::connect(name)?)),
        Some(("serial", port)) => Box::new(BufReader::new(serial::open(port)?)),
        Some(("http", _)) => Box::new(BufReader::new(Phone::connect(name)?)),
        _ => Box::new(BufReader::new(File::open(name)?)),
    })
}
