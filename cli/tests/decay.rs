//! The free decay in a file of a phone.

use crate::{command, ended, file, folder, program};

/// A file as phyphox writes it: two seconds of rest, and a free decay of 7 rad/s with 2 % damping.
fn phyphox() -> String {
    let mut text =
        "\"Time (s)\",\"Acceleration x (m/s^2)\",\"Acceleration y (m/s^2)\",\"Acceleration z (m/s^2)\"\n".to_owned();
    let noise = |n: f64| ((n * 12.9898).sin() * 43_758.545_3).fract();
    for k in 0..3000 {
        let t = f64::from(k) / 100.0;
        let a = if t < 2.0 { 0.0 } else { 1.8 * (-0.14 * (t - 2.0)).exp() * (7.0 * (t - 2.0)).cos() };
        let [x, y, z] = [1.0, 2.0, 3.0].map(|n| 0.03 * noise(n + f64::from(k)));
        text.push_str(&format!("{t:E},{:E},{:E},{:E}\n", 0.1 + 0.28 * a + x, 9.7 + 0.96 * a + y, z));
    }
    text
}

#[test]
fn the_free_decay_of_a_phone_is_imported() {
    let folder = folder();
    let phone = file(&folder, "phone.csv", &phyphox());
    let [decay, scenario] = ["decay.csv", "decay.toml"].map(|name| folder.path().join(name));
    let (code, _, said) =
        ended(program().arg("import").arg(&phone).arg("--decay").arg(&decay).arg("--out").arg(&scenario));
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("a free decay: ") && said.contains("along (0.28, 0.96, 0.0"), "{said}");
    let (_, table, _) = ended(command().arg(&scenario));
    let line = table.lines().find(|line| line.contains("natural frequency")).unwrap();
    let frequency: f64 = line.split_whitespace().nth(3).unwrap().parse().unwrap();
    assert!((frequency / 7.0 - 1.0).abs() < 0.002, "{line}");
    // An output is no input, and other files are refused in words.
    let (code, _, said) = ended(program().arg("import").arg(&phone).arg("--decay").arg(&phone));
    assert_eq!(code, Some(2), "{said}");
    let other = file(&folder, "other.csv", "t,force,displacement\n0,0,0\n0.01,1,2\n0.02,1,3\n");
    let (code, _, said) = ended(program().arg("import").arg(&other).arg("--decay").arg(folder.path().join("d.csv")));
    assert!(code == Some(2) && said.contains("there are no three accelerations with a time"), "{said}");
}
