//! Checks over a grid: the share of its cells in which a measure keeps within limits.

use kalmanscope_core::Scenario;

use crate::check::Check;
use crate::grid;
use crate::{LessonError, Outcome};

/// The shares of the cells in which checks hold, of those checks that have cells. Each cell of a grid is run once for all checks
/// over the same grid.
///
/// # Errors
/// [`LessonError`] where a cell cannot be run.
pub(crate) fn shares(
    checks: &[&Check],
    scenario: &Scenario,
    run: &dyn Fn(&Scenario) -> Result<Outcome, LessonError>,
) -> Result<Vec<Option<f64>>, LessonError> {
    let grid = |place: usize| checks[place].cells.as_ref().map(|cells| (&cells.x, &cells.y));
    let mut shares = vec![None; checks.len()];
    for first in 0..checks.len() {
        let Some(cells) = checks[first].cells.as_ref().filter(|_| shares[first].is_none()) else { continue };
        let same: Vec<usize> = (first..checks.len()).filter(|&other| grid(other) == grid(first)).collect();
        let scenarios = grid::cells(scenario, &cells.axes()?)?;
        let mut hits = vec![0_usize; same.len()];
        for scenario in &scenarios {
            let outcome = run(scenario)?;
            for (&place, hits) in same.iter().zip(&mut hits) {
                *hits += usize::from(checks[place].holds_in(&outcome)?);
            }
        }
        for (place, hits) in same.into_iter().zip(hits) {
            shares[place] = Some(hits as f64 / scenarios.len() as f64);
        }
    }
    Ok(shares)
}
