//! The command `kalmanscope-cli stream`: readings come in, estimates go out, line by line.

use std::collections::VecDeque;
use std::io::{self, Write};
use std::path::Path;

use kalmanscope_cli::harmless;
use kalmanscope_core::diagnostics::chi_squared;
use kalmanscope_core::document::Document;
use kalmanscope_core::{Channel, EventError, EventFilter, Pass, RunError, Sample, Scenario};
use kalmanscope_sources::{LineReader, StreamRow, open, read_line};

use crate::args::StreamArgs;
use crate::files::{InputError, check, is_standard_input, places, say};
use crate::prepared::read_scenario;

/// Limits the lines that are refused with a message; later ones are counted.
const MESSAGES: usize = 100;

struct Followed {
    name: String,
    filter: EventFilter,
    watch: Watch,
    has_stopped: bool,
}

/// Writes the estimates after each line, flushed. Returns whether a filter is left that has not stopped.
pub(crate) fn stream(args: &StreamArgs) -> Result<bool, InputError> {
    let StreamArgs { scenario: file, source, late, json } = args;
    let both = [places("SCENARIO", [file]), places("SOURCE", [source])].concat();
    // A source such as `tcp://HOST:PORT` is no file: only standard input, named twice, can be a mistake.
    check(&both.into_iter().filter(|(_, file)| is_standard_input(file)).collect(), &Vec::new())?;
    let scenario = read_scenario(file, false)?;
    let mut filters = followed(file, &scenario, *late)?;
    let unread = |error: io::Error| InputError::bad(source, &error);
    let written = |error: io::Error| InputError::unwritten(Path::new("-"), &error);
    let mut input = open(&source.to_string_lossy()).map_err(unread)?;
    let mut lines = LineReader::new(&scenario);
    let mut writer = EstimateWriter { output: io::stdout().lock(), json: *json, columns: Vec::new() };
    if !writer.begin(&filters).map_err(written)? {
        return Ok(true);
    }
    let (mut bytes, mut number, mut refused) = (Vec::new(), 0_u64, 0);
    let mut taken = Vec::new();
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
        let mut reason = take(&mut filters, &row);
        // After a single line either of the two may be wrong; once two agree, it is the odd one that is refused.
        if let (Some(EventError::Gap(_, before, _)), [first]) = (&reason, taken.as_slice()) {
            refuse(
                *first,
                &format_args!("its time, {before} s, is far from that of the next line, as if its clock was not set"),
            );
            filters = followed(file, &scenario, *late)?;
            reason = take(&mut filters, &row);
        }
        match reason {
            Some(reason) => refuse(number, &reason),
            None => {
                if taken.len() < 2 {
                    taken.push(number);
                }
                if !writer.write(&mut filters).map_err(written)? {
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

/// The filters of a scenario that can follow events. Reports the others; it is an error if none can.
fn followed(file: &Path, scenario: &Scenario, late: f64) -> Result<Vec<Followed>, InputError> {
    let bad = |error: RunError| InputError::bad(file, &error);
    let mut filters = Vec::new();
    let mut left_out = Vec::new();
    for place in 0..scenario.filters.len() {
        let name = Pass::history(scenario, place).map_err(bad)?.name().to_owned();
        match EventFilter::new(scenario, place) {
            Ok(filter) => {
                let filter = filter.keeping(late);
                filters.push(Followed { name, filter, watch: Watch::default(), has_stopped: false });
            }
            Err(kalmanscope_core::EventSetupError::Run(error)) => return Err(bad(error)),
            Err(error) => left_out.push((name, error)),
        }
    }
    if filters.is_empty() {
        let reason = left_out.pop().map_or_else(|| "it has no filter".to_owned(), |(_, error)| error.to_string());
        return Err(InputError::bad(file, &reason));
    }
    left_out.iter().for_each(|(name, error)| say(&format_args!("{name} is left out: {error}")));
    Ok(filters)
}

/// Gives a row to all filters. Returns the reason if it is refused, which all do alike.
fn take(filters: &mut [Followed], row: &StreamRow) -> Option<EventError> {
    let mut refused = None;
    for one in filters.iter_mut().filter(|one| !one.has_stopped) {
        match one.filter.take(row.time, row.input, &row.readings) {
            Ok(sample) => one.watch.watch(&sample),
            Err(EventError::Stopped(time, reason)) => {
                say(&format_args!("{} has stopped at {time} s: {reason}", one.name));
                one.has_stopped = true;
            }
            Err(reason) => refused = Some(reason),
        }
    }
    refused
}

/// The updates that are looked at, and how many there must be.
const WINDOW: usize = 200;
const LEAST: usize = 20;

#[derive(Clone, Debug, Default)]
struct Watch {
    last: VecDeque<(f64, u32)>,
    /// NIS of the last sample; NaN if it has no readings.
    nis: f64,
}

impl Watch {
    fn watch(&mut self, sample: &Sample<'_>) {
        self.nis = sample.nis;
        let readings = sample.readings();
        if readings == 0 || !sample.nis.is_finite() {
            return;
        }
        self.last.push_back((sample.nis, readings));
        if self.last.len() > WINDOW {
            self.last.pop_front();
        }
    }

    /// The verdict on the last updates in words: their mean NIS against its 95 % interval.
    fn verdict(&self) -> &'static str {
        if self.last.len() < LEAST {
            return "too few readings";
        }
        let sum: f64 = self.last.iter().map(|(nis, _)| nis).sum();
        let degrees = self.last.iter().map(|(_, readings)| readings).sum();
        match chi_squared::interval(degrees, 1) {
            Some(usual) if sum > *usual.end() => "innovations larger than expected",
            Some(usual) if sum < *usual.start() => "innovations smaller than expected",
            Some(_) => "innovations as expected",
            None => "too few readings",
        }
    }
}

/// The columns of a filter behind those of its channels.
const LAST: [&str; 3] = ["nis", "again", "verdict"];

impl Followed {
    fn columns(&self) -> Vec<String> {
        let of = |prefix: &str| {
            let each = |channel: &Channel| ["", "std_"].map(|what| format!("{prefix}{what}{}", channel.key()));
            self.filter.channels.iter().flat_map(each).collect::<Vec<_>>()
        };
        let mut columns = of("");
        columns.extend(LAST.map(str::to_owned));
        if self.filter.looks_back() {
            columns.push("hindsight_t".to_owned());
            columns.extend(of("hindsight_"));
        }
        columns
    }

    /// `null` for a filter that has stopped, and where nothing is old enough for hindsight.
    fn values(&mut self) -> Vec<Document> {
        let Self { filter, watch, has_stopped, name: _ } = self;
        let channels = filter.channels.to_vec();
        let nothing = || vec![Document::Null; 2 * channels.len()];
        let mut values = if *has_stopped { nothing() } else { moments(&filter.sample(), &channels) };
        values.extend(if *has_stopped {
            [Document::Null, Document::Null, "stopped".into()]
        } else {
            [watch.nis.into(), filter.again.into(), watch.verdict().into()]
        });
        if filter.looks_back() {
            let then = filter.hindsight().filter(|_| !*has_stopped);
            let then = then.map(|(time, sample)| (time.into(), moments(&sample, &channels)));
            let (time, then) = then.unwrap_or_else(|| (Document::Null, nothing()));
            values.push(time);
            values.extend(then);
        }
        values
    }
}

/// Mean and standard deviation of each channel in canonical form: (-ωₙ, -ζ) and (ωₙ, ζ) are the same oscillator.
fn moments(sample: &Sample<'_>, channels: &[Channel]) -> Vec<Document> {
    let place = |channel| channels.iter().position(|one| *one == channel);
    let mirrored = place(Channel::NATURAL_FREQUENCY).is_some_and(|place| sample.mean[place] < 0.0);
    let n = channels.len();
    let of = |(i, channel): (usize, &Channel)| {
        let mean = if mirrored && channel.is_mirrored() { -sample.mean[i] } else { sample.mean[i] };
        [mean.into(), sample.cov[i * n + i].sqrt().into()]
    };
    channels.iter().enumerate().flat_map(of).collect()
}

/// Writes lines, each flushed. A closed pipe is the end and no error.
struct EstimateWriter<W> {
    output: W,
    json: bool,
    columns: Vec<Vec<String>>,
}

impl<W: Write> EstimateWriter<W> {
    /// Writes the header of a table for these filters. Returns whether anybody reads it.
    fn begin(&mut self, filters: &[Followed]) -> io::Result<bool> {
        self.columns = filters.iter().map(Followed::columns).collect();
        if self.json {
            return Ok(true);
        }
        // Lines are written and read without quotes, so a name must need none.
        let names = filters.iter().map(|one| harmless(&one.name).replace([',', '"'], "_"));
        let names = names
            .zip(&self.columns)
            .flat_map(|(name, columns)| columns.iter().map(move |column| format!(",{name}.{column}")));
        let line = std::iter::once("t".to_owned()).chain(names).collect();
        self.line(line)
    }

    /// Writes the estimates of all filters. Returns whether anybody reads them.
    fn write(&mut self, filters: &mut [Followed]) -> io::Result<bool> {
        let time: Document = filters.iter().find(|one| !one.has_stopped).and_then(|one| one.filter.time()).into();
        let values: Vec<Vec<Document>> = filters.iter_mut().map(Followed::values).collect();
        let line = if self.json {
            let of = |columns: &Vec<String>, values| {
                Document::from_iter(columns.iter().cloned().zip::<Vec<Document>>(values))
            };
            let all = filters.iter().zip(&self.columns).zip(values);
            let all = all.map(|((one, columns), values)| (one.name.clone(), of(columns, values)));
            Document::from_iter(std::iter::once(("t".to_owned(), time)).chain(all)).to_string()
        } else {
            let cells = values.iter().flatten().map(|value| format!(",{}", cell(value)));
            std::iter::once(cell(&time)).chain(cells).collect()
        };
        self.line(line)
    }

    fn line(&mut self, line: String) -> io::Result<bool> {
        let done = self.output.write_all((line + "\n").as_bytes()).and_then(|()| self.output.flush());
        match done {
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(false),
            done => done.map(|()| true),
        }
    }
}

/// A value in a table: numbers with ten digits, nothing for `null`.
fn cell(value: &Document) -> String {
    match value {
        Document::Null => String::new(),
        Document::String(word) => word.clone(),
        value => value.as_f64().filter(|_| value.is_f64()).map_or_else(|| value.to_string(), |x| format!("{x:.9e}")),
    }
}
