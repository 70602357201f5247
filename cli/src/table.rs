//! The results of a run as text.

use std::fmt::{self, Write as _};

use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::{Channel, FilterKind, ModelClasses, Scenario, Summary};

use crate::in_words::{are_models, evidence, likeliest, quality, remarks, unexplained};
use crate::number::{plain, short};
use crate::results::{FilterResults, Results};
use crate::rows::{COLUMNS, rows};

impl Results<'_> {
    /// The results as a table of at most ten lines a filter: the verdict in a sentence, the likeliest cause with its command, and
    /// the last estimates ±2σ with units, parameters first, and their errors where the truth is known; where the filter stopped if it
    /// did; then the smoothed estimates of the filters that have a smoother.
    ///
    /// All of it besides: the evidence, all causes with their edits, every channel, σ over its Cramér-Rao bound, mean NIS and NEES
    /// with their 95 % intervals, the whiteness of the innovations, the log likelihood, the time per step and all remarks.
    pub fn table(&self, all: bool) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = write_table(&mut text, self, all);
        text
    }
}

const FEW: usize = 4;

fn write_table(text: &mut String, results: &Results<'_>, is_whole: bool) -> fmt::Result {
    let Results { scenario, record, truth_stop, filters, smoothers, free_runs: _ } = results;
    let (start, end) = (record.time(0), record.time(record.len().saturating_sub(1)));
    let [start, end, dt] = [start, end, record.dt()].map(plain);
    writeln!(text, "{} samples from {start} s to {end} s, {dt} s apart", record.len())?;
    let measured: Vec<&str> = record.sensors().iter().map(|s| s.key()).collect();
    match measured.as_slice() {
        [] => writeln!(text, "measured: nothing")?,
        names => writeln!(text, "measured: {}", names.join(", "))?,
    }
    if let Some(stop) = truth_stop {
        writeln!(text, "the record ends before sample {}: {}", stop.sample, stop.reason)?;
    }
    if filters.is_empty() {
        writeln!(text, "\nno filters")?;
    }
    let all: Vec<(&Summary, Option<&FilterResults>)> =
        filters.iter().map(|f| (&f.summary, Some(f))).chain(smoothers.iter().map(|s| (s, None))).collect();
    let mapping = scenario.record.as_ref();
    let rows_of = |summary: &Summary| -> Vec<[String; COLUMNS]> {
        let mut finals: Vec<_> = summary.finals.iter().collect();
        if !is_whole {
            finals.sort_by_key(|last| !last.channel.is_parameter());
            finals.truncate(FEW);
        }
        finals.into_iter().flat_map(|last| rows(last, mapping)).collect()
    };
    let rows: Vec<_> = all.iter().map(|(summary, _)| rows_of(summary)).collect();
    let mut probabilities = results.probabilities().into_iter();
    let widths: [usize; COLUMNS] =
        std::array::from_fn(|i| rows.iter().flatten().map(|row| width(&row[i])).max().unwrap_or(0));
    for ((summary, filter), rows) in all.into_iter().zip(&rows) {
        writeln!(text, "\n{}", heading(&summary.name, summary.kind))?;
        match &summary.verdict {
            Some(verdict) if is_whole => writeln!(text, "  {verdict}")?,
            Some(verdict) => writeln!(text, "  {}", verdict.to_string().split("; ").next().unwrap_or_default())?,
            None if filter.is_some() => writeln!(text, "  no verdict: fewer than 20 measurements")?,
            None => {}
        }
        if let Some(filter) = filter {
            let evidence = filter.diagnosis.iter().filter(|_| is_whole).flat_map(evidence);
            evidence.into_iter().try_for_each(|line| writeln!(text, "    {line}"))?;
            write_causes(text, &filter.causes, summary, scenario, is_whole)?;
        }
        for row in rows {
            write_row(text, row, &widths)?;
        }
        if is_whole {
            filter.into_iter().try_for_each(|filter| write_bound(text, &filter.over_bound))?;
            for (name, value) in quality(summary, filter.is_some()) {
                writeln!(text, "  {name:<16}{value}")?;
            }
        }
        if let Some(p) = filter.and(probabilities.next()) {
            writeln!(text, "  probability     {} among these models", ModelClasses::in_percent(p))?;
        }
        if let Some(time) = filter.filter(|_| is_whole).and_then(|filter| filter.step_time) {
            writeln!(text, "  time per step   {time:.0} ns")?;
        }
        let most = if is_whole { usize::MAX } else { 1 };
        for line in filter.into_iter().flat_map(|filter| remarks(&filter.remarks, record)).take(most) {
            writeln!(text, "  {line}")?;
        }
        if let Some(stop) = summary.stop {
            let time = plain(record.time_of(stop.sample));
            writeln!(text, "  stopped at sample {} (t = {time} s): {}", stop.sample, stop.reason)?;
        }
    }
    if !is_whole && !results.filters.is_empty() {
        writeln!(text, "\nevidence, other causes, every channel and the likelihoods: --verbose")?;
    }
    Ok(())
}

fn write_causes(
    text: &mut String,
    causes: &[Remedy],
    summary: &Summary,
    scenario: &Scenario,
    is_whole: bool,
) -> fmt::Result {
    unexplained(causes, summary).into_iter().try_for_each(|line| writeln!(text, "  {line}"))?;
    let what = if are_models(summary) { "likelier model" } else { "cause" };
    let most = if is_whole { usize::MAX } else { 1 };
    for (number, cause) in (1..).zip(likeliest(causes, summary, scenario)).take(most) {
        writeln!(text, "  {what} {number}: {}", cause.sentence)?;
        // The last line is the command that makes all edits, or the hint where there are none.
        let first = if is_whole { 0 } else { cause.remedies.len().saturating_sub(1) };
        cause.remedies[first..].iter().try_for_each(|line| writeln!(text, "    {line}"))?;
    }
    Ok(())
}

fn write_bound(text: &mut String, over_bound: &[(Channel, f64)]) -> fmt::Result {
    let ratios: Vec<String> =
        over_bound.iter().map(|(channel, ratio)| format!("{} {}", channel.symbol(), short(*ratio))).collect();
    if ratios.is_empty() { Ok(()) } else { writeln!(text, "  σ over bound    {}", ratios.join(", ")) }
}

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

const LABELS: [&str; COLUMNS] = ["", "", "", "±", "", "error", "", "RMSE", "last third", "inside", "settled"];

/// Aligns numbers to the right of their column and words to the left; leaves out columns that are empty in every row.
fn write_row(text: &mut String, row: &[String; COLUMNS], widths: &[usize; COLUMNS]) -> fmt::Result {
    let mut line = " ".to_owned();
    for (i, ((cell, &width), label)) in row.iter().zip(widths).zip(LABELS).enumerate() {
        let label = if cell.is_empty() { " ".repeat(label.len()) } else { label.to_owned() };
        match i {
            _ if width == 0 => {}
            0 | 1 | 4 | 6 => write!(line, " {cell:width$}")?,
            3 => write!(line, " {label} {cell:width$}")?,
            5 | 7.. => write!(line, "  {label} {cell:>width$}")?,
            _ => write!(line, "  {cell:>width$}")?,
        }
    }
    writeln!(text, "{}", line.trim_end())
}

fn width(text: &str) -> usize {
    text.chars().count()
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::{Analysis, Wanted};

    use crate::{causes, run_scenario};

    fn shown(toml: &str) -> String {
        let scenario = Scenario::from_toml(toml).unwrap();
        let run = run_scenario(&scenario, None).unwrap();
        let analysis = Analysis::new(&run, Wanted { bounds: true, ..Wanted::default() });
        let mut results = Results::of_run(&run, &analysis, causes(&run, &analysis, &mut |_| {}));
        if let Some(first) = results.filters.first_mut() {
            first.step_time = Some(123.4);
        }
        results.table(true)
    }

    #[test]
    fn the_bound_is_told_for_channels_that_the_truth_has() {
        let text = shown("duration = 5.0\n[plant]\nkind = \"duffing\"\n[[filters]]\nplant = \"sdof\"");
        let line = text.lines().find(|line| line.contains("σ over bound")).unwrap();
        let symbols: Vec<&str> = line.split_whitespace().skip(3).step_by(2).collect();
        assert_eq!(symbols, ["x", "v", "ωₙ", "ζ"]);
        let known = shown(
            "duration = 5.0\n[plant]\nnatural_frequency = 8\n[[filters]]\nkind = \"kf\"\n\
             fading = 1.0\ninitial_mean = { damping_ratio = 0.05 }",
        );
        assert!(known.contains("σ over bound    x 1.00, v 1.00\n"), "{known}");
    }

    #[test]
    fn the_time_of_a_jump_is_told() {
        let text = shown(
            "duration = 25.0\n[plant]\nnatural_frequency = { step = { from = 6.0, to = 4.8, at = 20.0 } }\n\
             [[filters]]\nfading = 1.0\njump = true",
        );
        let line = text.lines().find(|line| line.contains("let its parameters move at 20.")).unwrap();
        assert!(line.ends_with(" s, where its innovations grew at once"), "{line}");
    }

    #[test]
    fn remarks_are_listed_with_their_times() {
        let text = shown(
            "duration = 5.0\n[plant]\nkind = \"shear_2\"\n[[sensors]]\nmeasures = \"velocity_2\"\n\
             noise_std = 0.1\n[[filters]]\nplant = \"sdof\"",
        );
        assert!(text.contains("  from 0.01 s to 5 s: the filter's plant has no velocity_2"), "{text}");
        let runaway = shown("[plant]\nkind = \"duffing\"\ncubic_stiffness = -300\ninitial = { displacement = 0.5 }");
        assert!(runaway.contains("the record ends before sample ") && runaway.contains("has run away"), "{runaway}");
    }

    #[test]
    fn smoothed_estimates_follow_the_filters() {
        let text = shown("duration = 5.0\n[[filters]]\nkind = \"ukf\"\nsmoother = true");
        let (_, smoothed) = text.split_once("\nUKF, smoothed\n").unwrap();
        assert!(smoothed.contains("RMSE") && smoothed.contains("mean NEES"), "{text}");
        assert!(
            !smoothed.contains("NIS") && !smoothed.contains("verdict") && !smoothed.contains("likelihood"),
            "{text}"
        );
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
        // Four channels of two filters, and their frequencies in Hz.
        assert_eq!(places.len(), 10);
        assert!(places.iter().all(|&p| p == places[0]), "{text}");
        for label in ["  error ", "  RMSE ", "  last third ", "  inside "] {
            let places: Vec<usize> =
                text.lines().filter_map(|l| l.find(label).map(|byte| l[..byte].chars().count())).collect();
            assert!(places.len() == 8 && places.iter().all(|&p| p == places[0]), "{label} in\n{text}");
        }
    }

    #[test]
    fn the_verdict_comes_first() {
        let text = shown("duration = 5.0");
        let lines: Vec<&str> = text.lines().collect();
        let heading = lines.iter().position(|line| *line == "EKF").unwrap();
        assert!(lines[heading + 1].starts_with("  consistent: innovations² are "), "{text}");
        for part in ["mean NEES ", "95 % ellipsoid", "Ljung-Box ", "; v Q = ", "  settled "] {
            assert!(text.contains(part), "{part} in\n{text}");
        }
        assert!(shown("duration = 0.05").contains("no verdict: fewer than 20 measurements"));
    }

    #[test]
    fn parameters_held_for_certain_have_only_an_error() {
        let text = shown("duration = 5.0\n[[filters]]\nkind = \"kf\"\n");
        let frequency = text.lines().find(|line| line.contains("natural frequency")).unwrap();
        assert!(
            frequency.contains("RMSE") && !frequency.contains("inside") && !frequency.contains("settled"),
            "{text}"
        );
    }

    #[test]
    fn missing_filters_and_measurements_are_stated() {
        assert!(shown("filters = []").contains("no filters"));
        let blind = shown("sensors = []\nduration = 1.0");
        assert!(blind.contains("measured: nothing") && blind.contains("– (no measurement)"), "{blind}");
    }

    #[test]
    fn a_stop_is_reported_with_sample_time_and_reason() {
        let wide = "duration = 5.0\n[[filters]]\nkind = \"ekf\"\nfading = 1e300\n";
        let text = shown(wide);
        assert!(text.contains("stopped at sample ") && text.contains(" s): the "), "{text}");
    }

    #[test]
    fn headings_stay_on_one_line() {
        assert_eq!(heading("EKF", FilterKind::EKF), "EKF");
        assert_eq!(heading("EKF, no 2", FilterKind::EKF), "EKF, no 2");
        assert_eq!(heading("robust", FilterKind::UKF), "robust (UKF)");
        assert_eq!(heading("two\nlines", FilterKind::KF), "two lines (KF)");
        assert_eq!(heading(" \t ", FilterKind::KF), "KF");
    }
}
