//! Where live readings come from, and where estimates go.
//!
//! ```
//! use kalmanscope_sources::Accelerations;
//! let mut accelerations = Accelerations::default();
//! for line in ["t,ax,ay,az", "0.00,0,0,9.81", "0.01,0,0.1,9.80", "0.02,0,0.2,9.79"] {
//!     accelerations.take(line.as_bytes(), 0.0)?;
//! }
//! assert_eq!(accelerations.readings().len(), 3);
//! # Ok::<(), kalmanscope_sources::NoAxes>(())
//! ```

mod accelerations;
mod broadcast;
mod cells;
mod datagrams;
mod line;
mod lines;
mod messages;
mod phone;
mod serial;

use std::fs::File;
use std::io::{self, BufRead, BufReader};
use std::net::TcpStream;

pub use accelerations::{Accelerations, NoAxes};
pub use broadcast::Broadcast;
pub use line::{LONGEST, read_line};
pub use lines::{BadLine, Lines, Told};

use datagrams::Datagrams;
use messages::Messages;
use phone::Phone;

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
