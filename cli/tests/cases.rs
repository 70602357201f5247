//! Files as other programs write them, in `cases`: each gives the natural frequency and the damping of the oscillator behind it, or a
//! sentence.

use std::fs;
use std::path::Path;

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
    ("lvm-two-rates.lvm", &[], FoundAndSaid(12.566, 0.05, &["clocks of their own, `time` and `time (2)`"])),
    (
        "lvm-three-impacts-one-header.lvm",
        &[],
        FoundAndSaid(31.416, 0.02, &["the header says 200 rows, but there are 600", "3 part(s) of 200"]),
    ),
    ("lvm-steps-without-times.lvm", &[], FoundAndSaid(15.0, 0.04, &["clocks of their own"])),
    ("uff58-frf-only.uff", &[], Refused(&["is a frequency response, no function of time"])),
    ("uff58b.uff", &[], Read(&["acceleration: its name says so"])),
    ("export.zip", &[], Read(&["the table is `Raw Data.csv` of the ZIP"])),
    ("knet.EW", &[], FoundAndSaid(10.053, 0.03, &["one series", "a step of 0.01 s, the unit gal, a scale"])),
    ("knet.EW", &["--rate", "100"], Found(10.053, 0.03)),
    (
        "first-rows-start-and-rate.csv",
        &["--rate", "32", "--no-input", "--sensor", "acceleration=column 1"],
        FoundAndSaid(9.425, 0.03, &["the first 2 rows are a time, the start, and 32, the samples a second"]),
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
    ("phone-nanoseconds-z-y-x.csv", &["--decay", "d.csv"], Found(7.54, 0.01)),
    ("printer-accelerometer.csv", &[], Found(282.74, 0.06)),
    ("printer-accelerometer.csv", &["--decay", "d.csv"], Found(282.74, 0.06)),
    ("phone-gyroscope.csv", &[], Found(7.54, 0.01)),
    ("weather.csv", &[], Refused(&["`Pressure`: left out: its unit is neither", "no column is chosen for a sensor"])),
    ("encoder-355.csv", &[], FoundAndSaid(5.655, 0.01, &["an angle that wraps"])),
    ("short-record-in-counts.csv", &[], Found(12.566, 0.05)),
    ("absolute-as-relative.csv", &["--ground", "--input", "ground"], Found(6.0, 0.05)),
    ("ambient-irregular.csv", &["--no-input"], Inside(6.0, &["each reading at its own time"])),
    ("two-clocks-ns.csv", &[], Read(&["ns since 1970", "clocks of their own, `time` and `stamp`"])),
];

/// A scenario with a fault, or a file with the arguments behind its name; whether the record of the run has no truth; and words of the
/// first line that names a cause or a likelier model.
const FAULTS: &[(&str, &[&str], bool, &str)] = &[
    ("euler.toml", &[], false, "cause 1: steps of the propagation that are too coarse"),
    ("euler.toml", &[], true, "likelier model 1: steps of the propagation that are too coarse"),
    ("q-on-velocity.toml", &[], true, "likelier model 1: a white force in place of Q"),
    ("bias-estimated-without-q.toml", &[], false, "cause 1: a sensor's bias or drift"),
    ("coloured-noise.toml", &[], false, "cause 1: coloured noise of a sensor"),
    ("r-as-variance.toml", &[], false, "cause 1: R of a sensor: R of the displacement is 10000 times too small"),
    ("acceleration-in-g.toml", &[], false, "cause 1: the scale of a sensor"),
    (
        "zero-spread-stiffness.toml",
        &[],
        false,
        "cause 1: an initial guess that is too sure: σ of the natural frequency is 0",
    ),
    (
        "rate-90-for-100.csv",
        &["--rate", "90", "--sensor", "displacement=disp", "--sensor", "velocity=speed", "--input", "force"],
        false,
        "samples a second and not 90",
    ),
    (
        "absolute-as-relative.csv",
        &["--ground", "--input", "ground", "--sensor", "acceleration=acc"],
        false,
        "cause 1: an absolute accelerometer taken for a relative one",
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
        let first = table.lines().find(|line| line.contains(" 1: ")).unwrap_or_default();
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
        let is_inside = numbers.len() == 2 && (numbers[0] - estimates[0]).abs() <= 2.0 * numbers[1];
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
