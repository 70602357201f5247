//! Sources over the network, on this machine.

use std::io::{BufRead as _, BufReader, Write as _};
use std::net::{TcpListener, TcpStream};
use std::thread;
use std::time::Duration;

use kalmanscope_sources::{Accelerations, Broadcast, open, read_line};

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
fn a_server_tells_lines() {
    let server = TcpListener::bind("127.0.0.1:0").expect("a port");
    let name = format!("tcp://{}", server.local_addr().expect("an address"));
    let tells =
        thread::spawn(move || server.accept().expect("one comes").0.write_all(b"t,x\n0,1\n0.1,2").expect("sent"));
    assert_eq!(lines(&name, 10), ["t,x", "0,1", "0.1,2"]);
    tells.join().expect("it has told");
    let error = open(&name).err().expect("nobody is there").to_string();
    assert!(error.contains("refused"), "{error}");
}

#[test]
fn estimates_go_to_all_who_listen() {
    let mut broadcast = Broadcast::at(":0").expect("a port");
    assert!(broadcast.address().ip().is_loopback());
    let name = format!("ws://{}", broadcast.address());
    let listen = |count: usize| {
        let name = name.clone();
        thread::spawn(move || lines(&name, count))
    };
    let (first, second) = (listen(3), listen(3));
    let mut sent = 0;
    while !(first.is_finished() && second.is_finished()) {
        broadcast.send(&format!("{{\"t\": {sent}}}"));
        sent += 1;
        assert!(sent < 2000, "nobody listens");
        thread::sleep(Duration::from_millis(5));
    }
    for heard in [first, second] {
        let heard = heard.join().expect("it has listened");
        let number = |line: &String| line[6..line.len() - 1].parse::<i32>().expect("a number");
        assert!(heard.windows(2).all(|pair| number(&pair[1]) == number(&pair[0]) + 1), "{heard:?}");
    }
    // Those who have gone are no trouble.
    (0..5).for_each(|_| broadcast.send("nobody"));
}

/// A phone with phyphox: at each question, some more readings.
fn phone(server: &TcpListener) {
    let mut there = 0;
    for stream in server.incoming() {
        let mut stream = stream.expect("one comes");
        let mut reader = BufReader::new(stream.try_clone().expect("a stream"));
        let mut request = String::new();
        reader.read_line(&mut request).expect("a question");
        let mut rest = String::new();
        while rest != "\r\n" {
            rest.clear();
            reader.read_line(&mut rest).expect("a header");
        }
        let body = answer(request.split(' ').nth(1).expect("an address"), &mut there);
        let head = format!("HTTP/1.1 200 OK\r\nContent-Length: {}\r\nConnection: close\r\n\r\n", body.len());
        stream.write_all((head + &body).as_bytes()).ok();
    }
}

fn answer(address: &str, there: &mut usize) -> String {
    if address == "/control?cmd=start" {
        return "{\"result\": true}".to_owned();
    }
    let question = address.strip_prefix("/get?").expect("a question");
    let after = question.split('&').find_map(|part| part.strip_prefix("acc_time=")).expect("the time is asked for");
    let after = after.parse().unwrap_or(-1.0);
    // Without a reference an axis would be compared with the time.
    assert!(
        question.split('&').skip(1).all(|part| part.ends_with("=full") || part.ends_with("%7Cacc_time")),
        "{question}"
    );
    *there += 7;
    let rows: Vec<f64> = (0..*there).map(|k| 0.01 * k as f64).filter(|t| *t > after).collect();
    let buffer = |name: &str, of: &dyn Fn(f64) -> f64| {
        let numbers: Vec<String> = rows.iter().map(|t| of(*t).to_string()).collect();
        format!("\"{name}\": {{\"size\": 0, \"updateMode\": \"partial\", \"buffer\": [{}]}}", numbers.join(","))
    };
    format!(
        "{{\"buffer\": {{{}, {}, {}, {}}}, \"status\": {{\"measuring\": true}}}}",
        buffer("acc_time", &|t| t),
        buffer("accX", &|t| t.sin()),
        buffer("accY", &|_| 0.0),
        buffer("accZ", &|_| 9.81)
    )
}

#[test]
fn a_phone_is_asked_for_what_is_new() {
    let server = TcpListener::bind("127.0.0.1:0").expect("a port");
    let name = format!("http://{}", server.local_addr().expect("an address"));
    thread::spawn(move || phone(&server));
    let mut accelerations = Accelerations::default();
    for line in lines(&name, 40) {
        accelerations.take(line.as_bytes(), 0.0).expect("they are accelerations");
    }
    let readings = accelerations.readings();
    assert_eq!(readings.len(), 39);
    for (k, [t, x, y, z]) in readings.iter().enumerate() {
        let expected = 0.01 * k as f64;
        assert!((t - expected).abs() < 1e-12 && (x - expected.sin()).abs() < 1e-12, "{k}: {t} {x}");
        assert_eq!((*y, *z), (0.0, 9.81));
    }
}

#[test]
fn what_is_no_source_is_said() {
    for (name, words) in [
        ("serial:/dev/no-such-port?baud=9600", "o such"),
        ("serial:/dev/ttyUSB0?speed=1", "baud=RATE"),
        ("ws://127.0.0.1:1", "Unable to connect"),
        ("http://127.0.0.1:1", "refused"),
        ("no-such-file.csv", "o such file"),
    ] {
        let error = open(name).err().unwrap_or_else(|| panic!("{name} is opened")).to_string();
        assert!(error.contains(words), "{name}: {error}");
    }
}

#[test]
fn strangers_at_the_broadcast_do_no_harm() {
    let mut broadcast = Broadcast::at(":0").expect("a port");
    for text in [&b"GET / HTTP/1.1\r\n\r\n"[..], b"\0\xff\n", b""] {
        let mut stream = TcpStream::connect(broadcast.address()).expect("it can be reached");
        stream.write_all(text).ok();
    }
    broadcast.send("still there");
}
