//! Serial ports, as an Arduino has one.

use std::io::{self, Read};
use std::time::Duration;

use serialport::SerialPort;

/// The rate where none is named \[baud\].
const BAUD: u32 = 115_200;

/// Opens `/dev/ttyUSB0?baud=115200`.
pub(crate) fn open(name: &str) -> io::Result<Serial> {
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
pub(crate) struct Serial(Box<dyn SerialPort>);

impl Read for Serial {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        loop {
            match self.0.read(buffer) {
                Err(error) if error.kind() == io::ErrorKind::TimedOut => {}
                read => return read,
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_rate_stands_behind_the_port() {
        assert_eq!(port_and_rate("/dev/ttyUSB0").expect("a port"), ("/dev/ttyUSB0", BAUD));
        assert_eq!(port_and_rate("COM3?baud=9600").expect("a port"), ("COM3", 9600));
        let error = port_and_rate("COM3?speed=9600").expect_err("no rate").to_string();
        assert!(error.contains("baud=RATE"), "{error}");
    }
}
