//! The results of a run as text.

use std::fmt::{self, Write as _};

use kalmanscope_core::diagnostics::{Final, MeanNis};
use kalmanscope_core::{FilterKind, Run, Summary};

use crate::number::{deviation, plain, with_spread};

/// What each filter made of the record, for people: the last estimates ±2σ with units, their errors where the truth is
/// known, the mean NIS with its 95 % interval, the log likelihood, the time per step, and where it stopped if it did.
///
/// `step_times` \[ns\] are those of [`crate::step_times`], one a filter, or empty if they are not to be shown.
pub fn table(run: &Run, step_times: &[Option<f64>]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    let _ = write_table(&mut text, run, step_times);
    text
}

fn write_table(text: &mut String, run: &Run, step_times: &[Option<f64>]) -> fmt::Result {
    let record = run.record();
    let (start, end) = (record.time(0), record.time(record.len().saturating_sub(1)));
    let [start, end, dt] = [start, end, record.dt()].map(plain);
    writeln!(text, "{} samples from {start} s to {end} s, {dt} s apart", record.len())?;
    let measured: Vec<&str> = record.sensors().iter().map(|s| s.key()).collect();
    match measured.as_slice() {
        [] => writeln!(text, "measured: nothing")?,
        names => writeln!(text, "measured: {}", names.join(", "))?,
    }
    if run.estimates().is_empty() {
        writeln!(text, "\nno filters")?;
    }
    let summaries: Vec<Summary> = run.estimates().iter().map(|e| Summary::new(e, record)).collect();
    let rows: Vec<Vec<Row>> = summaries.iter().map(|s| s.finals.iter().map(Row::new).collect()).collect();
    let all = || rows.iter().flatten();
    let widths = Widths {
        value: all().map(|r| width(&r.value)).max().unwrap_or(0),
        spread: all().map(|r| width(&r.spread)).max().unwrap_or(0),
        error: all().map(|r| width(&r.error)).max().unwrap_or(0),
    };
    for (i, (summary, rows)) in summaries.iter().zip(&rows).enumerate() {
        writeln!(text, "\n{}", heading(&summary.name, summary.kind))?;
        for row in rows {
            row.write(text, &widths)?;
        }
        write_quality(text, summary)?;
        if let Some(Some(time)) = step_times.get(i) {
            writeln!(text, "  time per step   {time:.0} ns")?;
        }
        if let Some(stop) = summary.stop {
            let time = plain(record.time(stop.sample));
            writeln!(text, "  stopped at sample {} (t = {time} s): {}", stop.sample, stop.reason)?;
        }
    }
    Ok(())
}

fn write_quality(text: &mut String, summary: &Summary) -> fmt::Result {
    let Some(nis @ MeanNis { mean, low, high }) = summary.nis else {
        return writeln!(text, "  mean NIS        – (no measurement)\n  log likelihood  –");
    };
    let verdict = if nis.is_consistent() {
        "inside"
    } else if mean > high {
        "above"
    } else {
        "below"
    };
    let meaning = match verdict {
        "above" => ": more confident than right",
        "below" => ": less confident than right",
        _ => "",
    };
    let [mean, low, high] = [mean, low, high].map(|x| if x < 1e6 { format!("{x:.3}") } else { format!("{x:.3e}") });
    writeln!(text, "  mean NIS        {mean}, {verdict} its χ² 95 % interval {low} … {high}{meaning}")?;
    writeln!(text, "  log likelihood  {:.2}", summary.log_likelihood)
}

/// The filter's name on one line, and its kind if the name does not say it.
pub(crate) fn heading(name: &str, kind: FilterKind) -> String {
    let name: String = name.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    match name.trim() {
        "" => kind.name().to_owned(),
        name if name.split(|c: char| !(c.is_alphanumeric() || c == '-')).any(|word| word == kind.name()) => {
            name.to_owned()
        }
        name => format!("{name} ({})", kind.name()),
    }
}

/// One channel's last estimate, as text.
struct Row {
    symbol: &'static str,
    name: &'static str,
    unit: &'static str,
    value: String,
    spread: String,
    error: String,
    in_stds: String,
}

struct Widths {
    value: usize,
    spread: usize,
    error: usize,
}

impl Row {
    fn new(last: &Final) -> Self {
        let &Final { channel, mean, std, error } = last;
        let (value, spread) = with_spread(mean, std);
        let (symbol, name, unit) = (channel.symbol(), channel.name(), channel.unit());
        let in_stds = match error {
            Some(error) if std > 0.0 => format!("({:.1}σ)", error.abs() / std),
            _ => String::new(),
        };
        let error = error.map(|error| deviation(error, std)).unwrap_or_default();
        Self { symbol, name, unit, value, spread, error, in_stds }
    }

    fn write(&self, text: &mut String, widths: &Widths) -> fmt::Result {
        let Self { symbol, name, unit, value, spread, error, in_stds } = self;
        let Widths { value: value_width, spread: spread_width, error: error_width } = widths;
        let mut line = format!("  {symbol:2} {name:17}  {value:>value_width$} ± {spread:spread_width$} {unit:5}");
        if !error.is_empty() {
            write!(line, "  error {error:>error_width$} {in_stds}")?;
        }
        writeln!(text, "{}", line.trim_end())
    }
}

fn width(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::Scenario;

    use crate::run_scenario;

    fn shown(toml: &str) -> String {
        table(&run_scenario(&Scenario::from_toml(toml).unwrap(), None).unwrap(), &[Some(123.4)])
    }

    #[test]
    fn every_quantity_has_its_symbol_and_unit_and_columns_are_aligned() {
        let text = shown("duration = 5.0");
        for part in ["x  displacement", "v  velocity", "ωₙ natural frequency", "ζ  damping ratio", " rad/s ", "123 ns"]
        {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        let places: Vec<usize> =
            text.lines().filter_map(|l| l.find(" ± ").map(|byte| l[..byte].chars().count())).collect();
        assert_eq!(places.len(), 8);
        assert!(places.iter().all(|&p| p == places[0]), "{text}");
    }

    #[test]
    fn nothing_to_show_is_said() {
        assert!(shown("filters = []").contains("no filters"));
        let blind = shown("sensors = []\nduration = 1.0");
        assert!(blind.contains("measured: nothing") && blind.contains("– (no measurement)"), "{blind}");
    }

    #[test]
    fn a_stop_is_told_with_sample_time_and_reason() {
        let wide = "duration = 5.0\n[[filters]]\nkind = \"ekf\"\nfading = 1e300\n";
        let text = shown(wide);
        assert!(text.contains("stopped at sample ") && text.contains(" s): the "), "{text}");
    }

    #[test]
    fn headings_stay_on_one_line() {
        assert_eq!(heading("EKF", FilterKind::Ekf), "EKF");
        assert_eq!(heading("EKF, no 2", FilterKind::Ekf), "EKF, no 2");
        assert_eq!(heading("robust", FilterKind::Ukf), "robust (UKF)");
        assert_eq!(heading("two\nlines", FilterKind::Kf), "two lines (KF)");
        assert_eq!(heading(" \t ", FilterKind::Kf), "KF");
    }
}
