//! The words about a file: what was recognised in it, what is missing, and what is in doubt.

use kalmanscope_core::import::{Dimension, Imported, MappedColumn, Offset, ThreeAxes, unit};
use kalmanscope_core::{InputKind, Quantity};

use super::Draft;
use super::draft::ColumnRole;
use crate::session::Session;
use crate::text::{grouped, sentence, significant};

impl Draft {
    pub(super) fn meaning(&self, place: usize) -> Option<String> {
        match self.role(place) {
            ColumnRole::Input => self.mapping.input.as_ref().map(|mapped| self.input_words(mapped)),
            ColumnRole::ForceOn(mass) => {
                let taken = |one: &&MappedColumn| dimension(one) == Some(Dimension::Force) && one.gain == 1.0;
                let words =
                    |one: &MappedColumn| with_unit(&mass.name(), one, "m/s²", Some(one).filter(taken).map(|_| NO_MASS));
                self.mapping.forces.get(&mass).map(words)
            }
            ColumnRole::Sensor(quantity) => self.mapping.sensors.get(&quantity).map(|one| sensor_words(quantity, one)),
            ColumnRole::Time | ColumnRole::Unused => None,
        }
    }

    fn input_words(&self, mapped: &MappedColumn) -> String {
        let words = match (self.input, dimension(mapped)) {
            (InputKind::GroundAcceleration, _) => ("acceleration of the ground", ""),
            (InputKind::Force, Some(Dimension::Acceleration)) => ("force over mass", ""),
            (InputKind::Force, Some(Dimension::Force)) => ("force", "its mass is estimated"),
            (InputKind::Force, _) => ("force", "its gain is estimated"),
        };
        let estimated = Some(words.1).filter(|words| self.suggest && !words.is_empty());
        with_unit(words.0, mapped, "", estimated)
    }

    pub(super) fn extent(made: &Imported) -> String {
        let record = &made.record;
        let about = if record.clocks().is_some() { "about " } else { "" };
        let [span, rate] =
            [record.len().saturating_sub(1) as f64 * record.dt(), 1.0 / record.dt()].map(|x| significant(x, 4));
        format!("{} samples over {span} s at {about}{rate} Hz", grouped(record.len()))
    }

    pub(super) fn summary(&self) -> String {
        let remark = self.remark.as_deref().map(|remark| format!(" {}.", sentence(remark)));
        let made = self.outcome().and_then(Result::ok);
        let extent = made.map(|made| format!(": {}. {}", Self::extent(made), self.left_out(made).join(" ")));
        let extent = extent.as_deref().map(str::trim_end);
        format!("“{}”{}{}", self.file.name, extent.unwrap_or_default(), remark.unwrap_or_default())
    }

    pub(super) fn left_out(&self, made: &Imported) -> Vec<String> {
        let (every, most) = (self.mapping.every, grouped(Session::LONGEST_WHOLE));
        let kept = (every > 1).then(|| format!("One of {every} samples is kept: at most {most} are shown."));
        // Here most steps have no reading by construction: none of them is missing.
        if made.record.clocks().is_some() || self.mapping.interpolate > 1 {
            return kept.into_iter().collect();
        }
        let words = |(quantity, mapped): (&Quantity, &MappedColumn)| {
            let readings = made.record.measured_quantity(*quantity)?;
            let count = readings.iter().filter(|reading| reading.is_nan()).count();
            let (some, all, is) = (grouped(count), grouped(readings.len()), if count == 1 { "is" } else { "are" });
            (count > 0).then(|| format!("{some} of {all} readings of {} {is} missing: left out.", mapped.column))
        };
        kept.into_iter().chain(self.mapping.sensors.iter().filter_map(words)).collect()
    }

    pub(super) fn doubts(&self) -> Vec<String> {
        let mapped = self.mapping.columns();
        let is_unknown = |mapped: &&MappedColumn| !mapped.unit.trim().is_empty() && dimension(mapped).is_none();
        let units = mapped.filter(is_unknown);
        let units = units.map(|one| format!("“{}” is no known unit: the numbers of {} stay.", one.unit, one.column));
        let guessed = self.guesses.iter().filter(|guess| guess.is_a_guess());
        let guessed = guessed.map(|guess| format!("{}: {}.", guess.column, guess.why));
        let axes = ThreeAxes::of(&self.file.table).map(|_| "An accelerometer with three axes.".to_owned());
        units.chain(guessed).chain(axes).collect()
    }
}

const NO_MASS: &str = "taken for a force over mass: give 1 / mass as its gain";

fn dimension(mapped: &MappedColumn) -> Option<Dimension> {
    unit(&mapped.unit).map(|(dimension, _)| dimension)
}

fn sensor_words(quantity: Quantity, mapped: &MappedColumn) -> String {
    let mean = (mapped.offset != Offset::default()).then_some("its mean is removed");
    with_unit(&quantity.name(), mapped, quantity.unit(), mean.filter(|_| mapped.offset == Offset::MEAN))
}

/// A name with the unit of its column, or that of its numbers where the column has none, and what else is to be said.
fn with_unit(name: &str, mapped: &MappedColumn, usual: &str, more: Option<&str>) -> String {
    let unit = match mapped.unit.trim() {
        "" if usual.is_empty() => "without a unit".to_owned(),
        "" => format!("without a unit, taken for {usual}"),
        unit => format!("[{unit}]"),
    };
    format!("{name} {unit}{}", more.map_or(String::new(), |more| format!("; {more}")))
}
