//! Whether the sample of a particle filter still represents a belief.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::diagnosis::verdict_kind::VerdictKind;
use crate::judgement::diagnosis::words::short;

/// Limits the fall of σ from one sample to the next.
const FALL: f64 = 100.0;

/// The least effective sample size.
const FEWEST: f64 = 2.0;

/// Limits the successive measurements with an effective sample size below [`FEWEST`].
const A_WHILE: usize = 10;

pub(super) static TEST: Test = Test {
    name: "the sample of particles",
    statistic: "the largest fall of a σ from one sample to the next; the least effective sample size",
    distribution: "none",
    source: "Kong, Liu and Wong (1994), Sequential imputations and Bayesian missing data problems",
    reading: "a fall by more than 100, or less than 2 particles for a while: one particle stands for all, and σ says nothing",
    run,
};

fn run(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    if case.estimates.effective_samples().is_empty() {
        return;
    }
    let sizes = &case.estimates.effective_samples()[case.samples.clone()];
    let fall_of = |(place, channel): (usize, &crate::Channel)| {
        let variances = &case.estimates.variances(place)[case.samples.clone()];
        let falls = variances.windows(2).map(|pair| pair[0] / pair[1]).enumerate();
        let (k, fall) = falls.filter(|(_, fall)| !fall.is_nan()).max_by(|a, b| a.1.total_cmp(&b.1))?;
        Some((fall.sqrt(), k + 1, *channel))
    };
    let falls = case.estimates.channels().iter().enumerate().filter_map(fall_of);
    if let Some((fall, k, channel)) = falls.max_by(|a, b| a.0.total_cmp(&b.0)) {
        let at = case.samples.start + k;
        let time = short(case.record.time(at));
        let with = match sizes[k] {
            size if size.is_nan() => "where nothing is measured".to_owned(),
            size => format!("with {} particles in effect", short(size)),
        };
        let sentence = format!("σ of the {} falls by {} times at {time} s, {with}", channel.name(), short(fall));
        let evidence = Evidence::new(test, Subject::Channel(channel), case);
        let one = evidence.certain(VerdictKind::Collapsed, fall / FALL, sentence);
        found.push(Evidence { statistic: fall, samples: at..case.samples.end, ..one });
    }
    let (mut longest, mut present, mut least) = (0, 0, f64::INFINITY);
    for &size in sizes.iter().filter(|size| !size.is_nan()) {
        present = if size < FEWEST { present + 1 } else { 0 };
        longest = longest.max(present);
        least = size.min(least);
    }
    let sentence =
        format!("the effective sample size goes down to {}, and stays below 2 for {longest} samples", short(least));
    let evidence = Evidence::new(test, Subject::All, case);
    let one = evidence.certain(VerdictKind::Collapsed, f64::from(longest) / A_WHILE as f64, sentence);
    found.push(Evidence { statistic: least, ..one });
}
