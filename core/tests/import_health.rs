//! Files that are broken on purpose, by the thousand. `core/fuzz` has the same check for as long as one likes.

use std::fmt::Write as _;

use kalmanscope_core::free_decay::{Decay, Ring};
use kalmanscope_core::import::{Mapping, ThreeAxes, build, join, read};
use kalmanscope_core::record::LiveRecord;
use kalmanscope_core::suggest::{begin, scenario_for};
use kalmanscope_core::{Hold, InputKind, Quantity, Task};

use crate::import::check_import;
use crate::numbers::Random;

const FILES: [&str; 16] = [
    "t,force,displacement\n0,1,2\n0.1,2,3\n0.2,,4\n0.3,4,\n0.4,5,6\n0.6,1,1\n0.7,2,2\n",
    "\"V1\",\"V2\",\n0.1,0.2,\n0.3,0.4,\n0.2,0.1,\n0.5,0.7,\n0.1,0.1,\n",
    "Zeit;Kraft;Weg\ns;N;mm\n0,00;1,5;2\n0,01;1;2,5\n0,02;2;3\n0,03;1;0\n",
    "  0.0  1.5  2\n 0.1  2.5  3\n 0.2  1 1\n 0.3 0 0\n",
    "# made by hand\n# t x\n0 1\n1 2\n2 3\n3 2\n",
    "when,acc (g)\n2024-05-01 12:00:00.00,1\n2024-05-01 12:00:00.01,2\n2024-05-01 12:00:00.02,1\n",
    "Logger\nStart: 12.05.2024; rate 100\n\nZeit;Weg;Status\n0,00;1,2;ok\n0,01;1,3;ok\n0,02;1,1;bad\n",
    "ACCELERATION TIME SERIES IN UNITS OF G\nNPTS=  7, DT=   .0100 SEC,\n  .12E-02  -.23E-02\n .3E-02 .4D-02 -.5E-02\n 1 2\n",
    "Chan  1: 180 Deg\n 6 points of accel data equally spaced at 0.010 sec, in cm/sec2. (3f7.2)\n1234.561234.56   1.00\n  -1.00-234.56   1.00\n\
     /&  End of data\n 3 points of veloc data equally spaced at 0.010 sec, in cm/sec. (3f7.2)\n   1.00   2.00   3.00\n",
    "TIMESERIES A, 4 samples, 50 sps, 2024-05-01T00:00:01.0, SLIST, FLOAT, M\n1 2\n3 4\nTIMESERIES B, 2 samples, 50 sps, \
     2024-05-01T00:00:01.04, SLIST, FLOAT, M/S\n5 6\n",
    "    -1\n    58\nBeam\nNONE\nNONE\nNONE\nNONE\n    1         0    0         0 NONE               7   3 NONE               1   3\n\
     \x20        2         4         1  0.00000e+00  5.00000e-03  0.00000e+00\n        17    0    0    0 Time                 s\n\
     \x20        8    0    0    0 Response             m\n         0\n         0\n  1.00000e+00  2.00000e+00  3.00000e+00  1.00000e+00\n    -1\n",
    "LabVIEW Measurement\nSeparator\tTab\nX_Columns\tNo\n***End_of_Header***\n\nChannels\t2\nX0\t0\t0\nDelta_X\t0.1\t0.1\n\
     ***End_of_Header***\nX_Value\tA\tB\tComment\n\t1\t2\n\t2\t3\n\t1\t1\n",
    "X,CH1,CH2,Start,Increment,\nSequence,Volt,Volt,-1.0e-01,1.0e-02\n0,1,2,,\n1,2,1,,\n2,1,2,,\n",
    "Record Length,4,,0.0,1.0,\nSample Interval,0.1,,0.1,2.0,\nSource,CH1,,0.2,1.0,\n,,,0.3,2.5,\n",
    "time,force,stamp,x\n1714564800023500000,0,1714564800000000000,0\n1714564800033500000,1,1714564800010000000,2\n\
     1714564800043500000,2,1714564800020000000,3\n1714564800053500000,1,1714564800030000000,2\n",
    "\u{FEFF}t\tx\n0\t1e300\n1\t-1e300\n2\tnan\n3\tinf\n4\t1\n",
];

const PIECES: &str = ",|;|\t| |\n|\r\n|\"|#|nan|inf|-1e308|1e999|0|0,5|é|\0|::|\
                      2024-01-01|\u{FEFF}|,,,,,,,,|1.234,5|23:59:59.5 PM|-1.#IND|-9999|999999999999|1e19|1e-9|    -1\n    58\n";

fn broken(random: &mut Random) -> Vec<u8> {
    let mut below = |limit: usize| (random.uniform() * limit as f64) as usize;
    let pieces: Vec<&str> = PIECES.split('|').collect();
    let file = FILES[below(FILES.len())];
    let mut bytes: Vec<u8> = match below(6) {
        0 => file.encode_utf16().flat_map(u16::to_le_bytes).collect(),
        1 => file.encode_utf16().flat_map(u16::to_be_bytes).collect(),
        _ => file.as_bytes().to_vec(),
    };
    for _ in 0..1 + below(6) {
        let place = below(bytes.len());
        match below(5) {
            0 => {
                let piece = pieces[below(pieces.len())].as_bytes();
                bytes.splice(place..place, piece.iter().copied());
            }
            1 if !bytes.is_empty() => bytes[place] = below(256) as u8,
            2 => bytes.truncate(place),
            3 => {
                let end = (place + below(40)).min(bytes.len());
                bytes.drain(place..end);
            }
            _ => {
                let end = (place + below(80)).min(bytes.len());
                let again = bytes[place..end].to_vec();
                bytes.splice(place..place, again);
            }
        }
    }
    bytes.insert(0, below(64) as u8);
    bytes
}

#[test]
fn broken_files_become_sound_records_or_sentences() {
    let mut random = Random::new(0x5EED);
    for case in 0..300_000 {
        let bytes = broken(&mut random);
        if let Err(what) = check_import(&bytes) {
            panic!("case {case}: {what}\n{:?}", String::from_utf8_lossy(&bytes[1..]));
        }
    }
}

#[test]
fn whole_files_are_records() {
    for file in &FILES[..15] {
        let table = read(file.as_bytes(), None).expect("a table");
        assert!(table.rows() >= 3, "{file}");
    }
}

/// The work is bounded where a second more is the same number, or the span is many steps.
#[test]
fn times_of_any_size_come_to_an_end() {
    const MOST: usize = 100_000;
    let steps = (-9..=18).step_by(3).map(|power| 10_f64.powi(power));
    let cases = steps.flat_map(|step| [0.0, 1.0, 1.7e9, 1.7e12, 1.714_564_8e18, 1e19].map(|start| (start, step)));
    let mut records = 0;
    for (start, step) in cases {
        let time = |k: f64| start + k * step;
        let [mut one, mut two, mut axes] =
            ["t,force,displacement\n", "t1,force,t2,displacement\n", "time,ax,ay,az\n"].map(str::to_owned);
        for k in (0..150).map(f64::from) {
            let (force, x) = ((0.37 * k).sin() + (1.1 * k).cos(), (0.37 * k - 1.0).sin());
            writeln!(one, "{:e},{force},{x}", time(k)).unwrap();
            writeln!(two, "{:e},{force},{:e},{x}", time(k), time(k + 0.35)).unwrap();
            writeln!(axes, "{:e},{x},{},9.8", time(k), 0.1 * x * force).unwrap();
        }
        for text in [&one, &two, &axes] {
            for choice in [0_u8, 4] {
                let bytes = [&[choice], text.as_bytes()].concat();
                assert_eq!(check_import(&bytes), Ok(()), "{start} {step}");
            }
            let table = read(text.as_bytes(), None).unwrap();
            let (mapping, kind) = Mapping::guess(&table);
            let _ = table.sound().and_then(|(rate, values)| Ring::in_samples(rate, values));
            let _ = ThreeAxes::of(&table).map(|axes| Decay::alike(&axes.readings(&table)));
            let Ok(imported) = build(&table, &mapping, kind, Hold::First, &[]) else {
                continue;
            };
            let record = imported.record;
            assert!(record.len() < 2000, "{start} {step}: {} samples", record.len());
            records += 1;
            let mut scenario = scenario_for(&record);
            scenario.filters.truncate(1);
            scenario.record = Some(mapping);
            let mut suggest = begin(&scenario, record);
            assert!((0..MOST).any(|_| suggest.advance(&mut || false)), "{start} {step}: start values");
        }
        let mut live = LiveRecord::new(0.01, InputKind::Force, Hold::First, vec![Quantity::DISPLACEMENT]);
        for k in (0..30).map(f64::from) {
            // A file that cannot be imported is refused with a reason.
            let _ = live.take(time(k), 0.1 * k, &[k]);
        }
        live.finish();
        assert!(live.record().len() <= LiveRecord::MOST, "{start} {step}");
        let tables = [&one, &two].map(|text| read(text.as_bytes(), None).unwrap());
        let _ = join(&tables[0], &tables[1], 0.5 * step);
    }
    assert!(records > 60, "{records}");
}

/// Even, with jitter, equal, missing, backwards, with gaps.
#[test]
fn times_of_any_order_have_their_step_or_a_sentence() {
    let mut random = Random::new(1);
    let (mut records, mut said) = (0, 0);
    for round in 0..600 {
        let step = 10_f64.powf(27.0 * random.uniform() - 9.0);
        let mut time = [0.0, 1.0, -50.0 * step, 1.7e9, 4.29e9, 1.7e12, 1.7e18, 1e19][(8.0 * random.uniform()) as usize];
        let (mut text, mut times) = (["t,force,x\n", "t [s],force,x\n"][round % 2].to_owned(), Vec::new());
        for k in (0..80).map(f64::from) {
            let odd = random.uniform() < [0.0, 0.02, 0.3][round / 2 % 3];
            time += match round / 6 % 6 {
                1 => step * (0.5 + random.uniform()),
                2 if odd => 0.0,
                3 if odd => -3.0 * step,
                4 if odd => step * 1000.0 * random.uniform(),
                _ => step,
            };
            let is_missing = round / 6 % 6 == 5 && odd;
            times.push(time);
            let cell = if is_missing { "nan".to_owned() } else { format!("{time:e}") };
            writeln!(text, "{cell},{},{}", (0.7 * k).cos(), (0.37 * k).sin()).unwrap();
        }
        assert_eq!(check_import(&[&[0], text.as_bytes()].concat()), Ok(()), "{text}");
        let table = read(text.as_bytes(), None).unwrap();
        let (mapping, kind) = Mapping::guess(&table);
        let Ok(imported) = build(&table, &mapping, kind, Hold::First, &[]) else {
            continue;
        };
        let mut steps: Vec<f64> = times.windows(2).map(|pair| pair[1] - pair[0]).collect();
        steps.sort_by(f64::total_cmp);
        let is_usual = (imported.record.dt() / steps[steps.len() / 2] - 1.0).abs() < 0.02;
        assert!(is_usual || !imported.remarks.is_empty(), "{} for {step}: {text}", imported.record.dt());
        (records, said) = (records + 1, said + usize::from(!is_usual));
    }
    assert!(records > 150 && said > 20, "{records} {said}");
}
