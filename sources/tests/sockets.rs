//! Sources over the network, on this machine.

use std::io::Write as _;
use std::net::TcpListener;
use std::thread;

use kalmanscope_sources::{open, read_line};

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
