//! Columns in `import` and `run`: meanings, numbers for missing readings, units, formats.

use crate::Folder;

#[track_caller]
fn imported(folder: &Folder, name: &str, text: &str) -> (String, String) {
    folder.file(name, text);
    folder.succeeds(&["import", name])
}

/// The free decay of an oscillator at sample `k` of a hundred in a second.
fn decay(k: u32) -> f64 {
    let t = 0.01 * f64::from(k);
    (-0.2 * t).exp() * (8.0 * t).sin()
}

fn noise(k: u32) -> f64 {
    f64::from(k.wrapping_mul(2_654_435_761) >> 8) / f64::from(1 << 23) - 1.0
}

fn rows(count: u32, row: impl Fn(u32, f64) -> String) -> String {
    (0..count).map(|k| row(k, 0.01 * f64::from(k)) + "\n").collect()
}

/// Files as instruments write them, and what is said of them or written for them.
#[test]
fn forms_of_instruments_need_no_argument_and_others_are_named() {
    let folder = Folder::new();
    let signed = |x: f64| if x < 0.0 { format!("- {:.4}", -x) } else { format!("+ {x:.4}") };
    let comma = |x: f64| format!("{x:.5}").replace('.', ",");
    let over_lines = |count: u32, many: u32, cell: fn(u32) -> String| {
        (0..count).map(|k| cell(k) + if k % many == many - 1 { "\n" } else { " " }).collect::<String>()
    };
    let whole = |k: u32| format!("{:.0}", 1e4 * decay(k));
    let force = |k: u32| noise(k) * 10.0;
    let three = |count| rows(count, |k, t| format!("{t:.2},{:.3},{:.5}", force(k), decay(k)));
    for (name, text, expected) in [
        (
            "signs.csv",
            "No.,Time,disp[mm]\n".to_owned() + &rows(1500, |k, t| format!("{},{t:.2},{}", k + 1, signed(decay(k)))),
            &["column `disp`: displacement"][..],
        ),
        (
            "keys.asc",
            "export\nKanal;Kraft;Beschl\nEinheit;N;m/s^2\nAbtastzeit;0,01;0,01\nAnzahl;1500;1500\n".to_owned()
                + &rows(1500, |k, _| format!(";{};{}", comma(force(k)), comma(decay(k)))),
            &["column `Kraft`: the input", "column `Beschl`: acceleration", "the file says 100 samples a second"],
        ),
        (
            "rate.csv",
            "\"Header Size\",3\n\"TraceName\",\"Disp\",\"\"\n\"SampleRate\",1.0E+02,1.0E+02\n".to_owned()
                + &rows(1500, |k, _| format!("{:.5E},{:.5E},", force(k), decay(k))),
            &["the file says 100 samples a second"],
        ),
        (
            "whole.gse",
            "WID2 2024/03/05 00:00:00.000 TOWR  HHE      INT      1500  100.000000   1.00e+00   1.000 NONE    -1.0 -0.0\n\
             DAT2\n"
                .to_owned()
                + &over_lines(1500, 9, whole)
                + "\nCHK2    26294\n\nSTOP\n",
            &["one series that continues", "a step of 0.01 s", "column `velocity`: velocity"],
        ),
        (
            "apart.asc",
            "DELTA: 1.000000e-02\nLENGTH: 1500\nCOMP: E\nCHAN1: H\nCHAN2: N\nSTATION: TOWR\n".to_owned()
                + &over_lines(1500, 4, |k| format!("{:.6e}", decay(k))),
            &["one series that continues", "column `acceleration`: acceleration"],
        ),
        (
            "below.asc",
            "Messung 12\nTime  1\tMX_2 Weg\ns\tmm\ndt=0.01 s\tdt=0.01 s\nT0\t05.03.2024\n".to_owned()
                + &rows(1500, |k, t| format!("{}\t{}", comma(t), comma(decay(k)))),
            &["column `MX_2 Weg`: displacement", "unit = \"mm\""],
        ),
        (
            "sum.txt",
            "Zeit [s]\tWeg [mm]\n".to_owned()
                + &rows(1500, |k, t| format!("{t:.2}\t{:.5}", decay(k)))
                + "Maximum:\t0.97\n",
            &["line 1502 has words in place of numbers"],
        ),
        (
            "wind.csv",
            "Time,Wind force [N],Sway [cm]\n".to_owned() + &three(1500),
            &["column `Wind force`: the input", "column `Sway`: displacement"],
        ),
        (
            "sol.csv",
            "Temps (s),Accélération du sol (m/s²),Déplacement (mm)\n".to_owned() + &three(1500),
            &["column `Accélération du sol`: the input"],
        ),
        (
            "base.csv",
            "t [s],Base displacement [mm],Mass displacement [mm]\n".to_owned() + &three(1500),
            &["column `Base displacement`: left out: of the ground's motions", "column `Mass displacement`: displacement"],
        ),
    ] {
        let (toml, said) = imported(&folder, name, &text);
        let all = toml + &said;
        assert!(expected.iter().all(|part| all.contains(part)), "{name}: {said}");
    }
    let card = " ".repeat(3120) + "C40 END" + &" ".repeat(73) + &"\0".repeat(25) + "\u{5}" + &"\0".repeat(500);
    for (text, kind) in [
        ("Obj\u{1}\u{4}", "an Avro file"),
        ("<stata_dta><header>", "a file of Stata"),
        (card.as_str(), "a SEG-Y file"),
        ("[{\"t\": 0.0, \"x\": 1.0}, {\"t\": 0.1, \"x\": 2.0}]", "JSON"),
        ("WID2 1970/01/01 00:00:00.000 A     HNZ      CM6     6000 1000.000000\nDAT2\nybPjoQ\n", "a GSE seismogram"),
    ] {
        folder.file("other", text);
        let (_, _, said) = folder.call(&["import", "other"]);
        assert!(said.contains(&format!("this is {kind}")), "{kind}: {said}");
    }
}

#[test]
fn numbers_for_missing_readings_are_said_and_chosen() {
    let folder = Folder::new();
    let reading = |k: u32| if k % 97 == 5 { "-9999".to_owned() } else { format!("{:.6}", decay(k)) };
    let text = "t,x\n".to_owned() + &rows(1500, |k, t| format!("{t:.2},{}", reading(k)));
    let (toml, said) = imported(&folder, "gaps.csv", &text);
    assert!(toml.contains("missing = -9999.0"), "{toml}");
    assert!(said.contains("16 cell(s) of `x` are -9999, the first in line 7: they count as missing"), "{said}");
    let (toml, said) = folder.succeeds(&["import", "--missing", "none", "gaps.csv"]);
    assert!(
        !toml.contains("\nmissing =") && said.contains("far from all others, the first in line 7: are they missing?"),
        "{said}"
    );
    let (toml, _) = folder.succeeds(&["import", "--missing", "-9999", "gaps.csv"]);
    assert!(toml.contains("missing = -9999.0"), "{toml}");
}

#[test]
fn slow_times_without_a_unit_are_asked_about() {
    let folder = Folder::new();
    let text = "time,x\n".to_owned() + &rows(1500, |k, _| format!("{},{:.6}", 10 * k, decay(k)));
    let (_, said) = imported(&folder, "slow.csv", &text);
    assert!(said.contains("by their steps they are ms, 100 samples a second; in seconds one in 10 s"), "{said}");
    let (toml, said) = folder.succeeds(&["import", "--time-unit", "ms", "slow.csv"]);
    assert!(toml.contains("unit = \"ms\"") && !said.contains("have no unit"), "{toml}{said}");
    assert!(toml.contains("guess of ωₙ: 8.0") || toml.contains("guess of ωₙ: 7.9"), "{toml}");
    assert!(!folder.succeeds(&["import", "--time-unit", "s", "slow.csv"]).1.contains("have no unit"));
}

#[test]
fn import_writes_nothing_that_run_refuses() {
    let folder = Folder::new();
    folder.file("good.csv", &("t,x\n".to_owned() + &rows(500, |k, t| format!("{t:.2},{:.6}", decay(k)))));
    let driven = |k: u32, t: f64| format!("{t:.2},{:.4},{:.6}", noise(k), decay(k));
    folder.file("driven.csv", &("t,force,x\n".to_owned() + &rows(500, driven)));
    for (rate, file) in
        ["1e300", "1e-300", "1e150"].into_iter().flat_map(|rate| [(rate, "good.csv"), (rate, "driven.csv")])
    {
        let (code, toml, said) = folder.call(&["import", "--rate", rate, file]);
        let is_refused = code == 2 && toml.is_empty() && said.contains("error: ");
        assert!(is_refused || code == 0, "{rate}: {code} {said}");
        folder.file("rate.toml", &toml);
        assert!(is_refused || folder.call(&["run", "rate.toml"]).0 != 2, "{rate}: {toml}");
    }
    let (_, said) = folder.succeeds(&["import", "--band", "0.1", "90", "good.csv"]);
    assert!(said.contains("90 Hz, is not below the Nyquist frequency, 50 Hz"), "{said}");
}

#[test]
fn a_scenario_takes_the_sensors_that_it_has() {
    let text =
        "duration = 5.0\n[[sensors]]\nmeasures = \"displacement\"\nnoise_std = 0.001\n[[filters]]\nkind = \"ekf\"\n";
    let folder = Folder::of(text);
    let table = "t,force,displacement,other_velocity,speed\n".to_owned()
        + &rows(500, |k, t| format!("{t:.2},{:.4},{:.6},{:.4},{:.4}", noise(k), decay(k), noise(k + 5), noise(k + 9)));
    folder.file("record.csv", &table);
    let run = ["run", "scenario.toml", "--record", "record.csv"];
    let (_, table, said) = folder.call(&run);
    assert!(table.contains("measured: displacement\n"), "{table}");
    assert!(said.contains("left out: `other_velocity`, `speed`"), "{said}");
    assert!(!said.contains("counts as zero"), "{said}");
    let (_, _, said) = folder.call(&[&run[..], &["--no-input"]].concat());
    assert!(said.contains("there is no column for the input; it counts as zero"), "{said}");
}
