//! The command `kalmanscope-cli population`: what becomes of the filters of many members of a population.

mod causes;
mod output;

use std::path::Path;
use std::sync::Arc;

use kalmanscope_core::Source;
use kalmanscope_lab::{Judged, MonteCarlo, Priority, Runner, Slice, Threads};

use crate::args::PopulationArgs;
use crate::input::InputError;
use crate::places::print;
use crate::prepared::scenario_and_record;
use crate::progress::Progress;
use crate::sweep::{MOST_THREADS, filters};

use causes::Causes;

/// The members that have run, with the first cause of each bad verdict if causes were looked for.
struct Population {
    runner: Arc<Runner>,
    statistics: MonteCarlo,
    causes: Option<Vec<Causes>>,
}

/// Runs the members and prints what became of each filter.
pub(crate) fn population(args: &PopulationArgs) -> Result<(), InputError> {
    let PopulationArgs { scenario: file, members, filter, causes, record, json, threads, quiet } = args;
    let bad = |reason: &dyn ToString| bad(file, reason);
    let (mut scenario, imported) = scenario_and_record(file, record, &Vec::new())?;
    // Draws name filters by their ids.
    scenario.number_filters();
    let places = filters(&scenario, filter).map_err(|reason| bad(&reason))?;
    scenario.filters = places.iter().filter_map(|&place| scenario.filters.get(place).cloned()).collect();
    scenario.keep_draws();
    let source = imported.map_or(Source::Simulated, |imported| Source::Measured(Arc::new(imported.record)));
    let all = (0..scenario.filters.len()).collect();
    let ensemble = MonteCarlo::ensemble(scenario, all, *members as usize, 0, Judged::Verdicts);
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
    let causes = causes.then(|| causes::of_members(&runner, &slices, team.count(), *quiet || *json));
    let population = Population { runner, statistics, causes };
    print(&if *json { population.json().map_err(|error| bad(&error))? } else { population.text() })
}

/// The rows of all members, in their order.
fn run_members(runner: &Arc<Runner>, team: &Threads, quiet: bool) -> Vec<Slice> {
    let cells = runner.ensemble().cells();
    let mut progress = Progress::new(cells, quiet);
    let work = team.rows(Priority::Map, runner, (0..cells).collect(), |_| {});
    let (mut slices, mut done) = (Vec::new(), 0);
    while let Some(slice) = work.wait() {
        done += slice.cells.len();
        progress.tell(done, "members");
        slices.push(slice);
    }
    slices.sort_by_key(|slice| slice.cells.first().copied());
    slices
}

fn bad(file: &Path, reason: &dyn ToString) -> InputError {
    InputError::Laboratory { file: file.to_owned(), reason: reason.to_string() }
}
