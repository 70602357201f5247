//! Live records, delays, the meaning of columns, units, and hashes.

use std::sync::Arc;

use kalmanscope_filters::{Channel, Hold, InputKind, Quantity};
use kalmanscope_records::Length;
use kalmanscope_records::document::{from_toml, read, to_toml};
use kalmanscope_records::hash::{Hash, short_hash};
use kalmanscope_records::import::{MappedColumn, Mapping, Offset};
use kalmanscope_records::record::{Delays, LiveRecord};

fn take(live: &mut LiveRecord, k: usize) {
    let time = 0.013 * k as f64 + 0.004 * (k as f64).sin();
    let input = if k > 60 && k.is_multiple_of(7) { k as f64 } else { f64::NAN };
    live.take(time, input, &[f64::NAN, 0.1 * k as f64]).expect("it is in order");
}

#[test]
fn a_longer_record_is_that_of_before_with_what_is_new() {
    let mut live =
        LiveRecord::new(0.01, InputKind::Force, Hold::First, vec![Quantity::DISPLACEMENT, Quantity::VELOCITY]);
    let mut record = live.so_far();
    let (mut places, mut kept) = (Vec::new(), None);
    for k in 0..3000 {
        take(&mut live, k);
        let updated = live.update(&mut record);
        assert!(!updated || (record.begins_with(live.record()) && live.record().begins_with(&record)));
        assert!(kept.as_deref().is_none_or(|kept| record.begins_with(kept)));
        if updated && !places.contains(&Arc::as_ptr(&record)) {
            places.push(Arc::as_ptr(&record));
        }
        if k % 1000 == 500 {
            kept = Some(Arc::clone(&record));
        }
    }
    assert!(record.len() > 3500 && record.len() == live.record().len());
    assert!(places.len() <= 2 + 3, "two records, and one in place of each that is kept: {places:?}");
}

#[test]
fn a_long_record_goes_on_if_its_last_values_are_there() {
    let mut live =
        LiveRecord::new(0.01, InputKind::Force, Hold::Zero, vec![Quantity::DISPLACEMENT, Quantity::VELOCITY]);
    (0..4000).for_each(|k| take(&mut live, k));
    let record = live.record();
    let first = record.part(0..record.len() - 500);
    let changed = |at: usize| first.clone().with_measured(|_, k, x| if k == at { x + 1e-12 } else { x });
    assert!(record.goes_on_from(&first) && record.begins_with(&first));
    assert!(!first.goes_on_from(record));
    let late = changed(first.len() - 20);
    assert!(!record.goes_on_from(&late) && !record.begins_with(&late));
    assert!(!record.begins_with(&changed(20)), "all are compared here");
}

#[test]
fn a_filter_reads_ahead_for_what_is_late_and_back_for_what_is_early() {
    let of = |input, sensors: &[f64]| Delays::new(input, sensors.iter().copied());
    assert_eq!(of(2, &[0.0, 0.0]), Delays { input: 2, sensors: Vec::new() });
    assert_eq!((of(0, &[]).lookahead(), of(0, &[]).reach()), (0, 0));
    assert_eq!((of(-3, &[1.5, 0.0]).lookahead(), of(-3, &[1.5, 0.0]).reach()), (3, 0));
    assert_eq!((of(1, &[4.2, -2.5]).lookahead(), of(1, &[4.2, -2.5]).reach()), (5, 3));
    assert_eq!(of(0, &[2.000_000_1, 0.25]).sensors, [2.0, 0.25]);
}

#[test]
fn pieces_have_the_hash_of_the_whole() {
    let mut hash = Hash::default();
    assert_eq!(hash.text(), "cbf29ce484222325");
    hash.add(b"foo");
    hash.add(b"");
    hash.add(b"bar");
    // Test vectors of the authors.
    assert_eq!((hash.text().as_str(), short_hash(b"foobar")), ("85944171f73967e8", 0xBF9C_F968));
}

#[test]
fn circuits_swing_in_volts() {
    let mut mapping = Mapping::default();
    let column = MappedColumn { unit: "mV".to_owned(), ..MappedColumn::new("V2") };
    mapping.sensors.insert(Quantity::DISPLACEMENT, column);
    let length = Length::of(Some(&mapping));
    assert_eq!(length.in_place_of(Quantity::VELOCITY.unit()), "V/s");
    assert_eq!(length.in_place_of(Channel::CUBIC_STIFFNESS.unit()), "1/(V² s²)");
    assert_eq!(length.in_place_of(Channel::NATURAL_FREQUENCY.unit()), "rad/s");
    assert_eq!(Length::of(None).in_place_of("m"), "m");
}

#[test]
fn a_mapping_survives_toml() {
    let text = "file = \"a.csv\"\nband = [8.0, 70.0]\nevery = 2\n[time]\nrate = 610.35\n[input]\ncolumn = \"V1\"\n\
                gain = 2.0\noffset = \"mean\"\n[sensors.displacement]\ncolumn = \"V2\"\noffset = { mean = [0.0, 1.0] }\n";
    let mapping: Mapping = read(&from_toml(text).unwrap()).unwrap();
    assert_eq!(mapping.input.as_ref().unwrap().offset, Offset::MEAN);
    assert_eq!(mapping.sensors[&Quantity::DISPLACEMENT].offset, Offset::Part { mean: [0.0, 1.0] });
    assert_eq!(mapping.sensors[&Quantity::DISPLACEMENT].gain, 1.0);
    assert_eq!(read::<Mapping>(&from_toml(&to_toml(&mapping).unwrap()).unwrap()).unwrap(), mapping);
}

#[test]
fn impossible_numbers_are_named() {
    let message = |change: &dyn Fn(&mut Mapping)| {
        let mut mapping = Mapping { input: Some(MappedColumn::new("u")), ..Mapping::default() };
        change(&mut mapping);
        mapping.validate().unwrap_err().to_string()
    };
    assert_eq!(message(&|m| m.time.rate = Some(0.0)), "`record.time.rate` is 0, but must be positive and finite");
    assert_eq!(message(&|m| m.interpolate = 9), "`record.interpolate` is 9, but must be from 1 to 8");
    assert!(message(&|m| m.every = 0).contains("record.every"));
    assert!(message(&|m| m.band = Some([5.0, 5.0])).contains("rising"));
    assert!(message(&|m| m.no_input = true).contains("record.no_input"));
    assert!(message(&|m| m.input.as_mut().unwrap().missing = Some(f64::INFINITY)).contains("record.input.missing"));
    assert!(message(&|m| m.input.as_mut().unwrap().gain = f64::NAN).contains("record.input.gain"));
    assert!(message(&|m| (m.from, m.to) = (Some(2.0), Some(1.0))).contains("after `from`"));
}
