//! The meaning of a file's columns by their headers and cells: a guess at all of them.

use kalmanscope_filters::lists::{mapped, places, sort_items};
use kalmanscope_filters::{ForcedMass, InputKind, Quantity};

use super::header::{Dimension, STANDARD_GRAVITY, unit};
use super::shape::{are_axes, gravity, is_counter, is_noise, liveliness, never_changes, plain};
use super::table::TextCell;
use super::{Column, FEWEST, ImportError, MappedColumn, Mapping, Table, Time, times};
use crate::record::input_name;
use crate::resample::mean;

const OTHERS: &str = "other integrated reference setpoint target estimate predicted model temperature humid \
                      batt supply vcc vdd vbat status flag quality trigger latitude longitude rpm strain error noise pressure \
                      magnet compass current id uid tgf level accuracy gps altitude rssi snr";

const COUNTERS: &str =
    "record rn index sample samples scan frame row nr no n count counter seq seqnum sequence packet iteration loop id";

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
        [FIRST_FREE, OTHERS_TOO].contains(&self.why)
    }

    /// Whether the column has the times of those behind it, beside the column of times.
    pub fn is_own_clock(&self) -> bool {
        self.why == CLOCK
    }

    /// Whether the column got no meaning.
    pub fn is_left_out(&self) -> bool {
        ![NAMED, BY_UNIT, BY_CLOCK, BY_SHAPE, FIRST_FREE, CLOCK].contains(&self.why)
    }
}

const BY_SHAPE: &str = "its numbers rise evenly";
const FIRST_FREE: &str = "guessed: the first column without a meaning, and no other is one";
const OTHERS_TOO: &str = "several columns may be the input: choose it, if there is one";
const LOST: &str = "another column has that meaning already";
const COUNTER: &str = "it counts the rows";
const STILL: &str = "its numbers never change";
const UNIT: &str = "its unit is that of neither a motion nor a force";
const CLOCK: &str = "it has the times of other columns";
const LONG: &str = "another column names the channel of each row: give each channel a column of its own";

fn is_something_else(column: &Column) -> Option<&'static str> {
    let name = &column.name;
    let is_named = name.trim() == "#" || COUNTERS.split(' ').any(|word| is_word(&parts(name), word));
    let role = role_of(column).map(|(role, _)| role);
    if is_named && role != Some(Role::Time) && !never_changes(&column.values) && is_counter(&column.values, true) {
        return Some(COUNTER);
    }
    // The L of a sensor's name is the left one.
    let is_letter = |text: &str| role.is_some() && text.len() == 1 && !["%", "l"].contains(&text) && name.len() > 1;
    let of = |text: &&str| unit(text).is_some_and(|(dimension, _)| dimension == Dimension::Other);
    if column.unit.as_deref().filter(of).is_some_and(|text| !is_letter(text)) {
        return Some(UNIT);
    }
    let is_acceleration = |text: &str| unit(text).is_none_or(|(of, _)| of == Dimension::Acceleration);
    if role == Some(Role::Input(InputKind::GroundAcceleration)) && !column.unit.as_deref().is_none_or(is_acceleration) {
        return Some("of the ground's motions, only the acceleration can be the input");
    }
    let is_other = has_word(name, OTHERS) || has_word(name, "wind") && role != Some(Role::Input(InputKind::Force));
    (Quantity::from_key(name).is_none() && is_other).then_some("its name says that it is something else")
}

const CHANNELS: [&str; 2] =
    ["channel sensor signal topic measurement metric field variable parameter", "value reading payload"];

const STEADY: f64 = 20.0;

pub(super) fn no_time(table: &Table) -> ImportError {
    let named = table.columns.iter().find(|column| has_word(&column.name, TIMES));
    let why = named.map(|column| match &column.text {
        Some(TextCell { line, text }) => format!(": `{}` has `{text}` in line {line}, which is no time", column.name),
        None => format!(": the numbers of `{}` do not rise", column.name),
    });
    ImportError::NoTime(why.unwrap_or_default())
}

fn is_like_time(values: &[f64]) -> bool {
    let [first, .., last] = *values else { return false };
    let mean = (last - first) / (values.len() - 1) as f64;
    mean > 0.0 && values.windows(2).all(|pair| pair[1] > pair[0] && pair[1] - pair[0] < 100.0 * mean)
}

pub(super) fn seldom_falls(values: &[f64]) -> bool {
    let values: Vec<f64> = values.iter().copied().filter(|value| !value.is_nan()).collect();
    let count = |is: fn(&[f64]) -> bool| values.windows(2).filter(|pair| is(pair)).count();
    let (rises, falls) = (count(|pair| pair[1] > pair[0]), count(|pair| pair[1] < pair[0]));
    (rises > 0 || values.len() < 2) && 5 * falls <= rises
}

struct Candidate {
    place: usize,
    role: Option<Role>,
    why: &'static str,
    /// No earlier column has its meaning.
    is_free: bool,
}

impl Candidate {
    fn take(&mut self, role: Role, why: &'static str) {
        (self.role, self.why, self.is_free) = (Some(role), why, false);
    }

    fn leave_out(&mut self, why: &'static str) {
        (self.why, self.is_free) = (why, false);
    }
}

impl Mapping {
    /// A guess from names, units and shapes, with the kind of input: see [`Self::guess_for`].
    pub fn guess(table: &Table) -> (Self, InputKind) {
        let (mapping, kind, _) = Self::guess_for(table, &[]);
        (mapping, kind)
    }

    /// A guess from names, units and shapes, with the kind of input and a reason for each column. Names come first; then the first column
    /// of evenly rising numbers is the time, and of two columns without a meaning the first is the input and the second the displacement.
    /// If a sensor's column has a name, a single other column is the input; several others are not. An acceleration on the ground is the
    /// one that the scenario's `sensors` measure.
    pub fn guess_for(table: &Table, sensors: &[Quantity]) -> (Self, InputKind, Vec<ColumnGuess>) {
        let columns = &table.columns;
        let mut all = candidates(table);
        let has = |all: &[Candidate], wanted: &dyn Fn(Role) -> bool| all.iter().any(|one| one.role.is_some_and(wanted));
        let counts = |one: &Candidate| is_counter(&columns[one.place].values, false);
        if !has(&all, &|role| role == Role::Time) {
            let is_like = |one: &Candidate| one.is_free && is_like_time(&columns[one.place].values);
            let place = all.iter().position(|one| is_like(one) && !counts(one));
            let place = place.or_else(|| all.iter().position(is_like).filter(|_| table.rate.is_none()));
            if let Some(place) = place {
                all[place].take(Role::Time, BY_SHAPE);
            }
        }
        all.iter_mut().filter(|one| one.is_free && counts(one)).for_each(|one| one.leave_out(COUNTER));
        let unknown = |one: &&Candidate| one.is_free || [STILL, UNIT].contains(&one.why);
        let has_sensor = has(&all, &|role| matches!(role, Role::Sensor(_)));
        if !has(&all, &|role| matches!(role, Role::Input(_) | Role::ForceOn(_))) {
            match all.iter().filter(unknown).count() {
                // With a named sensor and several other columns, none of these is a better guess than the others.
                2.. if has_sensor => {
                    all.iter_mut().filter(|one| one.is_free).for_each(|one| one.why = OTHERS_TOO);
                }
                _ if !has_sensor && all.iter().filter(|one| one.is_free).count() == 1 => {}
                _ if let Some(one) = all.iter_mut().find(|one| one.is_free) => {
                    one.take(Role::Input(InputKind::Force), FIRST_FREE);
                }
                _ => {}
            }
        }
        let moves = |one: &Candidate| one.is_free && !is_noise(&columns[one.place].values);
        let sensor = all.iter().position(moves).or_else(|| all.iter().position(|one| one.is_free));
        if let Some(one) = sensor.filter(|_| !has_sensor) {
            all[one].take(Role::Sensor(Quantity::DISPLACEMENT), FIRST_FREE);
        }
        choose_axes(table, &mut all);
        // An accelerometer on a structure feels the ground too; the scenario or the program that wrote the file may exclude that.
        let on_ground = |role: Role| role == Role::Input(InputKind::GroundAcceleration);
        let names: Vec<&str> = mapped(columns, &|column| column.name.as_str());
        let is_own = names.starts_with(&["t", input_name(InputKind::GroundAcceleration)]);
        let is_stated = sensors.contains(&Quantity::ACCELERATION) || is_own;
        if !is_stated && has(&all, &on_ground) && !has(&all, &|role| role == Role::Sensor(Quantity::TOTAL_ACCELERATION))
        {
            let felt = all.iter_mut().filter(|one| one.role == Some(Role::Sensor(Quantity::ACCELERATION)));
            felt.for_each(|one| one.role = Some(Role::Sensor(Quantity::TOTAL_ACCELERATION)));
        }
        let (mut mapping, mut kind) = (Self::default(), InputKind::Force);
        for one in &all {
            let column = &columns[one.place];
            let mapped = || MappedColumn::of(table, column.name.clone());
            match one.role {
                Some(Role::Time) => {
                    let unit = column.unit.clone().unwrap_or_default();
                    mapping.time = Time { column: Some(column.name.clone()), unit, ..Time::default() };
                }
                Some(Role::Input(of)) => (kind, mapping.input) = (of, Some(mapped())),
                Some(Role::ForceOn(mass)) => drop(mapping.forces.insert(mass, mapped())),
                Some(Role::Sensor(quantity)) => drop(mapping.sensors.insert(quantity, mapped())),
                None => {}
            }
        }
        mapping.time.rate = table.rate.filter(|_| mapping.time.column.is_none());
        let clocks = clocks(table);
        let why = |place: usize| match all.iter().find(|one| one.place == place) {
            Some(one) if one.why == LOST && clocks.iter().any(|(_, clock)| *clock == place) => CLOCK,
            Some(one) => one.why,
            None if columns[place].name.starts_with("true_") => "the truth of a simulated record",
            None => "it has no numbers",
        };
        let reason = |(place, column): (usize, &Column)| ColumnGuess { column: column.name.clone(), why: why(place) };
        (mapping, kind, columns.iter().enumerate().map(reason).collect())
    }

    /// Takes no column as the input, by guesses at the columns: the first one without a name is then the sensor, not the second.
    pub fn take_no_input(&mut self, guesses: &[ColumnGuess]) {
        self.no_input = true;
        let is_guess =
            |mapped: &MappedColumn| guesses.iter().any(|one| one.column == mapped.column && one.is_a_guess());
        if let Some(input) = self.input.take().filter(is_guess)
            && self.sensors.values().all(is_guess)
        {
            self.sensors = [(Quantity::DISPLACEMENT, input)].into();
        }
    }
}

/// The axis that moves most has the meaning. Beside a sensor along a line, one that turns has none.
fn choose_axes(table: &Table, all: &mut [Candidate]) {
    let column = |one: &Candidate| &table.columns[one.place];
    let is_phone = table.columns.iter().any(|column| plain(&column.name) == "secondselapsed");
    for holder in 0..all.len() {
        let Some(role @ Role::Sensor(_)) = all[holder].role else { continue };
        // A column that does not move counts as an axis, whatever its name.
        let is_noise = is_noise(&column(&all[holder]).values);
        let of = |other: &usize| {
            let is_same = |one: &Candidate| role_of(column(one)).is_some_and(|(of, _)| of == role);
            *other == holder
                || (is_same(&all[*other])
                    && ((is_noise && all[*other].why == LOST)
                        || are_axes(&column(&all[holder]).name, &column(&all[*other]).name)))
        };
        let axes: Vec<usize> = (0..all.len()).filter(of).collect();
        if axes.len() < 2 || (axes.len() > 3 && !is_noise) {
            continue;
        }
        let (mut best, mut most) = (holder, 1.000_001 * liveliness(&column(&all[holder]).values));
        for &other in &axes {
            let moves = liveliness(&column(&all[other]).values);
            (best, most) = if moves > most { (other, moves) } else { (best, most) };
        }
        // Bare axes are accelerations where they have gravity, or as Sensor Logger names its times.
        let is_bare = axes.iter().all(|place| column(&all[*place]).name.len() == 1);
        let places: Vec<usize> = mapped(&axes, &|axis| all[*axis].place);
        let has_gravity = |axes| gravity(&table.columns, axes, [STANDARD_GRAVITY, 1.0]).is_some();
        let is_felt = <[usize; 3]>::try_from(places).is_ok_and(|axes| is_phone || has_gravity(axes));
        let role = if is_bare && is_felt { Role::Sensor(Quantity::ACCELERATION) } else { role };
        let why = role_of(column(&all[best])).map_or(all[holder].why, |(_, why)| why);
        axes.iter().for_each(|other| (all[*other].role, all[*other].why) = (None, "another axis moves more"));
        (all[best].role, all[best].why) = (Some(role), why);
    }
    let turns = |one: &Candidate| match column(one).unit.as_deref().and_then(unit) {
        None => has_word(&column(one).name, "gyro"),
        Some((of, _)) => matches!(of, Dimension::Angle | Dimension::AngularVelocity | Dimension::AngularAcceleration),
    };
    let is_sensor = |one: &&mut Candidate| matches!(one.role, Some(Role::Sensor(_)));
    let (turning, straight): (Vec<_>, Vec<_>) = all.iter_mut().filter(is_sensor).partition(|one| turns(one));
    if !straight.is_empty() {
        let why = "it turns, and another sensor moves along a line";
        turning.into_iter().for_each(|one| (one.role, one.why) = (None, why));
    }
}

fn candidates(table: &Table) -> Vec<Candidate> {
    let columns = &table.columns;
    let numeric = |place: &usize| !table.is_without_numbers(*place) && !columns[*place].name.starts_with("true_");
    let mut all: Vec<Candidate> = Vec::new();
    // A name that is the key of a quantity comes before one that contains its word.
    let is_key = |place: &usize| Quantity::from_key(&columns[*place].name).is_some();
    let (keys, others): (Vec<usize>, Vec<usize>) = (0..columns.len()).filter(numeric).partition(is_key);
    for place in keys.into_iter().chain(others) {
        let unknown = "neither its name nor its unit says what it is";
        let mut one = Candidate { place, role: None, why: unknown, is_free: true };
        let is_taken = |role: Role| match role {
            Role::Input(_) => all.iter().any(|other| matches!(other.role, Some(Role::Input(_)))),
            role => all.iter().any(|other| other.role == Some(role)),
        };
        let column = &columns[place];
        let role = role_of(column);
        let still = |column: &Column| never_changes(&column.values);
        let has_role = |other: &Column| role_of(other).map(|(role, _)| role) == role.map(|(role, _)| role);
        let is_still = || still(column) && (role.is_none() || columns.iter().any(|one| has_role(one) && !still(one)));
        let is_sensor = |column: &Column| matches!(role_of(column), Some((Role::Sensor(_), _)));
        let is_supply = || is_steady_voltage(column) && !is_sensor(column) && columns.iter().any(is_sensor);
        let supply = || is_supply().then_some("it is a voltage that hardly changes, as that of a supply");
        let no_time = "its name says that it has the times, but its numbers do not rise";
        let names_channels = |one: &Column| {
            let is_number = |value: &f64| value.fract() == 0.0 && (0.0..64.0).contains(value);
            let is_one = one.text.is_some() || (!still(one) && one.values.iter().all(is_number));
            one.name != column.name && has_word(&one.name, CHANNELS[0]) && is_one
        };
        let is_long = has_word(&column.name, CHANNELS[1]) && columns.iter().any(names_channels);
        let other = is_something_else(column).or_else(|| is_still().then_some(STILL)).or_else(supply);
        match (other.or(is_long.then_some(LONG)), role) {
            (Some(why), _) => one.leave_out(why),
            // A false time with a short name may be anything.
            (None, Some((Role::Time, _))) if !seldom_falls(&column.values) => {
                if !has_word(&column.name, "t s") {
                    one.leave_out(no_time);
                }
            }
            (None, Some((role, _))) if is_taken(role) => one.leave_out(LOST),
            (None, Some((role, why))) => one.take(role, why),
            (None, None) => {}
        }
        all.push(one);
    }
    sort_items(&mut all, |a, b| a.place.cmp(&b.place));
    all
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Time,
    Input(InputKind),
    ForceOn(ForcedMass),
    Sensor(Quantity),
}

const TIMES: &str = "time zeit seconds stamp temps millis micros nanos epoch elapsed t s ms";

/// In the order of the search. Words of one or two letters, and those behind `=`, must be whole.
const WORDS: [(&str, Role); 8] = [
    ("ground_acceleration ground base boden suelo =sol =table", Role::Input(InputKind::GroundAcceleration)),
    ("total_acceleration", Role::Sensor(Quantity::TOTAL_ACCELERATION)),
    ("force input load kraft excitation drive f u in v1", Role::Input(InputKind::Force)),
    (TIMES, Role::Time),
    ("acceleration accel acc beschl gfx gfy gfz a ax ay az", Role::Sensor(Quantity::ACCELERATION)),
    ("travel stroke", Role::Sensor(Quantity::DISPLACEMENT)),
    ("velocity speed geschw vel gyro omega v", Role::Sensor(Quantity::VELOCITY)),
    (
        "displacement disp position pos angle deflection weg output winkel sound x y z v2",
        Role::Sensor(Quantity::DISPLACEMENT),
    ),
];

const NAMED: &str = "its name says so";
const BY_UNIT: &str = "its unit says so";
const BY_CLOCK: &str = "its cells are times of day";

fn role_of(column: &Column) -> Option<(Role, &'static str)> {
    if let Some(quantity) = Quantity::from_key(&column.name) {
        return Some((Role::Sensor(quantity), NAMED));
    }
    if let Some(mass) = ForcedMass::from_key(&column.name) {
        return Some((Role::ForceOn(mass), NAMED));
    }
    if column.is_dated || column.is_time_of_day {
        return Some((Role::Time, BY_CLOCK));
    }
    let is_clock = has_word(&column.name, TIMES) && is_like_time(&column.values);
    let named = || WORDS.iter().find(|(words, _)| has_word(&column.name, words)).map(|(_, role)| *role);
    let of_unit = || match unit(column.unit.as_deref()?)?.0 {
        Dimension::Time => Some(Role::Time),
        Dimension::Length | Dimension::Angle => Some(Role::Sensor(Quantity::DISPLACEMENT)),
        Dimension::Velocity | Dimension::AngularVelocity => Some(Role::Sensor(Quantity::VELOCITY)),
        Dimension::Acceleration | Dimension::AngularAcceleration => Some(Role::Sensor(Quantity::ACCELERATION)),
        Dimension::Force => Some(Role::Input(InputKind::Force)),
        Dimension::Voltage | Dimension::Other => None,
    };
    // A unit is more reliable than a word: the A in a channel's name may be a station.
    let agrees = |role: Role| match of_unit() {
        Some(of_unit) if role == Role::Time => of_unit == Role::Time,
        Some(of_unit) if matches!(role, Role::Sensor(_)) => {
            let is_total = role == Role::Sensor(Quantity::TOTAL_ACCELERATION);
            of_unit == role || (is_total && of_unit == Role::Sensor(Quantity::ACCELERATION))
        }
        _ => true,
    };
    let of_code = || channel_code(&column.name).map(Role::Sensor);
    let named = [is_clock.then_some(Role::Time), named(), of_code()].into_iter().flatten().find(|role| agrees(*role));
    named.map(|role| (role, NAMED)).or_else(|| of_unit().map(|role| (role, BY_UNIT)))
}

/// Source: FDSN, SEED reference manual 2.4, appendix A: the second letter of a code such as `HHZ` names the instrument.
pub(super) fn channel_code(name: &str) -> Option<Quantity> {
    match name.rsplit([' ', '.', '_']).next()?.as_bytes() {
        [b'B' | b'E' | b'H' | b'S', kind, b'Z' | b'N' | b'E' | b'1'..=b'3'] => match kind {
            b'H' | b'L' => Some(Quantity::VELOCITY),
            b'N' => Some(Quantity::ACCELERATION),
            _ => None,
        },
        _ => None,
    }
}

pub(super) fn is_named_time(column: &Column) -> bool {
    matches!(role_of(column), Some((Role::Time, _)))
}

fn has_word(name: &str, words: &str) -> bool {
    let lower = name.to_lowercase();
    let is_label = ["channel", "ch", "kanal", "sensor", "probe"].iter().any(|word| is_word(&lower, word));
    words.split(' ').any(|word| match word.len() {
        _ if let Some(whole) = word.strip_prefix('=') => is_word(name, whole),
        1 => (!is_label || "xyz".contains(word)) && is_word(name, word),
        2 => is_word(name, word),
        3 => {
            let mut all = parts(name).to_lowercase();
            all.push_str(&format!(" {lower}"));
            all.split(|c: char| !c.is_alphanumeric()).any(|part| part.starts_with(word) || part.ends_with(word))
        }
        _ => lower.contains(word),
    })
}

fn parts(name: &str) -> String {
    let begins =
        |(place, c): (usize, char)| place > 0 && c.is_uppercase() && name[..place].ends_with(char::is_lowercase);
    name.char_indices().flat_map(|at| [begins(at).then_some(' '), Some(at.1)]).flatten().collect()
}

fn is_steady_voltage(column: &Column) -> bool {
    let is_voltage = matches!(column.unit.as_deref().and_then(unit), Some((Dimension::Voltage, _)));
    let middle = mean(&column.values);
    let squares = mapped(&column.values, &|value| (value - middle) * (value - middle));
    (is_voltage || has_word(&column.name, "volt")) && middle * middle > STEADY * STEADY * mean(&squares)
}

fn is_word(name: &str, word: &str) -> bool {
    name.split(|c: char| !c.is_alphanumeric()).any(|part| part.to_lowercase() == word)
}

/// The clock with the column's name; else the last one before it; else the next, if the file begins with a column and ends with a clock.
pub(super) fn clocks(table: &Table) -> Vec<(usize, usize)> {
    let columns = &table.columns;
    let is_clock = |place: usize| is_named_time(&columns[place]) && rises(table, place).is_some();
    let named = places(columns.len(), &is_clock);
    let numbers = places(columns.len(), &|place| !named.contains(&place) && !table.is_without_numbers(place));
    let is_behind = numbers.first() < named.first() && numbers.last() < named.last();
    let of = |&place: &usize| {
        let name = columns[place].name.to_lowercase();
        let own = named.iter().find(|clock| is_word(&columns[**clock].name, &name));
        let near = if is_behind {
            named.iter().find(|clock| **clock > place)
        } else {
            named.iter().rev().find(|clock| **clock < place).or(named.first())
        };
        Some((place, *own.or(near)?))
    };
    let found: Vec<(usize, usize)> = numbers.iter().filter_map(of).collect();
    if found.iter().any(|(_, clock)| *clock != found[0].1) { found } else { Vec::new() }
}

pub(super) fn rises(table: &Table, place: usize) -> Option<Vec<f64>> {
    let column = &table.columns[place];
    let times = times::of(table, column, column.unit.as_deref().unwrap_or_default(), &mut Vec::new());
    let is_clock = column.text.is_none() && times.len() >= FEWEST && times.windows(2).all(|pair| pair[1] > pair[0]);
    is_clock.then(|| times.into_owned())
}
