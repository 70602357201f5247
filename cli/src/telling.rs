//! The progress of long work.

/// The progress of the results of a filter.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FilterProgress<'a> {
    /// The filter's place in the scenario.
    pub place: usize,
    /// Its name.
    pub name: &'a str,
    /// The work that is under way.
    pub work: Work,
    /// The share of it that is done, from 0 to 1.
    pub share: f64,
}

/// The work on the results of a filter, in this order.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Work {
    /// The filter itself.
    Filter,
    /// The search for the causes of its verdict.
    Causes,
    /// Its Cramér-Rao bound.
    Bound,
}
