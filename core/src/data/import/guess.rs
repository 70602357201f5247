//! The meaning of a file's columns by their headers and cells: a guess at all of them, and the three axes of an accelerometer.

use super::error::FEWEST;
use super::unit::{Dimension, STANDARD_GRAVITY, unit};
use super::{Column, MappedColumn, Mapping, Ring, Table, Time, times};
use crate::data::record::input_name;
use crate::{InputKind, Quantity};

/// Words in names of columns that are neither input nor motion of the oscillator. Those of one or two letters must be the whole
/// word.
const OTHERS: &str = "other integrated reference setpoint target estimate predicted model wind temperature humid \
                      batt status flag quality trigger latitude longitude rpm strain error noise";

/// Names of columns that count the rows.
const COUNTERS: [&str; 14] =
    ["record", "rn", "index", "sample", "samples", "scan", "frame", "row", "nr", "no", "n", "#", "count", "counter"];

/// The guessed meaning of a column, and the reason.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ColumnGuess {
    /// The name of the column.
    pub column: String,
    /// The reason, in words that follow the meaning: "its name says so".
    pub why: &'static str,
}

impl ColumnGuess {
    /// Whether the meaning comes from neither name nor unit.
    pub fn is_a_guess(&self) -> bool {
        self.why == FIRST_FREE
    }

    /// Whether the column has the times of those behind it, beside the column of times.
    pub fn is_own_clock(&self) -> bool {
        self.why == CLOCK
    }

    /// Whether the column got no meaning.
    pub fn is_left_out(&self) -> bool {
        [LOST, UNKNOWN, NO_NUMBERS, TRUTH, OTHER, COUNTER, SEVERAL, NO_TIME].contains(&self.why)
    }
}

const BY_SHAPE: &str = "its numbers rise evenly";
const FIRST_FREE: &str = "guessed: the first column without a meaning, and no other is one";
const LOST: &str = "another column has that meaning already";
const UNKNOWN: &str = "neither its name nor its unit says what it is";
const OTHER: &str = "its name says that it is something else";
const COUNTER: &str = "it counts the rows";
const SEVERAL: &str = "it may be the input, but others may be too: name it, if one is";
const NO_TIME: &str = "its name says that it has the times, but its numbers do not rise";
const NO_NUMBERS: &str = "it has no numbers";
const CLOCK: &str = "it has the times of the columns behind it";
const TRUTH: &str = "the truth of a simulated record";

/// The reason why a column, by its name, is neither time, input nor motion.
fn is_something_else(column: &Column) -> Option<&'static str> {
    let counts = || column.values.windows(2).all(|pair| pair[1] == pair[0] + 1.0);
    if COUNTERS.iter().any(|name| column.name.trim().eq_ignore_ascii_case(name)) && counts() {
        return Some(COUNTER);
    }
    (Quantity::from_key(&column.name).is_none() && has_word(&column.name, OTHERS)).then_some(OTHER)
}

/// Whether the numbers rise in even steps, as times do.
fn is_like_time(values: &[f64]) -> bool {
    let [first, .., last] = *values else { return false };
    let mean = (last - first) / (values.len() - 1) as f64;
    mean > 0.0 && values.windows(2).all(|pair| pair[1] > pair[0] && pair[1] - pair[0] < 100.0 * mean)
}

/// Whether few numbers are smaller than the one before: a column of that name is the time, even if lines are wrong or its times are
/// rounded, which is said where it is used.
fn seldom_falls(values: &[f64]) -> bool {
    let (mut rises, mut falls) = (0, 0);
    for pair in values.windows(2) {
        rises += usize::from(pair[1] > pair[0]);
        falls += usize::from(pair[1] < pair[0]);
    }
    (rises > 0 || values.len() < 2) && 5 * falls <= rises
}

fn is_truth(column: &Column) -> bool {
    column.name.starts_with("true_")
}

/// Whether time and input have the names that [`crate::Record::write_csv`] gives them: then sensors are what they are called.
fn is_own(table: &Table) -> bool {
    let input = input_name(InputKind::GroundAcceleration);
    matches!(table.columns.as_slice(), [time, second, ..] if time.name == "t" && second.name == input)
}

/// A column that may still get a meaning.
struct Candidate {
    place: usize,
    role: Option<Role>,
    why: &'static str,
    /// Whether the column may still get a meaning. A column with a meaning that an earlier one has is left out.
    is_free: bool,
}

impl Candidate {
    fn take(&mut self, role: Role, why: &'static str) {
        (self.role, self.why, self.is_free) = (Some(role), why, false);
    }
}

impl Mapping {
    /// A guess from names, units and shapes, with the kind of input: see [`Self::guess_for`].
    pub fn guess(table: &Table) -> (Self, InputKind) {
        let (mapping, kind, _) = Self::guess_for(table, &[]);
        (mapping, kind)
    }

    /// A guess from names, units and shapes, with the kind of input and a reason for each column. Names come first;
    /// then the first column of evenly rising numbers is the time; and of two columns without a meaning the first is
    /// the input and the second the displacement. It leaves out a column if another one already has its meaning, if it
    /// counts the rows, or if its name says that it is something else. If a sensor's column has a name, a single other
    /// column is the input; several others are not. A sound has the part and the band of its [`Ring`]. An acceleration on the ground is
    /// the one that the scenario's `sensors` measure.
    pub fn guess_for(table: &Table, sensors: &[Quantity]) -> (Self, InputKind, Vec<ColumnGuess>) {
        let columns = &table.columns;
        let mut all = candidates(table);
        let has = |all: &[Candidate], wanted: &dyn Fn(Role) -> bool| all.iter().any(|one| one.role.is_some_and(wanted));
        if !has(&all, &|role| role == Role::Time)
            && let Some(one) = all.iter_mut().find(|one| one.is_free && is_like_time(&columns[one.place].values))
        {
            one.take(Role::Time, BY_SHAPE);
        }
        let free = |all: &[Candidate]| all.iter().filter(|one| one.is_free).count();
        let has_sensor = has(&all, &|role| matches!(role, Role::Sensor(_)));
        if !has(&all, &|role| matches!(role, Role::Input(_))) {
            match free(&all) {
                // With a named sensor and several other columns, none of these is a better guess than the others.
                2.. if has_sensor => all.iter_mut().filter(|one| one.is_free).for_each(|one| one.why = SEVERAL),
                1 if !has_sensor => {}
                _ => {
                    if let Some(one) = all.iter_mut().find(|one| one.is_free) {
                        one.take(Role::Input(InputKind::Force), FIRST_FREE);
                    }
                }
            }
        }
        if !has_sensor && let Some(one) = all.iter_mut().find(|one| one.is_free) {
            one.take(Role::Sensor(Quantity::DISPLACEMENT), FIRST_FREE);
        }
        // An accelerometer on a structure feels the ground too, unless the scenario or the program that wrote the file says otherwise.
        let on_ground = |role: Role| role == Role::Input(InputKind::GroundAcceleration);
        let is_stated = sensors.contains(&Quantity::ACCELERATION) || is_own(table);
        if !is_stated && has(&all, &on_ground) && !has(&all, &|role| role == Role::Sensor(Quantity::TOTAL_ACCELERATION))
        {
            for one in &mut all {
                if one.role == Some(Role::Sensor(Quantity::ACCELERATION)) {
                    one.role = Some(Role::Sensor(Quantity::TOTAL_ACCELERATION));
                }
            }
        }
        let mut mapping = Self::default();
        let mut kind = InputKind::Force;
        for one in &all {
            let column = &columns[one.place];
            let mapped = || MappedColumn::of(table, column.name.clone());
            match one.role {
                Some(Role::Time) => {
                    let unit = column.unit.clone().unwrap_or_default();
                    mapping.time = Time { column: Some(column.name.clone()), unit, ..Time::default() };
                }
                Some(Role::Input(of)) => {
                    kind = of;
                    mapping.input = Some(mapped());
                }
                Some(Role::Sensor(quantity)) => {
                    mapping.sensors.insert(quantity, mapped());
                }
                None => {}
            }
        }
        if let Some(ring) = Ring::of(table) {
            ring.apply(&mut mapping);
        }
        let clocks = clocks(table);
        let why = |place: usize| match all.iter().find(|one| one.place == place) {
            Some(one) if one.why == LOST && clocks.contains(&place) => CLOCK,
            Some(one) => one.why,
            None if is_truth(&columns[place]) => TRUTH,
            None => NO_NUMBERS,
        };
        let reason = |(place, column): (usize, &Column)| ColumnGuess { column: column.name.clone(), why: why(place) };
        (mapping, kind, columns.iter().enumerate().map(reason).collect())
    }
}

/// The columns of numbers with the meaning that their names and units give them; the first column of each meaning has it.
fn candidates(table: &Table) -> Vec<Candidate> {
    let columns = &table.columns;
    let numeric = |place: &usize| !table.is_without_numbers(*place) && !is_truth(&columns[*place]);
    let mut all: Vec<Candidate> = Vec::new();
    // A name that is the key of a quantity comes before one that contains its word.
    let is_key = |place: &usize| Quantity::from_key(&columns[*place].name).is_some();
    let (keys, others): (Vec<usize>, Vec<usize>) = (0..columns.len()).filter(numeric).partition(is_key);
    for place in keys.into_iter().chain(others) {
        let mut one = Candidate { place, role: None, why: UNKNOWN, is_free: true };
        let is_taken = |role: Role| match role {
            Role::Input(_) => all.iter().any(|other| matches!(other.role, Some(Role::Input(_)))),
            role => all.iter().any(|other| other.role == Some(role)),
        };
        if let Some(why) = is_something_else(&columns[place]) {
            (one.why, one.is_free) = (why, false);
            all.push(one);
            continue;
        }
        match role_of(&columns[place]) {
            // A false time with a short name may be anything.
            Some((Role::Time, _)) if !seldom_falls(&columns[place].values) => {
                if !has_word(&columns[place].name, "t s") {
                    (one.why, one.is_free) = (NO_TIME, false);
                }
            }
            Some((role, _)) if is_taken(role) => (one.why, one.is_free) = (LOST, false),
            Some((role, why)) => one.take(role, why),
            None => {}
        }
        all.push(one);
    }
    all.sort_by_key(|one| one.place);
    all
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Time,
    Input(InputKind),
    Sensor(Quantity),
}

/// Words in names, in the order in which they are looked for. Those of one or two letters must be the whole name.
const WORDS: [(&str, Role); 7] = [
    ("ground_acceleration ground base boden", Role::Input(InputKind::GroundAcceleration)),
    ("total_acceleration", Role::Sensor(Quantity::TOTAL_ACCELERATION)),
    ("force input load kraft excitation drive f u in v1", Role::Input(InputKind::Force)),
    ("time zeit seconds stamp temps millis micros nanos epoch t s", Role::Time),
    ("acceleration accel acc beschl a ax ay az", Role::Sensor(Quantity::ACCELERATION)),
    ("velocity speed geschw vel v", Role::Sensor(Quantity::VELOCITY)),
    (
        "displacement disp position pos angle deflection weg output winkel sound x y v2",
        Role::Sensor(Quantity::DISPLACEMENT),
    ),
];

/// The reasons, in words that follow the meaning.
const NAMED: &str = "its name says so";
const BY_UNIT: &str = "its unit says so";
const BY_CLOCK: &str = "its cells are times of day";

/// The meaning that name, unit or cells give a column, and the reason.
fn role_of(column: &Column) -> Option<(Role, &'static str)> {
    if let Some(quantity) = Quantity::from_key(&column.name) {
        return Some((Role::Sensor(quantity), NAMED));
    }
    if column.is_dated || column.is_time_of_day {
        return Some((Role::Time, BY_CLOCK));
    }
    let named = WORDS.iter().find(|(words, _)| has_word(&column.name, words)).map(|(_, role)| *role);
    let of_unit = || match unit(column.unit.as_deref()?)?.0 {
        Dimension::Time => Some(Role::Time),
        Dimension::Length | Dimension::Angle => Some(Role::Sensor(Quantity::DISPLACEMENT)),
        Dimension::Velocity => Some(Role::Sensor(Quantity::VELOCITY)),
        Dimension::Acceleration => Some(Role::Sensor(Quantity::ACCELERATION)),
        Dimension::Force => Some(Role::Input(InputKind::Force)),
        Dimension::Voltage => None,
    };
    // A unit is more reliable than a word: the A in a channel's name may be a station.
    let agrees = |role: Role| match of_unit() {
        Some(of_unit) if matches!(role, Role::Sensor(_)) => {
            let is_total = role == Role::Sensor(Quantity::TOTAL_ACCELERATION);
            of_unit == role || (is_total && of_unit == Role::Sensor(Quantity::ACCELERATION))
        }
        _ => true,
    };
    let named = named.filter(|role| agrees(*role));
    named.map(|role| (role, NAMED)).or_else(|| of_unit().map(|role| (role, BY_UNIT)))
}

/// Whether a column is one of times, by its cells, its name or its unit.
pub(super) fn is_named_time(column: &Column) -> bool {
    matches!(role_of(column), Some((Role::Time, _)))
}

/// Whether a name has one of some words; those of one or two letters must be whole.
fn has_word(name: &str, words: &str) -> bool {
    let name = name.to_lowercase();
    let whole: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
    words.split(' ').any(|word| if word.len() > 2 { name.contains(word) } else { whole.contains(&word) })
}

/// The places of the columns of times that have columns of numbers of their own behind them; two or more, or none.
pub(super) fn clocks(table: &Table) -> Vec<usize> {
    let is_clock = |place: usize| is_named_time(&table.columns[place]) && rises(table, place).is_some();
    let named: Vec<usize> = (0..table.columns.len()).filter(|place| is_clock(*place)).collect();
    let has_numbers = |(nth, place): (usize, usize)| {
        let end = named.get(nth + 1).copied().unwrap_or(table.columns.len());
        (place + 1..end).any(|column| !table.is_without_numbers(column)).then_some(place)
    };
    let found: Vec<usize> = named.iter().copied().enumerate().filter_map(has_numbers).collect();
    if found.len() > 1 { found } else { Vec::new() }
}

/// The times of a column \[s\], if they rise.
pub(super) fn rises(table: &Table, place: usize) -> Option<Vec<f64>> {
    let column = &table.columns[place];
    let times = times::of(table, column, column.unit.as_deref().unwrap_or_default(), &mut Vec::new());
    let is_clock = column.text.is_none() && times.len() >= FEWEST && times.windows(2).all(|pair| pair[1] > pair[0]);
    is_clock.then(|| times.into_owned())
}

/// The columns of a file with the time and three accelerations: phyphox, Sensor Logger, Physics Toolbox, the lines of an Arduino.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ThreeAxes {
    /// The place of the time's column, and the seconds of its unit.
    pub time: (usize, f64),
    /// The places of the columns x, y and z, and their unit \[m/s²\].
    pub axes: ([usize; 3], f64),
}

/// Names of the time's column, the best first.
const TIMES: [&str; 9] =
    ["secondselapsed", "elapsed", "time", "t", "millis", "timestamp", "ms", "micros", "loggingtime"];

/// Names of an acceleration without its axis.
const ACCELERATIONS: [&str; 9] =
    ["acceleration", "linearacceleration", "accelerometer", "accel", "acc", "a", "gf", "g", ""];

impl ThreeAxes {
    /// The time and three axes among the columns of a file, by their names; without names, the only four columns, of which one
    /// rises and three have the size of gravity together.
    pub fn of(table: &Table) -> Option<Self> {
        let columns = &table.columns;
        let axes = named(columns).or_else(|| unnamed(columns))?;
        let mut others = (0..columns.len()).filter(|place| !axes.contains(place));
        let names: Vec<String> = columns.iter().map(|column| plain(&column.name)).collect();
        let named = TIMES.iter().find_map(|name| names.iter().position(|other| other == name));
        let time = named.or_else(|| others.find(|&place| nearly_rises(&columns[place].values)))?;
        Some(Self { time: (time, seconds(&columns[time])), axes: (axes, size(columns, axes)) })
    }

    /// Time \[s\] and three accelerations \[m/s²\] of each row. The time begins at zero: an epoch in nanoseconds has too many
    /// digits.
    pub fn readings(&self, table: &Table) -> Vec<[f64; 4]> {
        let Self { time: (time, second), axes: (axes, unit) } = *self;
        let column = |place: usize| &table.columns[place].values;
        let first = column(time).iter().copied().find(|t| t.is_finite()).unwrap_or(0.0);
        let reading = |row: usize| {
            let [x, y, z] = axes.map(|axis| unit * column(axis)[row]);
            [second * (column(time)[row] - first), x, y, z]
        };
        (0..table.rows()).map(reading).collect()
    }
}

/// A name without case, blanks and signs.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The columns whose names are one name with x, y and z behind it.
fn named(columns: &[Column]) -> Option<[usize; 3]> {
    let names: Vec<String> = columns.iter().map(|column| plain(&column.name)).collect();
    ACCELERATIONS.iter().find_map(|of| {
        let place = |axis: &str| names.iter().position(|name| *name == format!("{of}{axis}"));
        Some([place("x")?, place("y")?, place("z")?])
    })
}

/// Three of four columns without names: gravity is in them.
fn unnamed(columns: &[Column]) -> Option<[usize; 3]> {
    let nameless = columns.len() == 4 && columns.iter().all(|column| column.name.starts_with("column "));
    let time = (0..4).find(|&place| nameless && nearly_rises(&columns[place].values))?;
    let mut axes = (0..4).filter(|&place| place != time);
    let axes = [axes.next()?, axes.next()?, axes.next()?];
    let length = length(columns, axes);
    let is_gravity = |unit: f64| (0.85..1.15).contains(&(length / unit));
    (is_gravity(STANDARD_GRAVITY) || is_gravity(1.0)).then_some(axes)
}

/// The length of the mean of three accelerations.
fn length(columns: &[Column], axes: [usize; 3]) -> f64 {
    let mean = |place: usize| {
        let there = || columns[place].values.iter().filter(|x| x.is_finite());
        there().sum::<f64>() / there().count().max(1) as f64
    };
    axes.map(|axis| mean(axis) * mean(axis)).iter().sum::<f64>().sqrt()
}

/// The unit of three accelerations \[m/s²\]: the file's, or g where their mean has the length one.
fn size(columns: &[Column], axes: [usize; 3]) -> f64 {
    let told = columns[axes[0]].unit.as_deref().and_then(unit);
    match told {
        Some((Dimension::Acceleration, factor)) => factor,
        _ if (0.85..1.15).contains(&length(columns, axes)) => STANDARD_GRAVITY,
        _ => 1.0,
    }
}

/// The seconds of a time's unit: the file's, or that of plausible steps.
fn seconds(column: &Column) -> f64 {
    match column.unit.as_deref().and_then(unit) {
        Some((Dimension::Time, factor)) => factor,
        _ => times::second(column).0,
    }
}

/// Whether numbers rise, but for a few.
fn nearly_rises(values: &[f64]) -> bool {
    let rising = values.windows(2).filter(|pair| pair[1] > pair[0]).count();
    values.len() > 2 && rising * 100 >= 99 * (values.len() - 1)
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::*;

    #[track_caller]
    fn check(text: &str, time: Option<&str>, input: Option<&str>, sensors: &[(Quantity, &str)]) -> InputKind {
        let table = read(text.as_bytes(), None).unwrap();
        let (mapping, kind) = Mapping::guess(&table);
        assert_eq!(mapping.time.column.as_deref(), time, "{text}");
        assert_eq!(mapping.input.as_ref().map(|input| input.column.as_str()), input, "{text}");
        let found: Vec<_> = mapping.sensors.iter().map(|(q, column)| (*q, column.column.as_str())).collect();
        assert_eq!(found, sensors, "{text}");
        kind
    }

    #[test]
    fn names_and_shapes_are_understood() {
        let x = Quantity::DISPLACEMENT;
        check("t,force,displacement\n0,1,2\n1,0,3\n2,1,2\n", Some("t"), Some("force"), &[(x, "displacement")]);
        check("Time,Force,Displacement\n0,1,2\n1,0,3\n2,1,1\n", Some("Time"), Some("Force"), &[(x, "Displacement")]);
        check("V1,V2\n0.1,0.2\n0.3,-0.1\n0.2,0\n", None, Some("V1"), &[(x, "V2")]);
        check("0 1 2\n0.1 0 3\n0.2 1 0\n", Some("column 1"), Some("column 2"), &[(x, "column 3")]);
        let angle = "Time,\"Angle, Ch 1+2 (rad) Run #13\"\n0,0.5\n0.1,0.4\n0.2,0.1\n";
        check(angle, Some("Time"), None, &[(x, "Angle, Ch 1+2 Run #13")]);
        let ground = "time,ground acc (g),total_acceleration\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
        let total = Quantity::TOTAL_ACCELERATION;
        assert_eq!(
            check(ground, Some("time"), Some("ground acc"), &[(total, "total_acceleration")]),
            InputKind::GroundAcceleration
        );
        let felt = "time,ground (g),roof acc (g)\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
        check(felt, Some("time"), Some("ground"), &[(total, "roof acc")]);
        check("time,acc (g)\n0,1\n1,-1\n2,0\n", Some("time"), None, &[(Quantity::ACCELERATION, "acc")]);
        check("Zeit;Kraft;Weg\n0,0;1;2\n0,1;0;3\n0,2;1;1\n", Some("Zeit"), Some("Kraft"), &[(x, "Weg")]);
        check("1\n3\n2\n", None, None, &[(x, "column 1")]);
        let axes = "time,ax,ay,az\n0,1,2,3\n1,2,0,1\n2,0,1,2\n";
        check(axes, Some("time"), None, &[(Quantity::ACCELERATION, "ax")]);
        let phone = "Time (s),Linear Acceleration x (m/s^2),Linear Acceleration y (m/s^2),Linear Acceleration z (m/s^2)\n\
                     0,1,2,3\n1,2,0,1\n2,0,1,2\n";
        check(phone, Some("Time"), None, &[(Quantity::ACCELERATION, "Linear Acceleration x")]);
        check("t,x,y\n0,1,2\n1,2,0\n2,0,1\n", Some("t"), None, &[(x, "x")]);
        check("t,other_velocity,x\n0,1,2\n1,2,0\n2,0,1\n", Some("t"), None, &[(x, "x")]);
        let both = "t,my velocity,velocity\n0,1,2\n1,2,0\n2,0,1\n";
        check(both, Some("t"), None, &[(Quantity::VELOCITY, "velocity")]);
        let logger = "TIMESTAMP,RECORD,accel,batt\n0,5,2,12\n1,6,0,12\n2,7,1,12\n";
        check(logger, Some("TIMESTAMP"), None, &[(Quantity::ACCELERATION, "accel")]);
        let station = "time,XX_A_DISP (m)\n0,1\n1,2\n2,1\n";
        check(station, Some("time"), None, &[(x, "XX_A_DISP")]);
        let several = "time,gauge 1,gauge 2,accel\n0,1,2,3\n1,2,0,1\n2,0,1,2\n";
        check(several, Some("time"), None, &[(Quantity::ACCELERATION, "accel")]);
        let one = "time,gauge 1,accel\n0,1,3\n1,2,1\n2,0,2\n";
        check(one, Some("time"), Some("gauge 1"), &[(Quantity::ACCELERATION, "accel")]);
        check("t,x,true_displacement\n0,1,1\n1,2,2\n2,1,1\n", Some("t"), None, &[(x, "x")]);
    }
    #[test]
    fn a_usual_number_for_missing_readings_is_guessed() {
        let table = read("t,force,x\n0,1,2\n1,0,-9999\n2,1,2.5\n3,1,-9999\n4,1,2.25\n".as_bytes(), None).unwrap();
        let (mapping, _) = Mapping::guess(&table);
        assert_eq!(mapping.sensors[&Quantity::DISPLACEMENT].missing, Some(-9999.0));
        assert_eq!(mapping.input.unwrap().missing, None);
    }
}
