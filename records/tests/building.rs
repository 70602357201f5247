//! Records of tables: units, gaps, parts, rates, bands, and times.

use kalmanscope_filters::{Channel, Hold, Quantity};
use kalmanscope_records::import::{ImportError, Imported, MappedColumn, Mapping, Offset, Time};

use crate::import;

const TEXT: &str = "t,force,displacement\n0,1,2\n0.1,2,3\n0.2,,4\n0.3,4,\n0.4,5,6\n";

#[test]
fn units_gain_offset_and_delay_are_applied() {
    let imported = import("t in ms;force;x (mm)\n0;1;5\n10;2;7\n20;3;9\n", |mapping| {
        let input = mapping.input.as_mut().unwrap();
        (input.gain, input.offset) = (-2.0, Offset::MEAN);
        mapping.sensors.get_mut(&Quantity::DISPLACEMENT).unwrap().delay = 1;
    });
    let record = imported.unwrap().record;
    assert_eq!((record.dt(), record.hold()), (0.01, Hold::First));
    assert_eq!(record.input(), [2.0, 0.0, -2.0]);
    assert!((record.measured(0)[0] - 0.007).abs() < 1e-15 && (record.measured(0)[1] - 0.009).abs() < 1e-15);
    assert!(record.measured(0)[2].is_nan());
}

#[test]
fn an_input_without_a_number_at_irregular_times_is_said_and_zero() {
    let text = "t,force,x\n0,,1\n0.1,,2\n0.25,,3\n0.31,,4\n0.5,,5\n";
    let Imported { record, remarks, .. } = import(text, |mapping| {
        mapping.input = Some(MappedColumn::new("force"));
        mapping.sensors = [(Quantity::DISPLACEMENT, MappedColumn::new("x"))].into();
    })
    .unwrap();
    assert!(record.clocks().is_some() && record.input().iter().all(|input| *input == 0.0));
    assert!(remarks.iter().any(|remark| remark.contains("missing in all rows")), "{remarks:?}");
}

#[test]
fn what_cannot_be_used_is_said_with_line_and_column() {
    type Case = (&'static str, fn(&mut Mapping), &'static str);
    let cases: [Case; 9] = [
        ("t,force,x\n0,1,2\n1,2,oops\n2,3,4\n", |_| {}, "line 3, column `x`: `oops` is not a number"),
        ("t,force,x\n0,1,2\n1,2,1e999\n2,3,4\n", |_| {}, "line 3, column `x`: the number is infinite"),
        ("t,x\n0,1\n", |_| {}, "1 row(s)"),
        ("force,x\n2,1\n1,3\n", |_| {}, "the file has no column of times: state the sample rate"),
        ("time,f,x\nT+1,1,2\nT+2,3,1\n", |_| {}, "the file has no column of times: `time` has `T+1` in line 2"),
        ("t,force,x\n0,1,2\n0.1,2,3\n,2,3\n0.5,2,4\n", |_| {}, "line 4, column `t`: a time is missing: state the"),
        (TEXT, |m| m.input = Some(MappedColumn::new("load")), "there is no column `load`; the columns are t, "),
        (TEXT, |m| m.sensors.clear(), "no column is chosen for a sensor"),
        (TEXT, |m| m.from = Some(9.0), "0 row(s)"),
    ];
    for (text, change, said) in cases {
        let found = import(text, change).unwrap_err().to_string();
        assert!(found.starts_with(said), "{found}");
    }
}

#[test]
fn times_without_a_unit_are_asked_about_where_they_are_slow() {
    let remarks = import("t,force,x\n0,1,2\n5,2,3\n10,1,4\n", |_| {}).unwrap().remarks;
    assert_eq!(remarks.len(), 1);
    assert!(remarks[0].contains("0.2 samples a second: are they ms?"), "{remarks:?}");
    for (first, step, unit, dt) in [
        (0.0, 10.0, "ms, 100 samples a second", 0.01),
        (3e8, 500.0, "µs, 2000 samples a second (in ms 2 a second)", 5e-4),
        (112_500_000.0, 20_000.0, "µs", 0.02),
        (1.7145648e18, 2e7, "ns since 1970", 0.02),
        (1.7145648e12, 5.0, "ms since 1970", 0.005),
        (45_413.5, 0.02 / 86_400.0, "days of a spreadsheet", 0.02),
        (739_000.25, 0.05 / 86_400.0, "days of MATLAB", 0.05),
        (2_460_431.75, 0.05 / 86_400.0, "Julian days", 0.05),
        (1.3359024e17, 1e5, "as Windows counts them", 0.01),
        (0.25, 0.02 / 86_400.0, "days of a spreadsheet", 0.02),
        (0.0, 2e-7, "5000000 samples a second: are they days?", 2e-7),
    ] {
        let rows = (0..50).map(|k| format!("{},{k},{}\n", first + step * f64::from(k), k % 7));
        let Imported { record, remarks, .. } =
            import(&("time,force,x\n".to_owned() + &rows.collect::<String>()), |_| {}).unwrap();
        assert!((record.dt() / dt - 1.0).abs() < 1e-3, "{} for {dt}: {remarks:?}", record.dt());
        assert!(remarks.iter().any(|remark| remark.contains(unit)), "{unit}: {remarks:?}");
    }
    let text = "t,force,x\n0,1,2\n10,2,3\n20,1,4\n";
    let said = import(text, |mapping| mapping.time.unit = "s".to_owned()).unwrap();
    assert_eq!((said.remarks.len(), said.record.dt()), (0, 10.0));
    assert_eq!(import(text, |mapping| mapping.time.unit = "ms".to_owned()).unwrap().record.dt(), 0.01);
    let unknown = import(text, |mapping| mapping.time.unit = "ticks".to_owned()).unwrap().remarks;
    assert!(unknown[0].contains("`ticks` is not a known unit of time"), "{unknown:?}");
}

#[test]
fn a_counter_says_which_rows_are_missing_and_a_part_is_chosen_before_the_check() {
    let at_rate = |mapping: &mut Mapping| {
        (mapping.time.column, mapping.time.rate) = (None, Some(50.0));
        mapping.input = Some(MappedColumn::new("force"));
        mapping.sensors = [(Quantity::DISPLACEMENT, MappedColumn::new("x"))].into();
    };
    for count in [|k: u32| k, |k| 10 * k + 5, |k| (k + 230) % 256] {
        let rows = (0..40).filter(|k| k % 10 != 3).map(|k| format!("{},{},{}\n", count(k), k % 3, k % 7));
        let text = format!("count,force,x\n{}", rows.collect::<String>());
        let Imported { record, remarks, .. } = import(&text, at_rate).unwrap();
        assert_eq!((record.len(), record.dt()), (40, 0.02));
        assert!(record.measured(0)[3].is_nan() && record.measured(0)[4] == 4.0, "{remarks:?}");
        assert!(remarks.iter().any(|remark| remark.starts_with("`count` counts the samples")), "{remarks:?}");
    }
    let times = (0..60).map(|k| if k < 30 { f64::from(k) } else { f64::from((k * 7) % 30) });
    let rows = times.map(|time| format!("{},1,{}\n", 0.1 * time, time)).collect::<String>();
    let part = |mapping: &mut Mapping| mapping.to = Some(2.0);
    let text = format!("time,force,x\n{rows}");
    assert!(import(&text, |_| {}).is_err());
    assert_eq!(import(&text, part).unwrap().record.len(), 21);
}

#[test]
fn blank_times_at_the_end_are_the_end_and_midnight_is_passed() {
    let imported = import("t,force,x\n0,1,2\n0.1,2,3\n0.2,2,4\n,3,5\n,4,\n", |_| {}).unwrap();
    assert_eq!((imported.record.len(), imported.record.input()), (3, &[1.0, 2.0, 2.0][..]));
    assert_eq!(imported.remarks, ["the times end in line 4: 2 row(s) below it are left out"]);
    let night = "when,force,x\n23:59:59.5,1,2\n23:59:59.75,2,3\n00:00:00,3,4\n00:00:00.25,4,5\n";
    let Imported { record, remarks, .. } = import(night, |_| {}).unwrap();
    assert_eq!((record.len(), record.dt()), (4, 0.25));
    assert_eq!(remarks, ["the times pass midnight in line 4"]);
}

#[test]
fn the_truth_of_a_simulated_record_comes_along() {
    let text = "t,force,displacement,true_velocity\n0,1,2,5\n1,2,3,6\n2,1,2,7\n";
    let record = import(text, |_| {}).unwrap().record;
    assert_eq!(record.truth(Channel::VELOCITY), Some(&[5.0, 6.0, 7.0][..]));
}

#[test]
fn a_part_is_cut_and_keeps_its_times() {
    let record = import(TEXT, |mapping| (mapping.from, mapping.to) = (Some(0.1), Some(0.3))).unwrap().record;
    assert_eq!((record.len(), record.time(0)), (3, 0.1));
    assert_eq!(record.input(), [2.0, 3.0, 4.0]);
}

#[test]
fn interpolation_leaves_measurements_where_they_were() {
    let record = import(TEXT, |mapping| mapping.interpolate = 2).unwrap().record;
    assert_eq!((record.len(), record.dt()), (9, 0.05));
    assert!(record.measured(0)[1].is_nan());
    assert_eq!(record.measured(0)[2], 3.0);
    assert_eq!((record.input()[0], record.input()[2]), (1.0, 2.0));
}

#[test]
fn decimation_keeps_missing_samples_missing() {
    let mut text = "t,force,displacement\n".to_owned();
    for k in 0..100 {
        let x = if (40..44).contains(&k) { String::new() } else { "1".to_owned() };
        text.push_str(&format!("{},0.5,{x}\n", f64::from(k) * 0.01));
    }
    let record = import(&text, |mapping| mapping.every = 4).unwrap().record;
    assert_eq!((record.len(), record.dt()), (25, 0.04));
    assert!(record.measured(0)[10].is_nan() && !record.measured(0)[11].is_nan());
    assert!((record.measured(0)[20] - 1.0).abs() < 1e-9 && (record.input()[12] - 0.5).abs() < 1e-9);
}

#[test]
fn bands_above_the_nyquist_frequency_are_told() {
    let band = |low, high| import(TEXT, |mapping| mapping.band = Some([low, high]));
    let remarks = band(1.0, 90.0).unwrap().remarks;
    assert!(remarks[0].contains("90 Hz, is not below the Nyquist frequency, 5 Hz"), "{remarks:?}");
    assert!(band(6.0, 90.0).unwrap_err().to_string().contains("below the Nyquist frequency, 5 Hz"));
}

#[test]
fn gaps_in_the_input_are_filled_and_those_in_a_sensor_stay_and_are_shifted() {
    let text = "t,force,x\n0,,1\n1,1,2\n2,,3\n3,,\n4,4,5\n5,,6\n";
    let Imported { record, remarks, .. } = import(text, |mapping| mapping.time.unit = "s".to_owned()).unwrap();
    assert_eq!(record.input(), [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
    assert_eq!(format!("{:?}", record.measured(0)), "[1.0, 2.0, 3.0, NaN, 5.0, 6.0]");
    assert_eq!(remarks, ["the input is missing in 4 sample(s), the first at 0 s; it is interpolated there"]);
    for (delay, expected) in
        [(1, "[2.0, 3.0, NaN]"), (-2, "[NaN, NaN, 1.0]"), (0, "[1.0, 2.0, 3.0]"), (7, "[NaN, NaN, NaN]")]
    {
        let delayed = import("t,force,displacement\n0,1,1\n0.1,1,2\n0.2,1,3\n", |mapping| {
            mapping.sensors.get_mut(&Quantity::DISPLACEMENT).unwrap().delay = delay;
        });
        assert_eq!(format!("{:?}", delayed.unwrap().record.measured(0)), expected);
    }
}

#[test]
fn one_clock_that_stands_twice_changes_nothing() {
    let once = "t,force,displacement\n0,1,2\n0.1,2,3\n0.2,1,4\n0.3,0,5\n0.4,1,3\n";
    let twice = "t,force,time,displacement\n0,1,0,2\n0.1,2,0.1,3\n0.2,1,0.2,4\n0.3,0,0.3,5\n0.4,1,0.4,3\n";
    let in_ms = "t [s],force,time [ms],displacement\n0,1,0,2\n0.1,2,100,3\n0.2,1,200,4\n0.3,0,300,5\n0.4,1,400,3\n";
    let of = |text: &str| {
        let Imported { record, remarks, .. } = import(text, |_| {}).unwrap();
        assert_eq!(remarks, Vec::<String>::new());
        (record.dt(), record.input().to_vec(), record.measured(0).to_vec())
    };
    assert_eq!(of(once), of(twice));
    assert_eq!(of(once), of(in_ms));
}

#[test]
fn clocks_without_a_common_time_are_read_row_by_row_which_is_said() {
    let text =
        "t,force,stamp,displacement\n0,1,1000,2\n0.1,2,1000.11,3\n0.2,1,1000.2,4\n0.3,0,1000.3,5\n0.4,1,1000.4,3\n";
    let Imported { record, remarks, .. } = import(text, |_| {}).unwrap();
    assert_eq!((record.dt(), record.measured(0)), (0.1, &[2.0, 3.0, 4.0, 5.0, 3.0][..]));
    assert!(remarks[0].contains("the clocks `t` and `stamp` have no time in common"), "{remarks:?}");
}

fn timed(times: &[f64], change: impl Fn(&mut Mapping)) -> Result<Imported, ImportError> {
    let rows = times.iter().map(|time| format!("{time},1,{}\n", 3.0 * time)).collect::<String>().replace("NaN", "");
    import(&format!("t,force,displacement\n{rows}"), change)
}

#[test]
fn even_times_are_taken_as_they_are() {
    let times: Vec<f64> = (0..100).map(|k| 0.5 + f64::from(k) * 0.01).collect();
    let Imported { record, remarks, .. } = timed(&times, |_| {}).unwrap();
    assert_eq!((record.time(0), record.dt(), record.len()), (0.5, 0.01, 100));
    assert!(record.clocks().is_none() && remarks.is_empty(), "{remarks:?}");
}

#[test]
fn rounded_times_are_even_within_half_a_step() {
    let times: Vec<f64> = (0..1000).map(|k| (f64::from(k) * 1.6384).round() * 1e-3).collect();
    let Imported { record, remarks, .. } = timed(&times, |_| {}).unwrap();
    assert!((record.dt() / 1.6384e-3 - 1.0).abs() < 1e-3, "{}", record.dt());
    assert!(record.clocks().is_none() && record.len() == 1000 && remarks[0].contains("rounded"), "{remarks:?}");
}

#[test]
fn jitter_that_is_finer_than_rounding_is_one() {
    let times: Vec<f64> = (0..500).map(|k| f64::from(k) * 0.01 + 2e-3 * f64::from(k * 7 % 5 - 2) / 2.0).collect();
    let times: Vec<f64> = times.iter().map(|time| (time * 1e6).round() * 1e-6).collect();
    let Imported { record, remarks, .. } = timed(&times, |_| {}).unwrap();
    assert!(record.clocks().is_some() && remarks[0].contains(" % of a step of 0.01"), "{remarks:?}");
}

#[test]
fn gaps_are_missing_samples_and_the_right_line_is_named() {
    let Imported { record, remarks, .. } = timed(&[0.0, 0.1, 0.2, 0.3, 0.6, 0.7, 0.8, 0.9, 1.0, 1.1], |_| {}).unwrap();
    assert!(record.len() == 12 && (record.dt() - 0.1).abs() < 1e-12);
    let values = record.measured(0);
    assert!(values[4].is_nan() && values[5].is_nan() && (values[6] - 1.8).abs() < 1e-12);
    assert_eq!(remarks[0], "2 samples are missing; the longest gap has 2 and ends in line 6");
}

#[test]
fn irregular_times_are_resampled() {
    let times = [0.0, 0.13, 0.2, 0.36, 0.38, 0.55, 0.61, 0.68, 0.81, 0.95, 1.02, 1.38, 1.44, 1.6, 1.69];
    let Imported { record, remarks, .. } = timed(&times, |mapping| mapping.time.even = true).unwrap();
    assert!(remarks[0].contains("irregular"), "{remarks:?}");
    let known = record.measured(0).iter().enumerate().filter(|(_, value)| !value.is_nan());
    for (k, value) in known.clone() {
        assert!((value - 3.0 * k as f64 * record.dt()).abs() < 1e-12, "{k}");
    }
    assert!(known.count() + 6 > record.len());
}

#[test]
fn times_that_do_not_rise_are_refused_with_their_line() {
    let at_seconds = Time { column: Some("t".to_owned()), unit: "s".to_owned(), ..Time::default() };
    for (times, said) in [
        (
            &[0.0, 0.1, 0.1][..],
            "line 4: the time in `t` stands still from 0.1 s to 0.1 s: about 2 rows have the same time, as rounded ones: state the sample \
             rate, and the rows count as even",
        ),
        (
            &[0.0, 0.1, 0.05],
            "line 4: the time in `t` goes back from 0.1 s to 0.05 s: choose a part by its times, or state the sample rate to count the \
             rows as even",
        ),
        (&[0.0, f64::NAN, 1.0], "line 3, column `t`"),
        (&[0.0], "1 row"),
        (&[0.0, 1e-9, 2e-9, 1e9], "the record would have 1000000000000000 samples, but at most 2000000"),
    ] {
        let found = timed(times, |mapping| mapping.time = at_seconds.clone()).unwrap_err().to_string();
        assert!(found.starts_with(said), "{found}");
    }
}
