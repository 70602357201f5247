//! Lines of readings, and the sources that they come from.

use std::io::{BufReader, Write as _};
use std::net::{TcpListener, UdpSocket};
use std::thread;

use kalmanscope_core::Scenario;
use kalmanscope_sources::{Accelerations, BadLine, LONGEST, LineReader, NoAxes, StreamRow, open, read_line};

fn read(lines: impl IntoIterator<Item = String>) -> Result<Vec<[f64; 4]>, NoAxes> {
    let mut accelerations = Accelerations::default();
    for (k, line) in lines.into_iter().enumerate() {
        accelerations.take(line.as_bytes(), 5.0 + 0.01 * k as f64)?;
    }
    Ok(accelerations.readings())
}

fn rows(row: impl Fn(f64, f64) -> String) -> Vec<String> {
    (0..60).map(|k| row(f64::from(k), 0.1 * (0.3 * f64::from(k)).sin())).collect()
}

#[test]
fn lines_of_all_forms_give_the_same() {
    let header = |text: &str| vec![text.to_owned()];
    let forms = [
        [header("t,ax,ay,az"), rows(|k, a| format!("{},{a},0,9.8", 0.02 * k))].concat(),
        [header("# hello\n"), header("z;y;x;millis"), rows(|k, a| format!("9,8;0;{a};{}", 1000.0 + 20.0 * k))].concat(),
        rows(|k, a| format!("{} {a} 0 9.8", 20.0 * k + 7.0)),
        rows(|k, a| format!("{{\"t\": {}, \"acc_x\": {a}, \"acc_y\": 0, \"acc_z\": 9.8, \"who\": \"me\"}}", 0.02 * k)),
        [
            header("z\ty\tx\tmillis"),
            rows(|k, a| format!("9,8\t0\t{}\t{}\t", a.to_string().replace('.', ","), 1000.0 + 20.0 * k)),
        ]
        .concat(),
        [header("cut,0.1"), header("1,2"), rows(|k, a| format!("{},{a},0,9.8", 0.02 * k))].concat(),
    ];
    for lines in forms {
        let readings = read(lines.clone()).expect("they are accelerations");
        assert_eq!(readings.len(), 60, "{lines:?}");
        for (k, [t, x, y, z]) in readings.iter().enumerate() {
            let a = 0.1 * (0.3 * k as f64).sin();
            let close = (t - 0.02 * k as f64).abs() < 1e-9 && (x - a).abs() < 1e-12 && *y == 0.0 && *z == 9.8;
            assert!(close, "{k}: {t} {x} {y} {z} in {}", lines[0]);
        }
    }
}

#[test]
fn the_keys_of_objects_come_in_any_order_and_objects_with_others_are_left_out() {
    let object = |k: usize| match k {
        7 => "{\"t\": 0.14, \"x\": 1, \"y\": 2, \"temperature\": 20}".to_owned(),
        k if k % 2 == 0 => format!("{{\"t\": {}, \"x\": 1, \"y\": 2, \"z\": 9}}", 0.02 * k as f64),
        k => format!("{{\"z\": 9, \"y\": 2, \"t\": {}, \"x\": 1}}", 0.02 * k as f64),
    };
    let readings = read((0..50).map(object)).expect("they are accelerations");
    assert_eq!(readings.len(), 49);
    assert!(readings.iter().all(|[_, axes @ ..]| *axes == [1.0, 2.0, 9.0]), "{readings:?}");
}

#[test]
fn three_axes_alone_have_the_times_of_their_arrival_and_g_is_a_unit() {
    for lines in [
        rows(|_, a| format!("{a},0,1.0")),
        [vec!["gFx,gFy,gFz".to_owned()], rows(|_, a| format!("{a},0,1.0"))].concat(),
    ] {
        let readings = read(lines).expect("they are accelerations");
        assert_eq!(readings.len(), 60);
        let [t, x, _, z] = readings[10];
        assert!((t - 0.1).abs() < 1e-9 && (x - 0.980_665 * 3.0_f64.sin()).abs() < 1e-9 && z == 9.80665, "{t} {x} {z}");
    }
}

#[test]
fn what_is_no_acceleration_is_said_and_bad_lines_are_left_out() {
    assert_eq!(read(rows(|k, a| format!("{k},{a}"))), Err(NoAxes::Unknown(2)));
    assert_eq!(read(rows(|k, a| format!("{k},{a},{a},{a},{a}"))), Err(NoAxes::Unknown(5)));
    let mut lines = rows(|k, a| format!("{},{a},0,9.8", 0.02 * k));
    lines[50] = "1,2".to_owned();
    lines[52] = "1,x,3,4".to_owned();
    lines[54] = "t,ax,ay,az".to_owned();
    assert_eq!(read(lines).expect("they are accelerations").len(), 57);
}

fn reader() -> LineReader {
    LineReader::new(&Scenario::default())
}

fn numbers(row: Result<Option<StreamRow>, BadLine>) -> Vec<Option<f64>> {
    let StreamRow { time, input, readings } = row.expect("it can be read").expect("it has numbers");
    [time, input].into_iter().chain(readings).map(|x| (!x.is_nan()).then_some(x)).collect()
}

#[test]
fn cells_stand_under_their_header_in_any_order() {
    let mut lines = reader();
    assert_eq!(lines.read("\u{feff}# a comment".as_bytes()), Ok(None));
    assert_eq!(lines.read(b"note;velocity;t;force\r\n"), Ok(None));
    assert_eq!(numbers(lines.read(b"x;0,5;1e-2;")), [Some(0.01), None, None, Some(0.5)]);
    assert_eq!(numbers(lines.read(b"x;nan;0.02;-3\n")), [Some(0.02), Some(-3.0), None, None]);
    assert_eq!(lines.read(b"1;2"), Err(BadLine::Cells { found: 2, expected: 4 }));
    let bad = lines.read(b"x;fast;0.03;").expect_err("it is no number").to_string();
    assert_eq!(bad, "`velocity` is “fast”, but must be a number");
}

#[test]
fn decimal_commas_stand_between_tabs_and_blanks_too() {
    for lines_of in
        [["t\tforce\tvelocity", "0,01\t1,5\t\r\n"], ["t force velocity", "0,01 1,5 nan"], ["t;force", "0,01;1,5;"]]
    {
        let mut lines = reader();
        assert_eq!(lines.read(lines_of[0].as_bytes()), Ok(None));
        assert_eq!(numbers(lines.read(lines_of[1].as_bytes())), [Some(0.01), Some(1.5), None, None]);
    }
}

#[test]
fn times_have_units_turn_over_and_are_asked_about() {
    let times = |header: &str, cells: &[f64]| -> Vec<Result<f64, BadLine>> {
        let mut lines = reader();
        assert_eq!(lines.read(header.as_bytes()), Ok(None));
        let read = |time: &f64| lines.read(format!("{time},1").as_bytes()).map(|row| row.expect("a row").time);
        cells.iter().map(read).collect()
    };
    let ms: Vec<f64> = times("t_ms,force", &[0.0, 10.0, 20.0]).into_iter().map(Result::unwrap).collect();
    assert!(ms.iter().zip([0.0, 0.01, 0.02]).all(|(a, b)| (a - b).abs() < 1e-12), "{ms:?}");
    let micros = [4_294_940_000.0, 4_294_950_000.0, 4_294_960_000.0, 2704.0, 12_704.0];
    let micros: Vec<f64> = times("t [us],force", &micros).into_iter().map(Result::unwrap).collect();
    assert!(micros.windows(2).all(|pair| (pair[1] - pair[0] - 0.01).abs() < 1e-6), "{micros:?}");
    let asked = times("t,force", &[0.0, 10.0, 20.0, 30.0]);
    let question = asked[1].clone().unwrap_err().to_string();
    assert!(question.contains("are the times ms?") && question.contains("`t_ms`"), "{question}");
    assert!(asked[2..].iter().all(Result::is_ok), "it is asked once");
}

#[test]
fn objects_name_their_numbers() {
    let mut lines = reader();
    assert_eq!(
        numbers(lines.read(br#"{"t": 1, "displacement": 0.25, "who": "me"}"#)),
        [Some(1.0), None, Some(0.25), None]
    );
    assert_eq!(
        numbers(lines.read(br#"{"time": 2.5, "input": -1, "velocity": null}"#)),
        [Some(2.5), Some(-1.0), None, None]
    );
    for (line, words) in [
        (&br#"{"displacement": 1}"#[..], "no column for the time"),
        (br#"{"t": "now"}"#, "`t` is \"now\", but must be a number"),
        (br#"{"t": 1"#, "it is no JSON object"),
        (b"\xff\xfe", "it is not text"),
        (b"0.1,0.2", "a header such as `t,force,displacement,velocity` must come first"),
        (b"t,speed", "none of its columns is known"),
    ] {
        let error = lines.read(line).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
    }
    assert_eq!(lines.read(&vec![b'1'; 100_000]), Err(BadLine::TooLong));
}

#[test]
fn lines_end_and_long_ones_are_cut() {
    let text = format!("a\n\n{}\nb", "x".repeat(3 * LONGEST));
    let mut input = BufReader::with_capacity(100, text.as_bytes());
    let mut line = Vec::new();
    let mut lengths = Vec::new();
    while read_line(&mut input, &mut line).expect("it can be read") {
        lengths.push(line.len());
    }
    assert_eq!(lengths, [1, 0, LONGEST + 1, 1]);
}

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

#[test]
fn a_datagram_is_a_line_or_several() {
    let free = UdpSocket::bind("127.0.0.1:0").expect("there is a port");
    let to = free.local_addr().expect("it has an address");
    drop(free);
    let mut input = open(&format!("udp://{to}")).expect("the port is free");
    let from = UdpSocket::bind("127.0.0.1:0").expect("there is a port");
    for part in [&b"t,force"[..], b"", b"0,1\n0.01,2\n"] {
        from.send_to(part, to).expect("it can be sent");
    }
    let mut line = Vec::new();
    for expected in ["t,force", "", "0,1", "0.01,2"] {
        assert!(read_line(&mut input, &mut line).expect("it can be read"));
        assert_eq!(line, expected.as_bytes());
    }
}
