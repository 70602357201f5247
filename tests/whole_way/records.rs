//! Measured records to try: files of a simulated record, with gaps, odd rates and odd cells.

use std::fmt::Write as _;

use kalmanscope_core::import::{Mapping, Table, build, hash, read};
use kalmanscope_core::{Hold, InputKind, Record, Scenario};

use crate::dice::{Dice, spoil};

/// Limits the samples that are measured, so that a case does not take long.
const MOST: usize = 600;

const CELLS: [&str; 10] = ["", "nan", "NaN", "0", "-0", "1e300", "-1e300", "1.7e308", "5e-324", "-9999"];

pub(crate) fn file(record: &Record, dice: &mut Dice) -> Vec<u8> {
    let has_times = !dice.one_in(4);
    let scale = dice.pick(&[1.0, 1.0, 1.0, 1e-6, 1e6, 1e-300, 1e300]);
    let (rare, jitter) = (dice.pick(&[0, 200, 30, 3, 1]), if dice.one_in(4) { dice.pick(&[0.3, 0.9]) } else { 0.0 });
    // The sensors may have a clock of their own.
    let own = (has_times && dice.one_in(4)).then(|| (dice.pick(&[0.5, 1.0, 1.37, 9.0]), dice.pick(&[0.0, 0.3, -7.0])));
    let rows = if dice.one_in(6) { record.len().min(dice.below(5)) } else { record.len().min(MOST) };
    let input = match record.input_kind() {
        InputKind::Force => "force",
        InputKind::GroundAcceleration => "ground_acceleration",
    };
    let mut text = String::from(if has_times { "t," } else { "" });
    text += input;
    text += if own.is_some() { ",t2" } else { "" };
    record.sensors().iter().for_each(|sensor| text += &format!(",{}", sensor.key()));
    for k in 0..rows {
        text.push('\n');
        if has_times {
            let odd = jitter * (dice.below(1000) as f64 / 1000.0 - 0.5);
            let _ = write!(text, "{:e},", (k as f64 + odd) * record.dt() * scale);
        }
        let _ = write!(text, "{:e}", record.input()[k]);
        if let Some((step, from)) = own {
            let odd = jitter * (dice.below(1000) as f64 / 1000.0 - 0.5);
            let _ = write!(text, ",{:e}", ((k as f64 + odd) * step + from) * record.dt() * scale);
        }
        for sensor in 0..record.sensors().len() {
            if rare > 0 && dice.one_in(rare) {
                text += &format!(",{}", dice.pick(&CELLS));
            } else {
                let _ = write!(text, ",{:e}", record.measured(sensor)[k]);
            }
        }
    }
    text.push('\n');
    text.into_bytes()
}

pub(crate) struct Read {
    pub(crate) table: Table,
    pub(crate) mapping: Mapping,
    pub(crate) input: InputKind,
}

/// Reads a file.
///
/// # Errors
/// The sentence of the importer.
pub(crate) fn read_file(bytes: &[u8], dice: &mut Dice) -> Result<Read, String> {
    let table = read(bytes, None).map_err(|error| error.to_string())?;
    let (mut mapping, input) = Mapping::guess(&table);
    (mapping.file, mapping.hash) = ("case.csv".to_owned(), hash(bytes));
    if mapping.time.column.is_none() {
        mapping.time.rate = Some(dice.pick(&[100.0, 1.0, 1e-3, 44_100.0, 1e9]));
    }
    if dice.one_in(4) {
        mapping.every = 1 + dice.below(4);
        mapping.interpolate = 1 + dice.below(3);
    }
    if dice.one_in(4) {
        let nyquist = mapping.time.rate.unwrap_or(100.0) / 2.0;
        mapping.band = Some([dice.pick(&[0.0, 0.01, 0.2]) * nyquist, dice.pick(&[0.3, 0.9, 1.0]) * nyquist]);
    }
    if dice.one_in(6) {
        let mut document = toml::Value::try_from(&mapping).map_err(|error| error.to_string())?;
        spoil(&mut document, dice);
        if let Ok(spoilt) = document.try_into::<Mapping>() {
            mapping = spoilt;
        }
    }
    mapping.validate().map_err(|error| error.to_string())?;
    Ok(Read { table, mapping, input })
}

impl Read {
    /// The record. One that is too long for a case is cut.
    ///
    /// # Errors
    /// The sentence of the importer.
    pub(crate) fn record(&self, hold: Hold) -> Result<Record, String> {
        let built = build(&self.table, &self.mapping, self.input, hold, &[]);
        let record = built.map_err(|error| error.to_string())?.record;
        Ok(if record.len() > MOST { record.part(0..MOST) } else { record })
    }

    /// A scenario, changed so that it runs on this record.
    pub(crate) fn fit(&self, mut scenario: Scenario) -> Scenario {
        for quantity in scenario.sensors.iter().map(|sensor| sensor.measures).collect::<Vec<_>>() {
            if !self.mapping.sensors.contains_key(&quantity) {
                scenario.remove_sensor(quantity);
            }
        }
        (scenario.input, scenario.record) = (self.input, Some(self.mapping.clone()));
        scenario
    }
}
