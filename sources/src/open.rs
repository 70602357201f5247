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

#[cfg(test)]
mod tests {
    use std::io::Write as _;
    use std::net::TcpListener;
    use std::thread;

    use super::*;
    use crate::line::read_line;

    fn lines(name: &str, count: usize) -> Vec<String> {
        let mut source = open(name).unwrap_or_else(|error| panic!("{name}: {error}"));
        let mut line = Vec::new();
        let mut lines = Vec::new();
        while lines.len() < count && read_line(&mut source, &mut line).expect("it can be read") {
            lines.push(String::from_utf8(line.clone()).expect("text"));
        }
        lines
    }

    #[test]
    fn a_server_sends_lines() {
        let server = TcpListener::bind("127.0.0.1:0").expect("a port");
        let name = format!("tcp://{}", server.local_addr().expect("an address"));
        let server_thread =
            thread::spawn(move || server.accept().expect("one comes").0.write_all(b"t,x\n0,1\n0.1,2").expect("sent"));
        assert_eq!(lines(&name, 10), ["t,x", "0,1", "0.1,2"]);
        server_thread.join().expect("it has sent them");
        let error = open(&name).err().expect("nobody is there").to_string();
        assert!(error.contains("refused"), "{error}");
    }

    #[test]
    fn what_is_no_source_is_said() {
        for (name, words) in [
            ("serial:/dev/no-such-port?baud=9600", "o such"),
            ("serial:/dev/ttyUSB0?speed=1", "baud=RATE"),
            ("ws://127.0.0.1:1", "no source of the kind ws://"),
            ("http://127.0.0.1:1", "only tcp://, udp:// and serial:"),
            ("no-such-file.csv", "o such file"),
        ] {
            let error = open(name).err().unwrap_or_else(|| panic!("{name} is opened")).to_string();
            assert!(error.contains(words), "{name}: {error}");
        }
    }
}
