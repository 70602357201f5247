//! The command `kalmanscope-cli import`: a measured record, and a scenario for it.

use std::fs;
use std::path::Path;

use kalmanscope_cli::with_spread;
use kalmanscope_core::free_decay::{Decay, Mode, Ring, Sweep};
use kalmanscope_core::import::{
    self, ColumnGuess, ImportError, MappedColumn, Mapping, Table, ThreeAxes, Time, build, join,
};
use kalmanscope_core::scenario::shown;
use kalmanscope_core::suggest::{scenario_for, suggest};
use kalmanscope_core::{Hold, InputKind};

use crate::args::{ImportArgs, Missing};
use crate::files::{InputError, check, is_standard_input, places, say, write_bytes, write_text};
use crate::prepared::table as columns_of;
use crate::progress::ProgressDisplay;

pub(crate) fn import(args: &ImportArgs) -> Result<(), InputError> {
    let ImportArgs { file, with, joined, out, decay, from, to, band, every, interpolate, plant, .. } = args;
    let inputs = [places("the record", [file]), places("--with", with)].concat();
    check(&inputs, &[places("--out", out), places("--decay", decay), places("--joined", joined)].concat())?;
    // Errors and remarks come once it is cleared.
    let progress = ProgressDisplay::wait(false, "reading");
    let (mut table, mut hash) = columns_of(file)?;
    let mut file = file;
    // Without `--decay` the rate goes into the mapping, so that `run` reads the same file with it.
    table.rate = args.rate.filter(|_| decay.is_some()).or(table.rate);
    let (of_file, ..) = mapping(&table, args);
    // A column that is the input may be the force of a sweep.
    let axes = ThreeAxes::of(&table).filter(|_| decay.is_some() || of_file.input.is_none());
    let sweep = axes.and_then(|axes| Sweep::of(&axes.readings(&table)));
    if let Some(sweep) = &sweep {
        let [[low, high], [begin, end]] = [sweep.range, sweep.part];
        say(&format_args!(
            "a sweep from {low:.1} Hz to {high:.1} Hz, between {begin:.2} s and {end:.2} s; no column has its force"
        ));
        if decay.is_none() {
            say(&"filters would take that force for white: `--decay` gives f and ζ of a sweep instead");
        }
    }
    if let (Some(sweep), Some(_)) = (&sweep, decay) {
        drop(progress);
        let modes = sweep.modes();
        say_modes(&modes, "");
        let found = if modes.is_empty() { "no mode fits it, and it" } else { "it" };
        say(&format_args!("{found} has no free decay: nothing is written"));
        return Ok(());
    }
    if let Some(decay) = decay {
        (table, hash) = free_decay(&table, file, decay)?;
        file = decay;
    }
    if let (Some(with), Some(joined)) = (with, joined) {
        (table, hash) = two_files(&table, (with, &columns_of(with)?.0), joined, args)?;
        file = joined;
    }
    let bad = |error: ImportError| InputError::bad(file, &error);
    let (mut mapping, kind, guesses) = mapping(&table, args);
    mapping.file = path_from(out.as_deref(), file);
    mapping.hash = hash;
    // A part or a band that the user names must not be replaced by that of a ring.
    let is_said = from.is_some() || to.is_some() || *every != 1 || band.is_some();
    let remark = if is_said { None } else { Ring::choose(&table, &mut mapping) };
    if remark.is_none() {
        (mapping.from, mapping.to, mapping.every) = (*from, *to, *every);
        mapping.band = band.as_ref().and_then(|band| band.as_slice().try_into().ok());
    }
    mapping.interpolate = *interpolate;
    // Nothing holds a measured input between its samples, as a simulation does.
    let imported = build(&table, &mapping, kind, Hold::First, plant.channels());
    drop(progress);
    // Without a sensor, the reasons say what is to be chosen.
    if matches!(imported, Ok(_) | Err(ImportError::NoSensor)) {
        guesses.iter().for_each(|guess| eprintln!("{}", shown(&meaning(guess, &mapping, args))));
    }
    let imported = imported.map_err(bad)?;
    remark.iter().chain(&imported.remarks).for_each(|remark| say(remark));
    if let Some(sensor) = imported.still {
        return Err(bad(ImportError::Still(sensor.name())));
    }
    let mut scenario = scenario_for(&imported.record);
    scenario.set_plant(plant.clone());
    scenario.record = Some(mapping);
    let progress = ProgressDisplay::wait(false, "finding start values");
    let suggestion = suggest(&scenario, &imported.record);
    drop(progress);
    // Nothing is written that `run` would refuse.
    let unsound = |error| InputError::bad(file, &format!("no start values could be found: {error}"));
    suggestion.scenario.validate().map_err(unsound)?;
    let toml = suggestion.scenario.to_toml().map_err(|error| InputError::bad(file, &error))?;
    let mut text = format!("# {}\n", table.form);
    for remark in remark.iter().chain(&imported.remarks).chain(&suggestion.problem).chain(&suggestion.reasons) {
        text.push_str(&shown(&format!("# {remark}\n")));
    }
    text.push_str(&toml);
    match out {
        Some(out) => write_text(out, &text),
        None => write_text(Path::new("-"), &text),
    }
}

/// Writes the free decay in a file of an accelerometer with three axes to another file. Returns the columns of that, and its hash.
fn free_decay(table: &Table, file: &Path, to: &Path) -> Result<(Table, String), InputError> {
    let bad = |reason: &dyn ToString| InputError::bad(file, reason);
    let none = "there are no three accelerations with a time, named as phyphox or an Arduino names them; if the rows have no times, \
                state the sample rate";
    let axes = ThreeAxes::of(table).ok_or_else(|| bad(&none))?;
    let groups = Decay::groups(&axes.readings(table)).map_err(|reason| bad(&reason))?;
    for (place, decays) in groups.iter().enumerate() {
        for decay in decays {
            let ([x, y, z], seconds) = (decay.axis, decay.seconds());
            say(&format_args!(
                "a free decay: {seconds:.2} s from {:.2} s on, along ({x:.2}, {y:.2}, {z:.2}); the noise is {:.3} m/s²{}",
                decay.begin,
                decay.noise,
                if place > 0 { "; another motion, left out of the file" } else { "" }
            ));
        }
        let modes = Decay::modes_of(decays);
        say_modes(&modes, ", taken out of the file");
        if modes.is_empty() {
            say(&"one or two modes do not explain all of it: a force may still act");
        }
    }
    let decays: Vec<Decay> = groups.into_iter().next().iter().flatten().map(Decay::alone).collect();
    written(Decay::file(&decays), to)
}

fn say_modes(modes: &[Mode], second: &str) {
    for (place, mode) in modes.iter().enumerate() {
        let Mode { frequency, damping_ratio, std: [of_frequency, of_damping], .. } = mode;
        let which = if place > 0 { format!("beside it{second}: ") } else { String::new() };
        let [(f, of_f), (zeta, of_zeta)] =
            [with_spread(*frequency, *of_frequency), with_spread(*damping_ratio, *of_damping)];
        say(&format_args!("{which}f {f} ± {of_f} Hz, ζ {zeta} ± {of_zeta} (2σ), fitted to all its readings"));
    }
}

fn written(text: String, to: &Path) -> Result<(Table, String), InputError> {
    let bytes = text.into_bytes();
    write_bytes(to, &bytes)?;
    let hash = import::hash(&bytes);
    let table = import::read(bytes, None).map_err(|error| InputError::bad(to, &error))?;
    Ok((table, hash))
}

fn meaning(guess: &ColumnGuess, mapping: &Mapping, args: &ImportArgs) -> String {
    let name = Some(&guess.column);
    let sensor = mapping.sensors.iter().find(|(_, sensor)| sensor.column == guess.column);
    let (what, is_asked) = if mapping.time.column.as_ref() == name {
        ("the time".to_owned(), args.time.as_ref() == name)
    } else if mapping.input.as_ref().map(|input| &input.column) == name {
        ("the input".to_owned(), args.input.as_ref() == name)
    } else if let Some((mass, _)) = mapping.forces.iter().find(|(_, column)| column.column == guess.column) {
        (mass.name(), args.force_on.iter().any(|(_, column)| *column == guess.column))
    } else if let Some((quantity, _)) = sensor {
        (quantity.name(), args.sensor.iter().any(|(_, column)| *column == guess.column))
    } else if guess.is_own_clock() {
        return format!("column `{}`: another clock: {}", guess.column, guess.why);
    } else {
        let why = if guess.is_left_out() { guess.why } else { "not asked for" };
        return format!("column `{}`: left out: {why}", guess.column);
    };
    let why = if is_asked { "as asked" } else { guess.why };
    format!("column `{}`: {what}: {why}", guess.column)
}

/// The path of a record in a scenario: relative if both are in one folder, none for a pipe, which is read only once.
pub(crate) fn path_from(out: Option<&Path>, file: &Path) -> String {
    if !file.is_file() || is_standard_input(file) {
        return String::new();
    }
    let folder = |path: &Path| path.parent().map(Path::to_owned).unwrap_or_default();
    let name = match out {
        // A folder with both files can then be moved.
        Some(out) if folder(out) == folder(file) => file.file_name().map_or(file, Path::new).to_owned(),
        Some(_) => fs::canonicalize(file).unwrap_or_else(|_| file.to_owned()),
        None => file.to_owned(),
    };
    name.to_string_lossy().into_owned()
}

fn mapping(table: &Table, args: &ImportArgs) -> (Mapping, InputKind, Vec<ColumnGuess>) {
    let ImportArgs { decay, rate, time, time_unit, even, missing, input, no_input, ground, force_on, sensor, .. } =
        args;
    let (mut mapping, mut kind, guesses) = Mapping::guess_for(table, &[]);
    if let (Some(rate), None) = (rate, decay) {
        mapping.time = Time { rate: Some(*rate), ..Time::default() };
    }
    if let Some(column) = time {
        let unit = MappedColumn::of(table, column).unit;
        mapping.time = Time { column: Some(column.clone()), unit, ..Time::default() };
    }
    if let (Some(unit), Some(_)) = (time_unit, &mapping.time.column) {
        mapping.time.unit.clone_from(unit);
    }
    mapping.time.even |= *even;
    let mapped = |column: &String| MappedColumn::of(table, column);
    if *no_input {
        mapping.take_no_input(&guesses);
    } else if let Some(column) = input {
        mapping.input = Some(mapped(column));
        // The guess may have taken this column for a sensor, and a filter must not be driven by its own reading.
        mapping.sensors.retain(|_, sensor| sensor.column != *column);
    }
    for (mass, column) in force_on {
        let is_other = |other: &MappedColumn| other.column != *column;
        mapping.input = mapping.input.filter(is_other);
        mapping.sensors.retain(|_, sensor| is_other(sensor));
        mapping.forces.insert(*mass, mapped(column));
    }
    if *ground {
        kind = InputKind::GroundAcceleration;
    }
    if !sensor.is_empty() {
        // A user with named sensors knows the columns: no other column is guessed to be the input.
        let is_said = |mapped: &MappedColumn| {
            guesses.iter().any(|guess| guess.column == mapped.column && !guess.is_a_guess())
                && !sensor.iter().any(|(_, column)| *column == mapped.column)
        };
        if input.is_none() && !mapping.input.as_ref().is_some_and(is_said) {
            mapping.input = None;
        }
        mapping.sensors = sensor.iter().map(|(quantity, column)| (*quantity, mapped(column))).collect();
    }
    if let Some(Missing(missing)) = missing {
        let inputs = mapping.input.iter_mut().chain(mapping.forces.values_mut());
        let all = inputs.chain(mapping.sensors.values_mut());
        all.for_each(|mapped| mapped.missing = *missing);
    }
    (mapping, kind, guesses)
}

/// Writes the columns of two files into a third one, each with its times. Returns the columns of the third file, and its hash.
fn two_files(
    first: &Table,
    (other, second): (&Path, &Table),
    to: &Path,
    args: &ImportArgs,
) -> Result<(Table, String), InputError> {
    let bad = |error: ImportError| InputError::bad(other, &error);
    // A cubic through a number that is no reading would spoil its neighbours.
    let [first, second] = &[first, second].map(|table| match args.missing {
        Some(Missing(None)) => table.clone(),
        Some(Missing(number)) => table.with_gaps(number),
        None => table.with_gaps(None),
    });
    // The command line asks for it beside a second file.
    let offset = args.offset.unwrap_or_default();
    let table = join(first, second, offset).map_err(bad)?;
    table.remarks.iter().for_each(|remark| say(remark));
    written(table.csv(), to)
}
