//! Columns in `import` and `run`: meanings, numbers for missing readings, units, formats.

use std::path::Path;

use tempfile::TempDir;

use crate::{ended, file as write, program};

/// Runs the program. Returns exit code, standard output and standard error.
fn cli(arguments: &[&str], file: &Path) -> (i32, String, String) {
    let (code, stdout, stderr) = ended(program().args(arguments).arg(file));
    (code.unwrap(), stdout, stderr)
}

#[track_caller]
fn import(arguments: &[&str], file: &Path) -> (String, String) {
    let (code, toml, said) = cli(&[&["import"], arguments].concat(), file);
    assert_eq!(code, 0, "{said}");
    (toml, said)
}

/// The free decay of an oscillator at sample `k` of a hundred in a second.
fn decay(k: u32) -> f64 {
    let t = 0.01 * f64::from(k);
    (-0.2 * t).exp() * (8.0 * t).sin()
}

/// Numbers like noise, from -1 to 1.
fn noise(k: u32) -> f64 {
    f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 23) - 1.0
}

fn rows(count: u32, row: impl Fn(u32, f64) -> String) -> String {
    (0..count).map(|k| row(k, 0.01 * f64::from(k)) + "\n").collect()
}

#[test]
fn raw_files_of_phones_videos_and_laboratories_need_no_argument() {
    let folder = TempDir::new().unwrap();
    let axis = |axis: &str| format!(",\"Linear Acceleration {axis} (m/s^2)\"");
    let phone = format!("\"Time (s)\"{}{}{}\n", axis("x"), axis("y"), axis("z"))
        + &rows(1500, |k, t| format!("{t:.9E},{:.9E},{:.9E},{:.9E}", decay(k), noise(k), noise(k + 7)));
    let tracker =
        "#mass_A\nt\tx\ty\n".to_owned() + &rows(1500, |k, t| format!("{t:.6E}\t{:.6E}\t{:.6E}", decay(k), noise(k)));
    let dropbear =
        "C:\\data\\test5.txt\nSampling Frequency - 100\nLow G Accel\tSG_300_a\tSG_306_b\tAccel\tPinLoc\tTime\n"
            .to_owned()
            + &"Voltage (unscaled)\t".repeat(5)
            + "Sec\n0.0 0.0 0\t\t\t\t\t\n\n"
            + &rows(1500, |k, t| {
                format!(
                    "{:.5E}\t{:.5E}\t{:.5E}\t{:.5E}\t1.228E+0\t{t:.5E}",
                    decay(k),
                    noise(k),
                    noise(k + 3),
                    noise(k + 9)
                )
            });
    for (name, text, sensor) in [
        ("phone.csv", phone, "[record.sensors.acceleration]\ncolumn = \"Linear Acceleration x\"\nunit = \"m/s^2\""),
        ("tracker.txt", tracker, "[record.sensors.displacement]\ncolumn = \"x\""),
        ("dropbear.txt", dropbear, "[record.sensors.acceleration]\ncolumn = \"Low G Accel\"\nunit = \"Voltage\""),
    ] {
        let (toml, said) = import(&[], &write(&folder, name, &text));
        assert!(toml.contains(sensor) && !toml.contains("[record.input]"), "{name}: {toml}");
        assert_eq!(toml.matches("[record.sensors.").count(), 1, "{name}: {toml}");
        assert!(said.contains("there is no column for the input; it is taken for zero"), "{name}: {said}");
    }
}

#[test]
fn formats_with_a_header_need_no_argument_either() {
    let folder = TempDir::new().unwrap();
    let five = |count: u32| {
        (0..count).map(|k| format!("{:15.7E}{}", decay(k), if k % 5 == 4 { "\n" } else { "" })).collect::<String>()
    };
    let at2 =
        "PEER NGA STRONG MOTION DATABASE RECORD\nNowhere, 1/1/2000, Gym, 180\nACCELERATION TIME SERIES IN UNITS OF G\n\
               NPTS=   1500, DT=   .0100 SEC,\n"
            .to_owned()
            + &five(1500);
    let slist = "TIMESERIES XX_A__DISP_R, 1500 samples, 100 sps, 2024-05-01T00:00:00.000000, SLIST, FLOAT, M\n"
        .to_owned()
        + &five(1500);
    let rigol = "X,CH1,Start,Increment,\nSequence,Volt,-2.0e-01,1.0e-02\n".to_owned()
        + &rows(1500, |k, _| format!("{k},{:.5e},,", decay(k)));
    for (name, text, form, sensor) in [
        ("a.at2", at2, "# PEER (AT2): 1 series of 1500 numbers, 0.01 s apart", "[record.sensors.acceleration]"),
        ("b.slist", slist, "# SLIST: 1 series of 1500 numbers, 0.01 s apart", "[record.sensors.displacement]"),
        ("c.csv", rigol, "# Rigol: UTF-8, commas between cells", "[record.sensors.displacement]"),
    ] {
        let (toml, said) = import(&[], &write(&folder, name, &text));
        assert!(toml.starts_with(form) && toml.contains(sensor), "{name}: {toml}");
        assert!(said.contains("column `time`: the time"), "{name}: {said}");
        let scenario = write(&folder, &format!("{name}.toml"), &toml);
        let (_, table, said) = cli(&["run"], &scenario);
        assert!(table.starts_with("1500 samples from") && table.contains("0.01 s apart"), "{name}: {table}{said}");
        let found = table.lines().find(|line| line.contains("natural frequency")).unwrap();
        let value: f64 = found.split_once("frequency").unwrap().1.split_whitespace().next().unwrap().parse().unwrap();
        assert!((value / 8.0 - 1.0).abs() < 0.02, "{name}: {found}");
        let hertz = table.lines().find(|line| line.contains("in Hz")).unwrap();
        assert!(hertz.contains("1.27") && hertz.contains(" Hz"), "{name}: {hertz}");
    }
}

#[test]
fn numbers_for_missing_readings_are_said_and_chosen() {
    let folder = TempDir::new().unwrap();
    let reading = |k: u32| if k % 97 == 5 { "-9999".to_owned() } else { format!("{:.6}", decay(k)) };
    let file = write(&folder, "gaps.csv", &("t,x\n".to_owned() + &rows(1500, |k, t| format!("{t:.2},{}", reading(k)))));
    let (toml, said) = import(&[], &file);
    assert!(toml.contains("missing = -9999.0"), "{toml}");
    assert!(said.contains("16 cell(s) of `x` are -9999, the first in line 7: they count as missing"), "{said}");
    let (toml, said) = import(&["--missing", "none"], &file);
    assert!(
        !toml.contains("\nmissing =") && said.contains("far from all others, the first in line 7: are they missing?"),
        "{said}"
    );
    let (toml, _) = import(&["--missing", "-9999"], &file);
    assert!(toml.contains("missing = -9999.0"), "{toml}");
    assert_eq!(cli(&["import", "--missing", "some"], &file).0, 2);
}

#[test]
fn slow_times_without_a_unit_are_asked_about() {
    let folder = TempDir::new().unwrap();
    let file = write(
        &folder,
        "slow.csv",
        &("time,x\n".to_owned() + &rows(1500, |k, _| format!("{},{:.6}", 10 * k, decay(k)))),
    );
    let (_, said) = import(&[], &file);
    assert!(said.contains("in seconds they are 0.1 samples a second: are they ms?"), "{said}");
    let (toml, said) = import(&["--time-unit", "ms"], &file);
    assert!(toml.contains("unit = \"ms\"") && !said.contains("are they ms"), "{toml}{said}");
    assert!(toml.contains("guess of ωₙ: 8.0") || toml.contains("guess of ωₙ: 7.9"), "{toml}");
    assert!(!import(&["--time-unit", "s"], &file).1.contains("are they ms"));
    assert_eq!(cli(&["import", "--time-unit", "mm"], &file).0, 2);
}

#[test]
fn import_writes_nothing_that_run_refuses() {
    let folder = TempDir::new().unwrap();
    let still = write(
        &folder,
        "still.csv",
        &("t,force,x\n".to_owned() + &rows(500, |k, t| format!("{t:.2},{:.4},2", noise(k)))),
    );
    let out = folder.path().join("out.toml");
    let refused = |arguments: &[&str], file: &Path, reason: &str| {
        let all = [&["import", "--out", out.to_str().unwrap()], arguments].concat();
        let (code, _, said) = cli(&all, file);
        assert_eq!(code, 2, "{said}");
        assert!(said.contains(reason) && !out.exists(), "{said}");
    };
    refused(&[], &still, "still.csv: all readings of the displacement are the same");
    let good = write(&folder, "good.csv", &("t,x\n".to_owned() + &rows(500, |k, t| format!("{t:.2},{:.6}", decay(k)))));
    let driven = "t,force,x\n".to_owned() + &rows(500, |k, t| format!("{t:.2},{:.4},{:.6}", noise(k), decay(k)));
    let driven = write(&folder, "driven.csv", &driven);
    for (rate, file) in ["1e300", "1e-300", "1e150"].into_iter().flat_map(|rate| [(rate, &good), (rate, &driven)]) {
        let (code, toml, said) = cli(&["import", "--rate", rate], file);
        let is_refused = code == 2 && toml.is_empty() && said.contains("error: ");
        assert!(is_refused || code == 0, "{rate}: {code} {said}");
        let scenario = write(&folder, "rate.toml", &toml);
        assert!(is_refused || cli(&["run"], &scenario).0 != 2, "{rate}: {toml}");
    }
    refused(&["--band", "60", "90"], &good, "must be below the Nyquist frequency, 50 Hz");
    let (_, said) = import(&["--band", "0.1", "90"], &good);
    assert!(said.contains("90 Hz, is not below the Nyquist frequency, 50 Hz"), "{said}");
}

#[test]
fn a_scenario_takes_the_sensors_that_it_has() {
    let folder = TempDir::new().unwrap();
    let text =
        "duration = 5.0\n[[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.001\n[[filters]]\nkind = \"ekf\"\n";
    let scenario = write(&folder, "scenario.toml", text);
    let table = "t,force,displacement,other_velocity,speed\n".to_owned()
        + &rows(500, |k, t| format!("{t:.2},{:.4},{:.6},{:.4},{:.4}", noise(k), decay(k), noise(k + 5), noise(k + 9)));
    let record = write(&folder, "record.csv", &table);
    let (_, table, said) = cli(&["run", "--record", record.to_str().unwrap()], &scenario);
    assert!(table.contains("measured: displacement\n"), "{table}");
    assert!(said.contains("left out: `other_velocity`, `speed`"), "{said}");
    assert!(!said.contains("taken for zero"), "{said}");
    let (_, _, said) = cli(&["run", "--no-input", "--record", record.to_str().unwrap()], &scenario);
    assert!(said.contains("there is no column for the input; it is taken for zero"), "{said}");
    let (_, _, said) = cli(
        &[
            "run",
            "--map",
            write(&folder, "map.toml", "no_input = true\n").to_str().unwrap(),
            "--record",
            record.to_str().unwrap(),
        ],
        &scenario,
    );
    assert!(said.contains("there is no column for the input; it is taken for zero"), "{said}");
}

#[test]
fn the_gain_of_a_force_is_told_as_one_over_the_mass() {
    let folder = TempDir::new().unwrap();
    let truth = "duration = 60.0\ndt = 0.04\nhold = \"first\"\nseed = 5\n[plant]\nnatural_frequency = 6.0\n\
                 [[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.002\n[[filters]]\nkind = \"ekf\"\n";
    let scenario = write(&folder, "truth.toml", truth);
    let record = folder.path().join("record.csv");
    assert_eq!(cli(&["run", "--record-out", record.to_str().unwrap()], &scenario).0, 0);
    // A mass of 2 kg.
    let twice = |line: &str| {
        let cells: Vec<f64> = line.split(',').take(3).map(|cell| cell.parse().unwrap()).collect();
        format!("{:.2},{:.6},{:.6}\n", cells[0], 2.0 * cells[1], cells[2])
    };
    let lines: String = std::fs::read_to_string(&record).unwrap().lines().skip(1).map(twice).collect();
    let file = write(&folder, "force.csv", &format!("t,force [N],x [m]\n{lines}"));
    let imported = write(&folder, "force.toml", &import(&[], &file).0);
    let (_, table, said) = cli(&["run"], &imported);
    let line = table.lines().find(|line| line.contains("1/mass")).unwrap_or_else(|| panic!("{table}{said}"));
    let value: f64 = line.split_once("1/mass").unwrap().1.split_whitespace().next().unwrap().parse().unwrap();
    assert!((value - 0.5).abs() < 0.01 && line.trim_end().contains("1/kg"), "{line}");
    let report = folder.path().join("report.html");
    assert_eq!(cli(&["report", "--out", report.to_str().unwrap()], &imported).0, 0);
    let page = std::fs::read_to_string(&report).unwrap();
    assert!(page.contains("1/mass") && page.contains("in Hz"));
}
