//! The command `kalmanscope-cli stream`: readings come in, estimates go out, line by line.

mod watch;
mod writer;

use std::io;
use std::path::Path;

use kalmanscope_core::{EventError, EventFilter, Pass, RunError, Scenario};
use kalmanscope_sources::{Lines, StreamRow, open, read_line};

use crate::args::StreamArgs;
use crate::input::{InputError, is_standard_input};
use crate::places::{check, places, say};
use crate::prepared::read_scenario;
use watch::Watch;
use writer::Writer;

/// Limits the lines that are refused with a message; later ones are counted.
const MESSAGES: usize = 100;

/// A filter that follows the stream.
struct Followed {
    name: String,
    filter: EventFilter,
    watch: Watch,
    /// Whether it has stopped, and has said so.
    has_stopped: bool,
}

/// Reads lines until there are no more, and writes the estimates at the newest time after each, flushed. What is refused is
/// said on standard error. Returns whether a filter is left that has not stopped.
pub(crate) fn stream(args: &StreamArgs) -> Result<bool, InputError> {
    let StreamArgs { scenario: file, source, late, json } = args;
    let both = [places("SCENARIO", [file]), places("SOURCE", [source])].concat();
    check(&both.into_iter().filter(|(_, file)| is_standard_input(file)).collect(), &Vec::new())?;
    let scenario = read_scenario(file, false)?;
    let mut filters = followed(file, &scenario, *late)?;
    let unread = |error: io::Error| InputError::Read { file: source.clone(), error };
    let written = |error: io::Error| InputError::Output { file: "-".into(), reason: error.to_string() };
    let mut input = open(&source.to_string_lossy()).map_err(unread)?;
    let mut lines = Lines::new(&scenario);
    let mut writer = Writer::new(io::stdout().lock(), *json);
    if !writer.begin(filters.iter().map(|one| (one.name.as_str(), &one.filter))).map_err(written)? {
        return Ok(true);
    }
    let (mut bytes, mut number, mut refused) = (Vec::new(), 0_u64, 0);
    let mut refuse = |number: u64, reason: &dyn std::fmt::Display| {
        refused += 1;
        if refused <= MESSAGES {
            say(&format_args!("line {number}: {reason}; it is left out"));
        }
    };
    while read_line(&mut input, &mut bytes).map_err(unread)? {
        number += 1;
        let row = match lines.read(&bytes) {
            Ok(Some(row)) => row,
            Ok(None) => continue,
            Err(reason) => {
                refuse(number, &reason);
                continue;
            }
        };
        match take(&mut filters, &row) {
            Some(reason) => refuse(number, &reason),
            None => {
                let all = filters.iter_mut().map(|one| (&mut one.filter, &one.watch, one.has_stopped));
                if !writer.write(all).map_err(written)? {
                    break;
                }
            }
        }
        if filters.iter().all(|one| one.has_stopped) {
            break;
        }
    }
    if refused > MESSAGES {
        say(&format_args!("{refused} of {number} lines were left out"));
    }
    Ok(filters.iter().any(|one| !one.has_stopped))
}

/// The filters of a scenario that can follow events. One that cannot is said; it is an error if there is no other.
fn followed(file: &Path, scenario: &Scenario, late: f64) -> Result<Vec<Followed>, InputError> {
    let bad = |error: RunError| InputError::Run { file: file.to_owned(), error };
    let mut filters = Vec::new();
    let mut last = None;
    for place in 0..scenario.filters.len() {
        let name = Pass::history(scenario, place).map_err(bad)?.name().to_owned();
        match EventFilter::new(scenario, place) {
            Ok(filter) => {
                let filter = filter.keeping(late);
                filters.push(Followed { name, filter, watch: Watch::default(), has_stopped: false });
            }
            Err(kalmanscope_core::EventSetupError::Run(error)) => return Err(bad(error)),
            Err(error) => {
                say(&format_args!("{name} is left out: {error}"));
                last = Some(error);
            }
        }
    }
    if filters.is_empty() {
        let reason = last.map_or_else(|| "it has no filter".to_owned(), |error| error.to_string());
        return Err(InputError::Laboratory { file: file.to_owned(), reason });
    }
    Ok(filters)
}

/// Gives a row to all filters. Returns the reason if it is refused, which all do alike.
fn take(filters: &mut [Followed], row: &StreamRow) -> Option<EventError> {
    let mut refused = None;
    for one in filters.iter_mut().filter(|one| !one.has_stopped) {
        match one.filter.take(row.time, row.input, &row.readings) {
            Ok(sample) => one.watch.look(&sample),
            Err(EventError::Stopped { time, reason }) => {
                say(&format_args!("{} has stopped at {time} s: {reason}", one.name));
                one.has_stopped = true;
            }
            Err(reason) => refused = Some(reason),
        }
    }
    refused
}
