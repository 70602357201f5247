//! The rows of an ensemble's cells.

use kalmanscope_lab::{CellRun, Ensemble, Runner, outcomes_of};

use crate::adapter::Gpu;
use crate::batch::{GpuRun, serves};
use crate::error::GpuError;

impl Gpu {
    /// Whether the graphics processor is of use for an ensemble: it serves all its filters, in the first cell at least, and no
    /// score needs more than sums.
    pub fn serves(runner: &Runner) -> bool {
        let ensemble = runner.ensemble();
        if runner.needs_history() || ensemble.plan().times > 0 || !has_axis_of_filters(ensemble) {
            return false;
        }
        let Some(CellRun { scenario, record }) = runner.runs(&[0]).into_iter().next().flatten() else { return false };
        let serves = |&place: &usize| serves(&GpuRun { scenario: &scenario, place, record: &record });
        ensemble.plan().filters.iter().all(serves)
    }

    /// The rows of some cells, one after the other, as [`Runner::rows`] has them. A run that is not served is done on the
    /// processor.
    ///
    /// # Errors
    /// Those of [`Self::outcomes`].
    pub async fn rows(
        &self,
        runner: &Runner,
        cells: &[usize],
        is_wanted: &dyn Fn() -> bool,
    ) -> Result<Vec<f64>, GpuError> {
        let runs = runner.runs(cells);
        let mut all = Vec::new();
        for &place in &runner.ensemble().plan().filters {
            let possible: Vec<GpuRun<'_>> =
                runs.iter().flatten().map(|CellRun { scenario, record }| GpuRun { scenario, place, record }).collect();
            let mut outcomes = self.outcomes(&possible, is_wanted).await?.into_iter();
            let mut outcomes: Vec<_> = runs.iter().map(|run| run.as_ref().and_then(|_| outcomes.next()?)).collect();
            fill(&runs, place, &mut outcomes);
            all.push(outcomes);
        }
        Ok(runner.rows_of(&runs, &all))
    }
}

/// Whether runs differ by their filters, so that many have one record. Else the time goes into simulation.
fn has_axis_of_filters(ensemble: &Ensemble) -> bool {
    ensemble.settings().iter().any(kalmanscope_lab::Setting::is_of_filters)
}

/// Computes what is missing side by side.
fn fill(runs: &[Option<CellRun>], place: usize, outcomes: &mut [Option<kalmanscope_core::score::Outcome>]) {
    let missing: Vec<usize> = (0..runs.len()).filter(|&at| runs[at].is_some() && outcomes[at].is_none()).collect();
    if missing.is_empty() {
        return;
    }
    let some: Vec<Option<CellRun>> = missing.iter().map(|&at| runs[at].clone()).collect();
    for (at, outcome) in missing.into_iter().zip(outcomes_of(&some, place, &[])) {
        outcomes[at] = outcome;
    }
}
