//! The rows of an ensemble's cells.

use kalmanscope_core::score::Outcome;
use kalmanscope_lab::{CellRun, Ensemble, Runner};

use crate::adapter::Gpu;
use crate::batch::{GpuRun, in_parts, serves};
use crate::program::GpuError;

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

    /// Runs some cells. Returns those of which the graphics processor serves all filters, and their rows one after the other,
    /// in the form of [`Runner::rows`].
    ///
    /// # Errors
    /// Those of [`Self::outcomes`].
    pub async fn rows(
        &self,
        runner: &Runner,
        cells: &[usize],
        is_wanted: &dyn Fn() -> bool,
    ) -> Result<(Vec<usize>, Vec<f64>), GpuError> {
        let runs = in_parts(cells, |cells| runner.runs(cells));
        let mut outcomes: Vec<Vec<Option<Outcome>>> = vec![Vec::new(); cells.len()];
        for &place in &runner.ensemble().plan().filters {
            let possible: Vec<GpuRun<'_>> =
                runs.iter().flatten().map(|CellRun { scenario, record }| GpuRun { scenario, place, record }).collect();
            let mut of_filter = self.outcomes(&possible, is_wanted).await?.into_iter();
            for (outcomes, _) in outcomes.iter_mut().zip(&runs).filter(|(_, run)| run.is_some()) {
                outcomes.push(of_filter.next().flatten());
            }
        }
        let row = |&((&cell, run), outcomes): &((&usize, &Option<CellRun>), &Vec<Option<Outcome>>)| {
            let all: Option<Vec<&Outcome>> = outcomes.iter().map(Option::as_ref).collect();
            all.map(|outcomes| (cell, runner.row_of_sums(run.as_ref(), &outcomes)))
        };
        let done: Vec<_> = cells.iter().zip(&runs).zip(&outcomes).collect();
        let rows_of_cells = in_parts(&done, |done| done.iter().filter_map(row).collect());
        let (served, rows): (Vec<usize>, Vec<Vec<f64>>) = rows_of_cells.into_iter().unzip();
        Ok((served, rows.concat()))
    }
}

/// Whether runs differ by their filters, so that many share a record. If not, simulation takes most of the time.
fn has_axis_of_filters(ensemble: &Ensemble) -> bool {
    ensemble.settings().iter().any(kalmanscope_core::setting::Address::is_of_filters)
}
