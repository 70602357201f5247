//! Files as other programs write them, in `cases`: each gives the natural frequency and the damping of the oscillator behind it, or a
//! sentence.

use std::fs;
use std::path::Path;

use kalmanscope_core::{Channel, Force, Hold, Quantity, Scenario, Sensor, simulate};

use crate::Folder;

enum Wanted {
    /// Natural frequency \[rad/s\] within 1 %, damping ratio within 20 %.
    Found(f64, f64),
    /// The same, and all of these words.
    FoundAndSaid(f64, f64, &'static [&'static str]),
    /// Natural frequency \[rad/s\] inside ±2σ of a filter that is not overconfident, and all of these words.
    Inside(f64, &'static [&'static str]),
    /// A record, and all of these words.
    Read(&'static [&'static str]),
    /// No record, and all of these words.
    Refused(&'static [&'static str]),
}

use Wanted::{Found, FoundAndSaid, Inside, Read, Refused};

const CASES: &[(&str, &[&str], Wanted)] = &[
    ("lvm-comma.lvm", &[], Found(12.566, 0.05)),
    ("lvm-two-rates.lvm", &[], FoundAndSaid(12.566, 0.05, &["has its own clock, `time` and `time (2)`"])),
    (
        "lvm-three-impacts-one-header.lvm",
        &[],
        FoundAndSaid(31.416, 0.02, &["the header says 200 rows, but there are 600", "3 part(s) of 200"]),
    ),
    ("lvm-steps-without-times.lvm", &[], FoundAndSaid(15.0, 0.04, &["has its own clock"])),
    ("uff58-frf-only.uff", &[], Refused(&["is a frequency response, not a function of time"])),
    ("uff58b.uff", &[], Read(&["acceleration: its name says so"])),
    ("export.zip", &[], Read(&["the table is `Raw Data.csv` of the ZIP"])),
    ("knet.EW", &[], FoundAndSaid(10.053, 0.03, &["one series", "a step of 0.01 s, the unit gal, a scale"])),
    ("knet.EW", &["--rate", "100"], Found(10.053, 0.03)),
    (
        "first-rows-start-and-rate.csv",
        &["--rate", "32", "--no-input", "--sensor", "acceleration=column 1"],
        FoundAndSaid(9.425, 0.03, &["the first 2 rows are the start time and the sample rate, 32 samples a second"]),
    ),
    ("first-rows-start-and-rate.csv", &["--no-input", "--sensor", "acceleration=column 1"], Found(9.425, 0.03)),
    ("clock-with-colon-ms.csv", &["--no-input", "--sensor", "acceleration=gFy"], Found(7.54, 0.01)),
    ("whole-seconds.csv", &[], Refused(&["stands still", "about 50 rows have the same time", "about 50 Hz"])),
    ("whole-seconds.csv", &["--rate", "50"], Found(12.566, 0.05)),
    ("epoch-ns.csv", &[], FoundAndSaid(12.566, 0.05, &["ns since 1970"])),
    ("spreadsheet-days.csv", &[], FoundAndSaid(12.566, 0.05, &["days of a spreadsheet"])),
    ("micros-roll-over.csv", &[], FoundAndSaid(12.566, 0.05, &["turns over at 4294967296 in line 3"])),
    ("events-twice.csv", &[], FoundAndSaid(12.566, 0.05, &["3 rows have the time of the row before them"])),
    ("one-sensor-a-line.csv", &[], Found(12.566, 0.05)),
    ("counter-with-drops.csv", &["--rate", "50"], FoundAndSaid(12.566, 0.05, &["`SampleC` counts the samples"])),
    ("counter-turns-over.csv", &["--rate", "100"], FoundAndSaid(15.0, 0.04, &["`cnt` counts the samples"])),
    ("counter-with-drops.csv", &[], Refused(&["state the sample rate"])),
    (
        "infinity-sign.csv",
        &["--input", "Channel A", "--sensor", "displacement=Channel B"],
        FoundAndSaid(12.566, 0.05, &["a word such as `∞`", "they count as missing"]),
    ),
    ("autopilot-log.csv", &[], FoundAndSaid(7.54, 0.01, &["by their steps they are µs"])),
    ("autopilot-log.csv", &["--decay", "d.csv"], Found(7.54, 0.01)),
    ("phone-nanoseconds-z-y-x.csv", &[], Found(7.54, 0.01)),
    (
        "phone-nanoseconds-z-y-x.csv",
        &["--decay", "d.csv"],
        FoundAndSaid(7.54, 0.01, &["a free decay: ", " s on, along (", "fitted to all its readings"]),
    ),
    ("printer-accelerometer.csv", &[], Found(282.74, 0.06)),
    ("printer-accelerometer.csv", &["--decay", "d.csv"], Found(282.74, 0.06)),
    ("phone-gyroscope.csv", &[], Found(7.54, 0.01)),
    ("weather.csv", &[], Refused(&["`Pressure`: left out: its unit is that", "no column is chosen for a sensor"])),
    ("encoder-355.csv", &[], FoundAndSaid(5.655, 0.01, &["an angle that wraps"])),
    ("short-record-in-counts.csv", &[], Found(12.566, 0.05)),
    ("absolute-as-relative.csv", &["--ground", "--input", "ground"], Found(6.0, 0.05)),
    ("ambient-irregular.csv", &["--no-input"], Inside(6.0, &["each reading at its own time"])),
    ("two-clocks-ns.csv", &[], Read(&["ns since 1970", "has its own clock, `time` and `stamp`"])),
    ("newest-first.csv", &[], FoundAndSaid(12.0, 0.05, &["the rows are read from last to first"])),
    ("packets-out-of-order.csv", &[], FoundAndSaid(12.0, 0.05, &["they are sorted"])),
    ("seconds-and-nanoseconds.csv", &[], FoundAndSaid(12.0, 0.05, &["they are one time"])),
    ("ticks-of-windows.csv", &[], FoundAndSaid(12.0, 0.05, &["ticks of 100 ns since 1601"])),
    ("week-of-gps.csv", &[], FoundAndSaid(12.0, 0.05, &["turns over at 604800"])),
    ("keys-above-names.csv", &[], FoundAndSaid(12.0, 0.05, &["the file says 50 samples a second"])),
    ("names-again.csv", &[], FoundAndSaid(12.0, 0.05, &["line 502 has words in place of numbers"])),
    ("times-behind.csv", &[], FoundAndSaid(12.0, 0.05, &["has its own clock, `t_force` and `t_disp`"])),
    ("clocks-apart.csv", &[], Refused(&["fewer than 2 samples in common"])),
    ("channel-a-row.csv", &[], Refused(&["give each channel a column of its own"])),
    ("supply-beside.csv", &[], Found(12.0, 0.05)),
    ("times-and-values.inp", &["--no-input"], FoundAndSaid(12.0, 0.05, &["times and values in turn"])),
    ("numbered-lines.txt", &["--no-input", "--rate", "50"], FoundAndSaid(12.0, 0.05, &["one series"])),
    ("one-line.txt", &["--no-input", "--rate", "50"], Found(12.0, 0.05)),
    ("nameless.txt", &["--no-input"], Found(12.0, 0.05)),
    ("duet.csv", &["--decay", "d.csv"], Found(12.0, 0.05)),
];

/// Writes the files that are made of one record and of one decay.
fn write_files(folder: &Folder) {
    let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 20.0, sweep: 15.0 };
    let mut scenario = Scenario { dt: 0.02, duration: 20.0, hold: Hold::First, force, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 12.0);
    scenario.plant.set(Channel::DAMPING_RATIO, 0.05);
    scenario.sensors.clear();
    scenario.add_sensor(Sensor::new(Quantity::DISPLACEMENT, 2e-4));
    let record = simulate(&scenario);
    let all: Vec<(u64, f64, f64)> =
        (0..record.len()).map(|k| (k as u64, record.input()[k], record.measured(0)[k])).collect();
    let file = |name: &str, header: &str, rows: &mut dyn Iterator<Item = String>| {
        folder.file(name, &(header.to_owned() + &rows.collect::<String>()));
    };
    let row = |(k, f, x): &(u64, f64, f64)| format!("{:.2},{f},{x}\n", *k as f64 * 0.02);
    let header = "time,force,displacement\n";
    file("newest-first.csv", header, &mut all.iter().rev().map(row));
    let packets = all.chunks(20).flat_map(|part| part[part.len() / 2..].iter().chain(&part[..part.len() / 2]));
    file("packets-out-of-order.csv", header, &mut packets.map(row));
    let nano = |(k, f, x): &(u64, f64, f64)| format!("{},{},{f},{x}\n", 1_700_000_000 + k / 50, k % 50 * 20_000_000);
    file("seconds-and-nanoseconds.csv", "stamp.secs,stamp.nsecs,force,displacement\n", &mut all.iter().map(nano));
    let ticks = |(k, f, x): &(u64, f64, f64)| format!("{},{f},{x}\n", 133_590_240_000_000_000 + k * 200_000);
    file("ticks-of-windows.csv", header, &mut all.iter().map(ticks));
    let week = |(k, f, x): &(u64, f64, f64)| format!("{:.2},{f},{x}\n", (604_790.0 + *k as f64 * 0.02) % 604_800.0);
    file("week-of-gps.csv", header, &mut all.iter().map(week));
    let keys = "Serial,123\nSample Rate,50\nForce,Displacement\n";
    file("keys-above-names.csv", keys, &mut all.iter().map(|(_, f, x)| format!("{f},{x}\n")));
    let again = |one: &(u64, f64, f64)| if one.0 == 500 { header.to_owned() + &row(one) } else { row(one) };
    file("names-again.csv", header, &mut all.iter().map(again));
    let at = |k: usize, start: f64| {
        all.get(2 * k).map_or(",".to_owned(), |(k, _, x)| format!("{x},{}", start + *k as f64 * 0.02))
    };
    let two = |(k, f, _): &(u64, f64, f64)| format!("{f},{},{}\n", *k as f64 * 0.02, at(*k as usize, 0.0));
    file("times-behind.csv", "force,t_force,disp,t_disp\n", &mut all.iter().map(two));
    let apart = |(k, f, _): &(u64, f64, f64)| format!("{f},{},{}\n", *k as f64 * 0.02, at(*k as usize, 1.7e9));
    file("clocks-apart.csv", "force,t_force,disp,t_disp\n", &mut all.iter().map(apart));
    let long =
        |(k, f, x): &(u64, f64, f64)| format!("{},force,{f}\n{},disp,{x}\n", *k as f64 * 0.02, *k as f64 * 0.02 + 1e-3);
    file("channel-a-row.csv", "time,channel,value\n", &mut all.iter().map(long));
    let beside =
        |(k, f, x): &(u64, f64, f64)| format!("{},{},{f},{x}\n", *k as f64 * 0.02, 5.0 + 1e-3 * (k * k % 97) as f64);
    file("supply-beside.csv", "time,Vin,F_cell,LVDT\n", &mut all.iter().map(beside));
    let decay =
        |k: usize| (-0.6 * k as f64 * 0.02).exp() * (11.985 * k as f64 * 0.02).cos() + 1e-3 * (k * k % 7) as f64;
    let numbers = |from: usize| (from..from + 5).map(|k| format!(" {:.5}", decay(k))).collect::<String>();
    let pairs = |from: usize| {
        (from..from + 4).map(|k| format!("{:.2}, {:.5}, ", k as f64 * 0.02, decay(k))).collect::<String>() + "\n"
    };
    file("times-and-values.inp", "*AMPLITUDE, NAME=A\n", &mut (0..400).step_by(4).map(pairs));
    file("numbered-lines.txt", "", &mut (0..400).step_by(5).map(|k| format!("{}{}\n", k + 1, numbers(k))));
    file("one-line.txt", "", &mut (0..1100).step_by(5).map(numbers));
    file("nameless.txt", "", &mut (0..400).map(|k| format!("{} {:.5} {}\n", k as f64 * 0.02, decay(k), k * k % 5)));
    let axes = (0..400).map(|k| format!("{k},{:.5},{:.5},{}\n", 0.3 * decay(k), 1e-3 * (k * k % 5) as f64, 1.0));
    file("duet.csv", "Sample,X,Y,Z\n", &mut axes.chain(["Rate 50, overflows 0\n".to_owned()]));
}

/// A scenario with a fault, or a file with the arguments behind its name; whether the record of the run has no truth; and words of the
/// first line that names a cause or a likelier model.
const FAULTS: &[(&str, &[&str], bool, &str)] = &[
    ("euler.toml", &[], false, "): steps of the propagation that are too coarse"),
    ("euler.toml", &[], true, "likelier model 1: steps of the propagation that are too coarse"),
    ("q-on-velocity.toml", &[], true, "likelier model 1: a white force in place of Q"),
    ("hardens-a-little.toml", &[], true, "likelier model 1: a spring that hardens"),
    ("coarse-and-late-change.toml", &[], true, "): the coarse steps of a sensor"),
    ("scale-and-large-r.toml", &[], true, "): the scale of a sensor"),
    ("bias-estimated-without-q.toml", &[], false, "): a sensor's bias or drift"),
    ("coloured-noise.toml", &[], false, "): coloured noise of a sensor"),
    ("r-as-variance.toml", &[], false, "): R of a sensor: R of the displacement is 10000 times too small"),
    ("acceleration-in-g.toml", &[], false, "): the scale of a sensor"),
    ("zero-spread-stiffness.toml", &[], false, "guess with too small a σ: σ of the natural frequency is 0"),
    (
        "rate-90-for-100.csv",
        &["--rate", "90", "--sensor", "displacement=disp", "--sensor", "velocity=speed", "--input", "force"],
        false,
        "samples a second, not 90",
    ),
    (
        "absolute-as-relative.csv",
        &["--ground", "--input", "ground", "--sensor", "acceleration=acc"],
        false,
        "): an accelerometer of the wrong kind",
    ),
];

#[test]
fn each_fault_has_its_name() {
    let folder = cases();
    let failed = FAULTS.iter().filter_map(|(file, import, has_no_truth, words)| {
        let mut arguments = vec!["run", *file];
        if !import.is_empty() {
            folder.succeeds(&[&["import", file, "--out", "s.toml"], *import].concat());
            arguments = vec!["run", "s.toml"];
        }
        if *has_no_truth {
            folder.succeeds(&["run", file, "--quiet", "--record-out", "r.csv"]);
            let text = fs::read_to_string(folder.path("r.csv")).unwrap();
            let names = text.lines().next().unwrap().split(',');
            let columns = names.take_while(|name| !name.starts_with("true")).count();
            let kept = |line: &str| line.split(',').take(columns).collect::<Vec<_>>().join(",") + "\n";
            fs::write(folder.path("r.csv"), text.lines().map(kept).collect::<String>()).unwrap();
            arguments.extend(["--record", "r.csv"]);
        }
        let (table, _) = folder.succeeds(&arguments);
        let first = table.lines().find(|line| line.contains(" 1: ") || line.contains(" 1 (")).unwrap_or_default();
        (!first.contains(words)).then(|| format!("{file}: no `{words}` in {table}"))
    });
    let failed: Vec<String> = failed.collect();
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), FAULTS.len(), failed.join("\n"));
    let (table, _) = folder.succeeds(&["run", "known-parameter.toml"]);
    assert!((crate::value(&table, "parameter c") - 0.3).abs() < 0.003 && !table.contains('∞'), "{table}");
}

fn cases() -> Folder {
    let folder = Folder::new();
    for file in fs::read_dir(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases")).unwrap() {
        let file = file.unwrap();
        fs::copy(file.path(), folder.path(file.file_name().to_str().unwrap())).unwrap();
    }
    write_files(&folder);
    folder
}

#[test]
fn each_file_is_read_or_said() {
    let folder = cases();
    let failed: Vec<String> = CASES.iter().filter_map(|case| failure(&folder, case)).collect();
    assert!(failed.is_empty(), "{} of {}:\n{}", failed.len(), CASES.len(), failed.join("\n"));
}

fn failure(folder: &Folder, (file, arguments, wanted): &(&str, &[&str], Wanted)) -> Option<String> {
    let _ = fs::remove_file(folder.path("d.csv"));
    let (code, _, said) = folder.call(&[&["import", file, "--out", "s.toml"], *arguments].concat());
    let bad = |reason: &str| Some(format!("{file} {arguments:?}: {reason}: {said}"));
    let (estimates, words) = match wanted {
        Found(wn, zeta) => (Some([*wn, *zeta]), &[][..]),
        FoundAndSaid(wn, zeta, words) => (Some([*wn, *zeta]), *words),
        Inside(wn, words) => (Some([*wn, f64::NAN]), *words),
        Read(words) | Refused(words) => (None, *words),
    };
    if let Some(word) = words.iter().find(|word| !said.contains(**word)) {
        return bad(&format!("no word of `{word}`"));
    }
    let is_read = !matches!(wanted, Refused(_));
    if (code == 0) != is_read {
        return bad(&format!("code {code}"));
    }
    let estimates = estimates?;
    let (table, _) = folder.succeeds(&["run", "s.toml"]);
    if matches!(wanted, Inside(..)) {
        let line = table.lines().find(|line| line.contains("ωₙ natural frequency")).unwrap_or_default();
        let numbers: Vec<f64> = line.split_whitespace().filter_map(|word| word.parse().ok()).collect();
        let is_inside = numbers.len() >= 2 && (numbers[0] - estimates[0]).abs() <= 2.0 * numbers[1];
        return if is_inside && !table.contains("overconfident") { None } else { bad(&table) };
    }
    let found = ["ωₙ natural frequency", "ζ  damping ratio"].map(|name| crate::value(&table, name));
    let is_near = |place: usize, within: f64| (found[place] / estimates[place] - 1.0).abs() <= within;
    if is_near(0, 0.01) && is_near(1, 0.2) { None } else { bad(&format!("{found:?} for {estimates:?}")) }
}

/// A stream whose times may be milliseconds is asked about, and a first time of a clock that was not set is left out.
#[test]
fn the_times_of_streams_are_asked_about() {
    let folder = Folder::new();
    let text =
        |name: &str| fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/cases").join(name)).unwrap();
    folder.file("stream.toml", &text("stream.toml"));
    let (_, _, said) = folder.fed(&["stream", "stream.toml", "-"], text("stream-ms.csv").as_bytes());
    assert!(said.contains("are the times ms?"), "{said}");
    let rows = (0..400_u32).map(|k| format!("{},0,{:.5}\n", 1.7e9 + 0.01 * f64::from(k), (0.06 * f64::from(k)).cos()));
    let lines = "t,force,displacement\n0,0,1\n".to_owned() + &rows.collect::<String>();
    let (code, table, said) = folder.fed(&["stream", "stream.toml", "-"], lines.as_bytes());
    assert_eq!((code, said.lines().count(), table.lines().count()), (0, 1, 402), "{said}");
    assert!(said.contains("line 2: its time, 0 s, is far from that of the next line"), "{said}");
}
