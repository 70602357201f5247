//! The choice of results to compute.

use crate::numbers::diagnostics::Depth;

/// The results to compute in addition to the estimates.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// Diagnostics and their depth; `None` for no diagnostics.
    pub diagnostics: Option<Depth>,
    /// Smoothed estimates of the filters that have a smoother.
    pub smoothed: Hindsight,
    /// The evidence of each filter over time.
    pub evidence: bool,
    /// The Cramér-Rao bounds, each of which costs as much as a filter.
    pub bounds: bool,
}

/// The smoothed estimates to compute.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Hindsight {
    /// None.
    None,
    /// Those with a fixed look-ahead, as the run goes on.
    Lagged,
    /// Also those of the whole run, once it is complete.
    All,
}

impl Wanted {
    /// The estimates alone.
    pub const NOTHING: Self = Self { diagnostics: None, smoothed: Hindsight::None, evidence: false, bounds: false };

    /// The Cramér-Rao bounds.
    pub const BOUNDS: Self = Self { bounds: true, ..Self::NOTHING };

    /// The evidence of each filter.
    pub const EVIDENCE: Self = Self { evidence: true, ..Self::NOTHING };

    /// Diagnostics of some depth.
    pub const fn diagnostics(depth: Depth) -> Self {
        Self { diagnostics: Some(depth), ..Self::NOTHING }
    }

    /// The union of both.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            diagnostics: self.diagnostics.max(other.diagnostics),
            smoothed: self.smoothed.max(other.smoothed),
            evidence: self.evidence || other.evidence,
            bounds: self.bounds || other.bounds,
        }
    }
}

impl Default for Wanted {
    /// All diagnostics and smoothed estimates, no bounds.
    fn default() -> Self {
        Self { diagnostics: Some(Depth::All), smoothed: Hindsight::All, ..Self::NOTHING }
    }
}
