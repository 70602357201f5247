//! The order of causes after their trials.

use super::cause::LikelyCause;
use super::remedy::Remedy;
use super::trial::{Outcome, Trials};

/// The least gain in log likelihood of a cause that is named, less the gain of its numbers by chance.
pub(super) const WORTH: f64 = 8.0;

/// The least size of a parameter with a significant sign, in standard deviations.
const SIGNIFICANT: f64 = 4.0;

/// A cause explains a record better than noise if its log likelihood is larger by this.
const BEYOND: f64 = 20.0;

/// Whether a likely cause is a noise that the filter assumes too small or too large.
fn is_noise(likely: &LikelyCause) -> bool {
    matches!(likely.cause.key, "sensor_noise" | "process_noise" | "felt_disturbance")
}

/// A cause that was tried alone.
pub(super) struct Ranked {
    pub(super) remedy: Remedy,
    /// The gain that sorts it.
    pub(super) rank: f64,
    /// The gain of the filter with the edits made, less the price of the numbers that they fit.
    pub(super) achieved: f64,
}

impl Trials {
    /// The causes that have been found so far, each once: first those with a remedy that ends in a good verdict, then
    /// the likeliest.
    pub fn remedies(&self) -> Vec<Remedy> {
        self.ranked().into_iter().map(|ranked| ranked.remedy).collect()
    }

    /// The same with the gains that sort them.
    pub(super) fn ranked(&self) -> Vec<Ranked> {
        let Some(before) = self.outcome_before() else { return Vec::new() };
        let penalty = self.price();
        let tried = || self.tried();
        // A larger noise explains any misfit a little. So a cause comes first if it explains the record better than any
        // noise, with the size of all noise fitted in both.
        let open = |likely: &LikelyCause, outcome: &Outcome| {
            outcome.scaled - before.log_likelihood - penalty * (likely.fitted + 1.0)
        };
        let of_noise = tried().filter(|(likely, _)| is_noise(likely)).map(|(likely, outcome)| open(likely, outcome));
        let of_noise = of_noise.fold(before.scaled - before.log_likelihood - penalty, f64::max);
        // Hysteresis fits better than a cubic part even for a hardening spring, although it does not harden.
        let hardens = |softening: &Outcome| {
            tried().any(|(likely, outcome)| {
                likely.sign.is_some()
                    && outcome.learnt > SIGNIFICANT
                    && outcome.achieved - before.log_likelihood - penalty * likely.fitted > WORTH
                    && (outcome.is_good() || !softening.is_good())
            })
        };
        // Another plant begins with another guess: where that alone is enough, the plant was right.
        let is_of_guess = tried().any(|(likely, outcome)| likely.cause.key == "initial_guess" && outcome.is_good());
        let is_explained = |likely: &LikelyCause, outcome: &Outcome| {
            (likely.softens && hardens(outcome)) || (likely.renews_guess && is_of_guess)
        };
        let mut all: Vec<Ranked> = Vec::new();
        for (likely, outcome) in tried().filter(|(likely, outcome)| !is_explained(likely, outcome)) {
            let mut gain = outcome.log_likelihood - before.log_likelihood - penalty * likely.fitted;
            if let Some(own) = self.own_likelihood().filter(|_| likely.cause.key == "collapsed_sample") {
                gain = before.log_likelihood - own;
            }
            let is_worth = likely.certain || gain > WORTH;
            if !is_worth {
                continue;
            }
            let open = open(likely, outcome);
            let is_beyond = !is_noise(likely) && open > of_noise + BEYOND;
            let rank = if is_beyond { gain.max(open) } else { gain };
            let achieved = outcome.achieved - before.log_likelihood - penalty * likely.fitted;
            let mut likely = likely.clone();
            if let Some(sign) = likely.sign.filter(|_| outcome.learnt.abs() > SIGNIFICANT) {
                let sentence = if outcome.learnt > 0.0 { sign.positive } else { sign.negative };
                likely.sentence = sentence.to_owned();
            }
            let edits = likely.edits.clone();
            let remedy = Remedy { first: likely, then: Vec::new(), edits, gain, after: outcome.verdict.clone() };
            let ranked = Ranked { remedy, rank, achieved };
            let key = ranked.remedy.first.cause.key;
            match all.iter_mut().find(|other| other.remedy.first.cause.key == key) {
                Some(other) if compare((&ranked.remedy, rank), (&other.remedy, other.rank)).is_le() => {}
                Some(other) => *other = ranked,
                None => all.push(ranked),
            }
        }
        all.sort_by(|a, b| compare((&b.remedy, b.rank), (&a.remedy, a.rank)));
        all
    }
}

/// The order of two remedies with their ranks, the later one first.
pub(super) fn compare(one: (&Remedy, f64), other: (&Remedy, f64)) -> std::cmp::Ordering {
    // A remedy that ends in a good verdict comes before one that is only likelier.
    let key = |(remedy, rank): (&Remedy, f64)| (remedy.precedence(), rank, remedy.first.weight);
    key(one).partial_cmp(&key(other)).unwrap_or(std::cmp::Ordering::Equal)
}
