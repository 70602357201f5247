//! Reports, pictures and estimates of the built command.

use crate::Folder;

/// A filter that is too sure of its sensor, so that it has a verdict, evidence and causes.
const OVERCONFIDENT: &str = "duration = 20.0\n[[filters]]\nname = \"<script>alert(1)</script>\"\n\
                             sensor_std = [0.001, 0.001]\nkind = \"ekf\"";

#[test]
fn a_report_is_one_page_without_scripts() {
    let folder = Folder::of(OVERCONFIDENT);
    folder.succeeds(&["run", "scenario.toml", "--out", "report.html"]);
    let page = folder.read("report.html");
    assert!(page.starts_with("<!doctype html>") && page.trim_end().ends_with("</html>"));
    for part in [
        "default-src 'none'; style-src 'unsafe-inline'",
        "<h1>scenario</h1>",
        "2001 samples from 0 s to 20 s",
        "&lt;script&gt;alert(1)&lt;/script&gt;",
        "overconfident: ",
        "<h4>cause 1 (",
        "sensor_std = ",
        "natural frequency",
        "prefers-color-scheme: dark",
        "@media print",
        "[[filters]]",
    ] {
        assert!(page.contains(part), "{part} is missing");
    }
    assert_eq!((page.matches("<svg ").count(), page.matches("</svg>").count()), (2, 2), "four plots, three on a page");
    for part in ["<script", " src=", " href=", "@import", "NaN"] {
        assert!(!page.contains(part), "{part}");
    }
    assert!(page.split("url(").skip(1).all(|rest| rest.starts_with("#clip_")), "nothing is loaded");
    // An id of one figure must not be another area in the next one.
    let mut ids: Vec<&str> = page.split("<clipPath ").skip(1).filter_map(|rest| rest.split("</").next()).collect();
    ids.sort_unstable();
    ids.dedup();
    let names: std::collections::BTreeSet<&str> = ids.iter().filter_map(|id| id.split('>').next()).collect();
    assert!(names.len() == ids.len() && ids.len() >= 3, "{ids:?}");
    assert!(page.len() < 1_500_000, "{} bytes", page.len());
}

#[test]
fn sensors_have_plots_where_no_channel_shows_them() {
    let folder = Folder::of("duration = 5.0");
    folder.succeeds(&["run", "scenario.toml", "--record-out", "record.csv", "--out", "simulated.svg"]);
    let kept = |line: &str| line.split(',').take(4).collect::<Vec<_>>().join(",") + "\n";
    folder.file("measured.csv", &folder.read("record.csv").lines().map(kept).collect::<String>());
    folder.succeeds(&["run", "scenario.toml", "--record", "measured.csv", "--out", "measured.svg"]);
    folder.file("a.toml", "duration = 5.0\n[[sensors]]\nmeasures = \"acceleration\"\nnoise_std = 0.3");
    folder.succeeds(&["run", "a.toml", "--out", "acceleration.svg"]);
    for (file, sensor, count) in [
        ("simulated.svg", "predicted displacement", 0),
        ("measured.svg", "predicted displacement", 1),
        ("measured.svg", "predicted velocity", 1),
        ("acceleration.svg", "predicted acceleration", 1),
    ] {
        let svg = folder.read(file);
        assert_eq!(svg.matches(sensor).count(), count, "{file}, {sensor}");
        assert!(svg.contains("measurement") && !svg.contains("NaN"), "dots are in the legend");
    }
}

#[test]
fn estimates_have_innovations_and_predictions() {
    let folder = Folder::of("duration = 5.0");
    folder.succeeds(&["run", "scenario.toml", "--record-out", "record.csv", "--out", "estimates.csv"]);
    let column = |file: &str, name: &str| -> Vec<f64> {
        let mut reader = csv::Reader::from_path(folder.path(file)).unwrap();
        let place = reader.headers().unwrap().iter().position(|header| header == name).unwrap();
        reader.records().map(|row| row.unwrap()[place].parse().unwrap()).collect()
    };
    let measured = column("record.csv", "displacement");
    let [innovation, std, predicted, nis] =
        ["innovation_displacement", "innovation_std_displacement", "predicted_displacement", "nis"]
            .map(|name| column("estimates.csv", name));
    assert!(innovation[0].is_nan() && predicted[0].is_nan(), "the first sample is the initial belief");
    let mut inside = 0;
    for k in 1..measured.len() {
        assert!((predicted[k] + innovation[k] - measured[k]).abs() < 1e-12, "sample {k}");
        // One sensor alone is never further out than both together.
        assert!((innovation[k] / std[k]).powi(2) <= nis[k] * (1.0 + 1e-6), "sample {k}");
        inside += usize::from(innovation[k].abs() < 2.0 * std[k]);
    }
    let share = inside as f64 / (measured.len() - 1) as f64;
    assert!((0.9..1.0).contains(&share), "{share} of the innovations are within 2σ");
}
