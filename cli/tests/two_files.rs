//! Two files with their own clocks are imported as one record.

use kalmanscope_core::{Channel, Force, Hold, Quantity, Scenario, Sensor, simulate};

use crate::{command, ended, file, folder, program};

/// The files of two loggers: the force in steps of 4 ms, and the displacement in steps of 15 ms, whose clock is 2.5 s behind.
fn loggers() -> [String; 2] {
    let force = Force::Chirp { amplitude: 3.0, from: 1.0, to: 20.0, sweep: 50.0 };
    let mut scenario = Scenario { dt: 0.001, duration: 50.0, hold: Hold::First, force, ..Scenario::default() };
    scenario.plant.set(Channel::NATURAL_FREQUENCY, 8.0);
    scenario.plant.set(Channel::DAMPING_RATIO, 0.04);
    scenario.sensors.clear();
    scenario.add_sensor(Sensor::new(Quantity::DISPLACEMENT, 0.001));
    let record = simulate(&scenario);
    let input = record.input().iter().enumerate().step_by(4);
    let input = input.map(|(k, value)| format!("{:.3},{value}\n", k as f64 * 0.001));
    let readings = record.measured(0).iter().enumerate().skip(3000).step_by(15);
    let readings = readings.map(|(k, value)| format!("{};{}\n", k as f64 - 2500.0, 1000.0 * value));
    [
        "t [s],force over mass [m/s²]\n".to_owned() + &input.collect::<String>(),
        "time [ms];displacement [mm]\n".to_owned() + &readings.collect::<String>(),
    ]
}

#[test]
fn two_loggers_are_one_record() {
    let folder = folder();
    let [force, sensor] = loggers();
    let force = file(&folder, "force.csv", &force);
    let sensor = file(&folder, "sensor.csv", &sensor);
    let [both, scenario] = ["both.csv", "both.toml"].map(|name| folder.path().join(name));
    for given in [None, Some("2.5")] {
        let mut import = program();
        import
            .arg("import")
            .arg(&force)
            .arg("--with")
            .arg(&sensor)
            .arg("--joined")
            .arg(&both)
            .arg("--out")
            .arg(&scenario);
        if let Some(offset) = given {
            import.arg("--offset").arg(offset);
        }
        let (code, _, said) = ended(&mut import);
        assert_eq!(code, Some(0), "{said}");
        assert!(said.contains("s in common; each keeps its times"), "{said}");
        if given.is_none() {
            let offset = said
                .lines()
                .find_map(|line| line.split(" s are added").next()?.split_whitespace().last()?.parse().ok());
            let offset: f64 = offset.expect("it is said");
            assert!((offset - 2.5).abs() < 0.015, "{said}");
        }
        let (_, table, _) = ended(command().arg(&scenario));
        let line = table.lines().find(|line| line.contains("natural frequency")).expect("it is estimated");
        let frequency: f64 = line.split_whitespace().nth(3).and_then(|number| number.parse().ok()).expect("a number");
        assert!((frequency / 8.0 - 1.0).abs() < 0.003, "{line}");
    }
}

#[test]
fn numbers_that_are_no_readings_are_not_moved_into_others() {
    let folder = folder();
    let [force, sensor] = loggers();
    let sensor: String = sensor
        .lines()
        .enumerate()
        .map(|(k, line)| match line.split_once(';') {
            Some((time, _)) if k > 0 && k % 40 == 0 => format!("{time};-9999\n"),
            _ => format!("{line}\n"),
        })
        .collect();
    let (force, sensor) = (file(&folder, "force.csv", &force), file(&folder, "sensor.csv", &sensor));
    let both = folder.path().join("both.csv");
    let mut import = program();
    import.arg("import").arg(&force).arg("--with").arg(&sensor).arg("--joined").arg(&both).args(["--offset", "2.5"]);
    let (code, _, said) = ended(&mut import);
    assert!(code == Some(0) && said.contains("-9999 in 78 cells of `displacement` is taken for missing"), "{said}");
    let text = std::fs::read_to_string(&both).expect("it is written");
    let readings = text.lines().skip(1).filter_map(|line| line.rsplit(',').next()?.parse::<f64>().ok());
    let largest = readings.map(f64::abs).fold(0.0, f64::max);
    assert!(largest > 10.0 && largest < 500.0, "{largest}");
}

#[test]
fn files_that_cannot_be_joined_say_why() {
    let folder = folder();
    let [force, sensor] = loggers();
    let force = file(&folder, "force.csv", &force);
    let sensor = file(&folder, "sensor.csv", &sensor);
    let both = folder.path().join("both.csv");
    let (code, _, said) = ended(program().arg("import").arg(&force).arg("--with").arg(&sensor));
    assert!(code == Some(2) && said.contains("--joined"), "{said}");
    let mut import = program();
    let (code, _, said) =
        ended(import.arg("import").arg(&force).arg("--with").arg(&sensor).arg("--joined").arg(&sensor));
    assert_eq!(code, Some(2), "an input is not overwritten: {said}");
    let mut import = program();
    import.arg("import").arg(&force).arg("--with").arg(&sensor).arg("--joined").arg(&both).args(["--offset", "500"]);
    let (code, _, said) = ended(&mut import);
    assert!(code == Some(2) && said.contains("fewer than 2 samples in common"), "{said}");
    let hiss: String = (0..3000).map(|k| format!("{},{}\n", f64::from(k) * 0.015, f64::from(k * k % 977))).collect();
    let other = file(&folder, "other.csv", &format!("t [s],displacement [mm]\n{hiss}"));
    let (code, _, said) =
        ended(program().arg("import").arg(&force).arg("--with").arg(&other).arg("--joined").arg(&both));
    assert!(code == Some(2) && said.contains("state the offset"), "{said}");
}

#[test]
fn columns_with_times_of_their_own_are_one_record() {
    let folder = folder();
    let [force, sensor] = loggers();
    let mut sensors = sensor.lines().skip(1).map(|line| {
        let (time, reading) = line.split_once(';').expect("two cells");
        format!("{},{reading}", time.parse::<f64>().expect("a number") + 2500.0)
    });
    let rows = force.lines().skip(1).map(|line| format!("{line},{}\n", sensors.next().unwrap_or(",".to_owned())));
    let head = "t [s],force over mass [m/s²],t2 [ms],displacement [mm]\n";
    let both = file(&folder, "both.csv", &(head.to_owned() + &rows.collect::<String>()));
    let scenario = folder.path().join("both.toml");
    let (code, _, said) = ended(program().arg("import").arg(&both).arg("--out").arg(&scenario));
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("column `t2`: a clock of its own"), "{said}");
    assert!(said.contains("the filters take each reading at its own time"), "{said}");
    let at_even = folder.path().join("even.toml");
    let (code, _, said) = ended(program().arg("import").arg(&both).arg("--even").arg("--out").arg(&at_even));
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("s in common, at the steps of the clock `t`"), "{said}");
    assert!(std::fs::read_to_string(&at_even).expect("it is written").contains("even = true"));
    let (_, table, _) = ended(command().arg(&scenario));
    let line = table.lines().find(|line| line.contains("natural frequency")).expect("it is estimated");
    let frequency: f64 = line.split_whitespace().nth(3).and_then(|number| number.parse().ok()).expect("a number");
    assert!((frequency / 8.0 - 1.0).abs() < 0.003, "{line}");
    assert!(!table.contains("delivers nothing"), "it measures seldom: {table}");
    // A filter that jumps cannot follow the times, and its remark says this.
    let text = std::fs::read_to_string(&scenario).expect("it is written");
    std::fs::write(&scenario, text.replace("kind = \"ekf\"", "kind = \"ekf\"\njump = true")).expect("it is written");
    let (_, table, _) = ended(command().arg(&scenario));
    assert!(table.contains("each reading counts at the sample after it"), "{table}");
}
