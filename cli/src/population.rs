//! The command `kalmanscope-cli population`: what becomes of the filters of many members of a population.

use std::collections::BTreeMap;
use std::fmt::{self, Write as _};
use std::sync::{Arc, Mutex, PoisonError};

use kalmanscope_cli::{causes, significant};
use kalmanscope_core::diagnosis::Remedy;
use kalmanscope_core::document::{self, Document, DocumentError, json};
use kalmanscope_core::{Analysis, Channel, Measure, Run, Scenario, Source, VerdictKind, Wanted};
use kalmanscope_lab::{LastError, MonteCarlo, Priority, RunVerdicts, Runner, Slice, Threads, share_interval};

use crate::args::PopulationArgs;
use crate::files::{InputError, print};
use crate::prepared::scenario_and_record;
use crate::progress::Progress;
use crate::sweep::{MOST_THREADS, filters};

/// The members that have run, with the first cause of each bad verdict if causes were looked for.
struct Population {
    runner: Arc<Runner>,
    statistics: MonteCarlo,
    causes: Option<Vec<Causes>>,
}

pub(crate) fn population(args: &PopulationArgs) -> Result<(), InputError> {
    let PopulationArgs { input, members, filter, causes, json, threads, quiet } = args;
    let bad = |reason: &dyn ToString| InputError::bad(&input.scenario, reason);
    let (mut scenario, imported) = scenario_and_record(input, &Vec::new())?;
    // Draws name filters by their ids.
    scenario.number_filters();
    let places = filters(&scenario, filter).map_err(|reason| bad(&reason))?;
    scenario.filters = places.iter().filter_map(|&place| scenario.filters.get(place).cloned()).collect();
    scenario.keep_draws();
    let source = imported.map_or(Source::Simulated, |imported| Source::Measured(Arc::new(imported.record)));
    let all = (0..scenario.filters.len()).collect();
    let ensemble = MonteCarlo::ensemble(scenario, all, *members as usize, 0, RunVerdicts::Verdicts);
    let runner = ensemble.and_then(|ensemble| Runner::new(ensemble, source)).map_err(|error| bad(&error))?;
    let runner = Arc::new(runner);
    let threads = (*threads).min(MOST_THREADS).min(*members as usize);
    let team = Threads::new(threads, 0).map_err(|error| bad(&error))?;
    let slices = run_members(&runner, &team, *quiet || *json);
    let mut statistics = MonteCarlo::new(runner.ensemble());
    slices.iter().for_each(|slice| statistics.take(runner.ensemble(), slice));
    if statistics.done() != runner.ensemble().cells() {
        return Err(bad(&"a thread ended before its work was done"));
    }
    let causes = causes.then(|| of_members(&runner, &slices, team.count(), *quiet || *json));
    let population = Population { runner, statistics, causes };
    print(&if *json { population.json().map_err(|error| bad(&error))? } else { population.text() })
}

fn run_members(runner: &Arc<Runner>, team: &Threads, quiet: bool) -> Vec<Slice> {
    let cells = runner.ensemble().cells();
    let mut progress = Progress::new(cells, quiet);
    let work = team.rows(Priority::Map, runner, (0..cells).collect(), |_| {});
    let (mut slices, mut done) = (Vec::new(), 0);
    while let Some(slice) = work.wait() {
        done += slice.cells.len();
        progress.show(done, "members");
        slices.push(slice);
    }
    slices.sort_by_key(|slice| slice.cells.first().copied());
    slices
}

const NEAR: f64 = 0.01;

#[derive(Clone, Copy)]
struct Share {
    count: usize,
    of: usize,
}

impl Population {
    fn scenario(&self) -> &Scenario {
        self.runner.ensemble().scenario()
    }

    fn parameters(&self, nth: usize) -> impl Iterator<Item = (Channel, &[LastError])> {
        let channels = self.statistics.channels(nth).iter().enumerate();
        channels.filter(|(_, channel)| channel.is_parameter() || channel.is_augmentation()).filter_map(
            move |(place, &channel)| {
                let errors = self.statistics.last_errors(nth, place);
                (!errors.is_empty()).then_some((channel, errors))
            },
        )
    }

    fn lost(&self, nth: usize) -> [Share; 2] {
        let of = self.statistics.runs();
        self.statistics.diverged(nth).map(|share| Share { count: (share * of as f64).round() as usize, of })
    }

    /// The shares of the members in which a filter is lost, near the truth, sure of it, and has a verdict: key, words and share.
    fn shares(&self, nth: usize) -> Vec<(String, String, Share)> {
        let [lost, stopped] = self.lost(nth);
        let mut shares = vec![
            ("lost".to_owned(), "lost the truth, or stopped".to_owned(), lost),
            ("stopped".to_owned(), "of these, stopped".to_owned(), stopped),
        ];
        for (channel, errors) in self.parameters(nth) {
            let (key, symbol) = (channel.key(), channel.symbol());
            let count = |is: fn(&LastError) -> bool| Share {
                count: errors.iter().filter(|last| is(last)).count(),
                of: errors.len(),
            };
            if channel.is_parameter() {
                let near = count(|last| last.is_within(NEAR));
                shares.push((format!("{key}.within_1_percent"), format!("{symbol} within 1 % at the end"), near));
            }
            let covered = count(LastError::is_covered);
            shares.push((format!("{key}.inside_2_sigma"), format!("{symbol} inside ±2σ at the end"), covered));
        }
        let counts = self.statistics.verdicts(nth);
        let of = counts.iter().sum();
        for (kind, &count) in VerdictKind::ALL.into_iter().zip(counts).filter(|(_, count)| **count > 0) {
            let share = Share { count, of };
            shares.push((format!("verdict.{}", kind.key()), format!("verdict: {}", kind.name()), share));
        }
        shares
    }

    fn text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write(&mut text);
        text
    }

    fn write(&self, text: &mut String) -> fmt::Result {
        let scenario = self.scenario();
        let (done, impossible) = (self.statistics.done(), self.statistics.impossible());
        write!(text, "{done} members")?;
        match impossible {
            0 => writeln!(text)?,
            some => writeln!(text, "; {some} are impossible scenarios and were left out")?,
        }
        if scenario.draw.is_empty() {
            writeln!(text, "only the noise differs: the scenario has no [draw]")?;
        }
        for (key, law) in &scenario.draw {
            let [a, b] = law.numbers().map(|number| significant(number, 6, 9));
            let [what, other] = law.info().numbers;
            writeln!(text, "drawn: {}, {}: {what} {a}, {other} {b}", scenario.address_by_name(key), law.info().name)?;
        }
        for (nth, filter) in scenario.filters.iter().enumerate() {
            writeln!(text, "\n{}", filter.name)?;
            self.shares(nth).iter().try_for_each(|(_, words, share)| line(text, words, *share))?;
            if let Some(causes) = self.causes.as_ref().and_then(|causes| causes.get(nth)).filter(|one| one.bad > 0) {
                writeln!(text, "  causes of the {} bad verdicts: first, and among the first two", causes.bad)?;
                for (name, [first, among]) in &causes.named {
                    let [first, among] = [*first, *among].map(|count| 100.0 * count as f64 / causes.bad as f64);
                    writeln!(text, "  {name:<42}{first:>6.1} % {among:>6.1} %")?;
                }
                let said = 100.0 * causes.said / causes.bad as f64;
                writeln!(text, "  {:<42}{said:>6.1} %", "mean probability of the first cause")?;
                line(text, "no cause found", Share { count: causes.none, of: causes.bad })?;
                line(text, "not explained by the first cause", Share { count: causes.unexplained, of: causes.bad })?;
            }
        }
        Ok(())
    }

    /// The numbers as JSON:
    ///
    /// ```text
    /// members, impossible, drawn: [{ key, law, numbers }]
    /// filters: [{ name, shares: { key: from 0 to 1 }, rmse: { channel: at the end },
    ///             causes: [{ name, first, among_first_two }], mean_probability, unexplained }]
    /// ```
    fn json(&self) -> Result<String, DocumentError> {
        let scenario = self.scenario();
        let drawn = scenario.draw.iter().map(|(key, law)| {
            json!({ "key": scenario.address_by_name(key), "law": law.info().key, "numbers": law.numbers() })
        });
        let filters = scenario.filters.iter().enumerate().map(|(nth, filter)| {
            let shares =
                self.shares(nth).into_iter().map(|(key, _, share)| (key, share.count as f64 / share.of as f64));
            let rmse = self.parameters(nth).map(|(channel, errors)| {
                let squares = errors.iter().map(|last| last.error * last.error).sum::<f64>();
                (channel.key(), (squares / errors.len() as f64).sqrt())
            });
            let causes = self.causes.as_ref().and_then(|causes| causes.get(nth));
            let named = causes.into_iter().flat_map(|causes| &causes.named);
            let named =
                named.map(|(name, [first, among])| json!({ "name": name, "first": first, "among_first_two": among }));
            let said = causes.filter(|causes| causes.bad > 0);
            json!({
                "name": filter.name,
                "shares": Document::from_iter(shares),
                "rmse": Document::from_iter(rmse),
                "causes": Document::from_iter(named),
                "mean_probability": said.map(|causes| causes.said / causes.bad as f64),
                "unexplained": causes.map(|causes| causes.unexplained),
            })
        });
        let text = document::to_json_lines(&json!({
            "members": self.statistics.done(),
            "impossible": self.statistics.impossible(),
            "drawn": Document::from_iter(drawn),
            "filters": Document::from_iter(filters),
        }))?;
        Ok(text + "\n")
    }
}

fn line(text: &mut String, name: &str, Share { count, of }: Share) -> fmt::Result {
    if of == 0 {
        return writeln!(text, "  {name:<42}     –");
    }
    let [low, high] = share_interval(count, of);
    let share = 100.0 * count as f64 / of as f64;
    writeln!(text, "  {name:<42}{share:>6.1} %   ({:.1} to {:.1})", 100.0 * low, 100.0 * high)
}

/// The causes of one filter's bad verdicts, counted over the members.
#[derive(Clone, Debug, Default)]
struct Causes {
    bad: usize,
    /// The members in which each cause is the first, and in which it is among the first two, the commonest first.
    named: Vec<(&'static str, [usize; 2])>,
    /// The members without any cause, and those whose verdict is not explained by the first one.
    none: usize,
    unexplained: usize,
    /// The sum of the probabilities that the first causes are the right ones.
    said: f64,
}

fn of_members(runner: &Runner, slices: &[Slice], threads: usize, quiet: bool) -> Vec<Causes> {
    let ensemble = runner.ensemble();
    let cells: Vec<usize> = slices.iter().flat_map(|slice| bad_cells(runner, slice)).collect();
    let progress = Mutex::new((Progress::new(cells.len(), quiet), 0));
    let of_cell = |cell: &usize| {
        let (progress, done) = &mut *progress.lock().unwrap_or_else(PoisonError::into_inner);
        progress.show(*done, "causes");
        *done += 1;
        *cell
    };
    let threads = threads.max(1);
    let work = |first: usize| {
        let cells = cells.iter().skip(first).step_by(threads).map(of_cell);
        cells.filter_map(|cell| of_member(runner, cell)).collect::<Vec<_>>()
    };
    let found: Vec<Vec<Option<CellCauses>>> = std::thread::scope(|scope| {
        let threads: Vec<_> = (0..threads).map(|first| scope.spawn(move || work(first))).collect();
        let join = |thread: std::thread::ScopedJoinHandle<'_, _>| {
            thread.join().unwrap_or_else(|panic| std::panic::resume_unwind(panic))
        };
        threads.into_iter().flat_map(join).collect()
    });
    let of_filter = |nth: usize| {
        let mut causes = Causes::default();
        let mut counts: BTreeMap<&'static str, [usize; 2]> = BTreeMap::new();
        for found in found.iter().filter_map(|member| member.get(nth)?.as_ref()) {
            causes.bad += 1;
            causes.none += usize::from(found.causes.is_empty());
            causes.said += found.said;
            causes.unexplained += usize::from(!found.is_explained);
            for (place, name) in found.causes.iter().enumerate() {
                let [first, among] = counts.entry(name).or_default();
                *first += usize::from(place == 0);
                *among += 1;
            }
        }
        causes.named = counts.into_iter().collect();
        causes.named.sort_by_key(|&(_, counts)| std::cmp::Reverse(counts));
        causes
    };
    (0..ensemble.plan().filters.len()).map(of_filter).collect()
}

struct CellCauses {
    causes: Vec<&'static str>,
    is_explained: bool,
    /// The probability of the first one; 0 where there is none.
    said: f64,
}

fn bad_cells(runner: &Runner, slice: &Slice) -> Vec<usize> {
    let plan = runner.ensemble().plan();
    let verdict = plan.measures.iter().position(|measure| *measure == Measure::VERDICT);
    let is_bad = |row: &[f64]| {
        let of = |nth: usize| verdict.map_or(f64::NAN, |place| row[nth * plan.measures.len() + place]);
        (0..plan.filters.len()).any(|nth| kind(of(nth)).is_some_and(|kind| !kind.is_good()))
    };
    let rows = slice.rows.chunks_exact(runner.ensemble().width());
    slice.cells.iter().zip(rows).filter(|(_, row)| is_bad(row)).map(|(&cell, _)| cell).collect()
}

fn kind(number: f64) -> Option<VerdictKind> {
    number.is_finite().then(|| VerdictKind::ALL[number as usize])
}

/// The causes of the verdict on each filter of a member; `None` where the verdict is good, or where there is none.
fn of_member(runner: &Runner, cell: usize) -> Option<Vec<Option<CellCauses>>> {
    let scenario = runner.ensemble().at(cell);
    let run = match runner.source() {
        Source::Measured(record) | Source::Live(record) => Run::on_record(&scenario, record.clone()),
        Source::Simulated => Run::new(&scenario),
    };
    let mut run = run.ok()?;
    run.finish();
    let analysis = Analysis::new(&run, Wanted::default());
    let remedies = causes(&run, &analysis, &mut |_| {});
    let of = |(place, remedies): (usize, &Vec<Remedy>)| {
        let verdict = analysis.diagnosis(place)?.verdict.as_ref()?;
        if verdict.kind.is_good() {
            return None;
        }
        let causes = remedies.iter().take(2).map(|remedy| remedy.first.cause.name).collect();
        let said = Remedy::probabilities(remedies).first().copied().unwrap_or_default();
        Some(CellCauses { causes, is_explained: Remedy::is_explained(remedies), said })
    };
    Some(remedies.iter().enumerate().map(of).collect())
}
