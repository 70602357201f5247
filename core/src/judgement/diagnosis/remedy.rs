//! A remedy: causes that are repaired one after the other, and the resulting filter.

use super::cause::LikelyCause;
use super::verdict::Verdict;
use super::verdict_kind::VerdictKind;
use crate::data::setting::Edit;

/// A cause, or several one after the other, and the effect of making their edits.
#[derive(Clone, Debug)]
pub struct Remedy {
    /// The cause, its evidence and its edits.
    pub first: LikelyCause,
    /// The causes of the remaining misfit after the first one is repaired, in the order of their repairs.
    pub then: Vec<LikelyCause>,
    /// The edits of all causes together, the last of each key.
    pub edits: Vec<Edit>,
    /// The log likelihood that the edits gain over the window, less half the logarithm of the number of samples for each
    /// number that is fitted (the Bayesian information criterion); NaN where it has not been tried.
    ///
    /// Source: Schwarz (1978), Estimating the dimension of a model, *The Annals of Statistics* 6.
    pub gain: f64,
    /// The verdict on the filter with the edits made, over the window.
    pub after: Option<Verdict>,
}

impl Remedy {
    /// The causes in the order in which they are repaired.
    pub fn causes(&self) -> impl Iterator<Item = &LikelyCause> {
        std::iter::once(&self.first).chain(&self.then)
    }

    /// The same, mutable.
    pub(super) fn causes_mut(&mut self) -> impl Iterator<Item = &mut LikelyCause> {
        std::iter::once(&mut self.first).chain(&mut self.then)
    }

    /// Whether nothing is left to explain. Either the filter with the edits made has a good verdict, or its only
    /// fault is a parameter that is not identifiable; or the cause is certain and has no edit, or is a fault of the record.
    pub fn explains(&self) -> bool {
        let of_nothing = self.first.certain && self.edits.is_empty();
        of_nothing || self.first.of_record || self.after.as_ref().is_some_and(|verdict| rests(verdict.kind) > 0)
    }

    /// Whether the first of some remedies, the likeliest first, explains the verdict: otherwise none of them does.
    pub fn is_explained(remedies: &[Self]) -> bool {
        remedies.first().is_some_and(Self::explains)
    }

    /// The rank of a remedy, before likelihoods are compared. From high to low: a fault of the record, a certain cause
    /// with a remedy, a remedy with a good verdict, a certain cause without a remedy, any other, a remedy that silences
    /// a sensor.
    pub(super) fn precedence(&self) -> u8 {
        let ends = self.after.as_ref().map_or(0, |verdict| rests(verdict.kind));
        match &self.first {
            likely if likely.of_record => 6,
            likely if likely.certain && !self.edits.is_empty() => 5,
            likely if likely.silences => 0,
            _ if ends > 0 => 2 + ends,
            likely if likely.certain => 2,
            _ => 1,
        }
    }
}

/// 2 for a good verdict, 1 if a parameter is not identifiable, 0 otherwise.
fn rests(kind: VerdictKind) -> u8 {
    match kind {
        kind if kind.is_good() => 2,
        VerdictKind::NotIdentifiable => 1,
        _ => 0,
    }
}
