//! The choice of the filter on which causes are tried next.

use super::{FILTERS, STEPS, Search, Stage, UNKNOWN_FORCE};
use crate::judgement::diagnosis::path::Path;

/// The number of first causes that others are tried on before any remedy has three.
const FIRSTS: usize = 3;

/// Limits the filters on which causes are tried once a remedy ends well.
const FILTERS_ENOUGH: usize = 4;

/// An unknown force without a law of its own pays this share of its gain, because it fits any record. One with such a
/// law gets this share ahead of noise, which fits any record too.
const PRICE: f64 = 0.05;

/// The least gain of a path that is tried beside one with such a force, relative to that one's gain.
const FAR_BEHIND: f64 = 0.7;

impl Search {
    /// Tries causes of the remaining misfit on the best path without a good verdict, if it can still become the best.
    pub(super) fn try_next(&mut self) {
        let ends_well = |path: &Path| path.after.as_ref().is_some_and(|verdict| verdict.kind.is_good());
        let best_of = |is: &dyn Fn(&Path) -> bool| {
            self.paths.iter().filter(|path| ends_well(path) && is(path)).map(|path| self.rank(path)).reduce(f64::max)
        };
        // A free force ends in a good verdict whatever the cause is: other paths are tried too, if they are not far
        // behind.
        let well = best_of(&|path| !self.is_any_force(path));
        let least = well.or_else(|| best_of(&|_| true).map(|rank| FAR_BEHIND * rank));
        let limit = if well.is_some() { FILTERS_ENOUGH } else { FILTERS };
        let is_open = |path: &Path| {
            !path.is_tried
                && path.len() < STEPS
                && !ends_well(path)
                && least.is_none_or(|least| self.rank(path) > least)
        };
        let open = || self.paths.iter().enumerate().filter(|(_, path)| is_open(path));
        // A path with more causes is likelier, even if it begins with a wrong one: so the best first causes are tried
        // first.
        let mut firsts: Vec<f64> =
            self.paths.iter().filter(|path| path.len() == 1).map(|path| self.rank(path)).collect();
        firsts.sort_by(|a, b| b.total_cmp(a));
        let least_first = firsts.get(FIRSTS - 1).or(firsts.last()).copied().unwrap_or(f64::INFINITY);
        // The order is that of the gain with all noise fitted. The path with the largest gain of its own is added.
        let most =
            self.paths.iter().filter(|path| path.len() == 1).map(|path| path.gain).fold(f64::NEG_INFINITY, f64::max);
        let is_first = |path: &Path| path.len() == 1 && (self.rank(path) >= least_first || path.gain >= most);
        let order = |path: &Path| (is_first(path), self.rank(path));
        let better = |a: &Path, b: &Path| order(a).partial_cmp(&order(b)).unwrap_or(std::cmp::Ordering::Equal);
        let best = open().max_by(|(_, a), (_, b)| better(a, b)).map(|(place, _)| place);
        match best.filter(|_| self.filters < limit) {
            Some(place) => {
                self.filters += 1;
                self.paths[place].is_tried = true;
                let path = self.paths[place].clone();
                self.run(&path, true);
                self.stage = Stage::Causes(Some(place));
            }
            None => self.shorten_first(),
        }
    }

    /// The gain that sorts a path.
    pub(super) fn rank(&self, path: &Path) -> f64 {
        if path.has(UNKNOWN_FORCE) { self.priced(path.rank) } else { path.rank }
    }

    /// The gain with an unknown force, less the price of one that follows no law of its own.
    pub(super) fn priced(&self, rank: f64) -> f64 {
        let is_own = self.law.as_ref().is_some_and(|law| law.is_own);
        let share = if is_own { 1.0 + PRICE } else { 1.0 - PRICE };
        if rank > 0.0 { share * rank } else { rank }
    }

    /// Whether an unknown force that follows no law of its own is among the causes of a path.
    fn is_any_force(&self, path: &Path) -> bool {
        path.has(UNKNOWN_FORCE) && !self.law.as_ref().is_some_and(|law| law.is_own)
    }
}
