//! Whether the particles of a particle filter still represent a belief.

use crate::judgement::diagnosis::case::Case;
use crate::judgement::diagnosis::evidence::{Evidence, Subject, Test};
use crate::judgement::words::{percent, short};
use crate::{Channel, VerdictKind};

/// Limits the fall of σ from one sample to the next.
const FALL: f64 = 100.0;

const FEWEST: f64 = 2.0;

/// Limits the successive measurements with an effective sample size below [`FEWEST`].
const A_WHILE: usize = 10;

pub(super) static SAMPLE: Test = Test {
    name: "the sample of particles",
    statistic: "the largest fall of a σ from one sample to the next; the least effective sample size",
    distribution: "none",
    source: "Kong, Liu and Wong (1994), Sequential imputations and Bayesian missing data problems",
    reading: "a fall by more than 100, or less than 2 particles for a while: one particle stands for all, and σ says nothing",
    run: sample,
};

fn sample(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    if case.estimates.effective_samples().is_empty() {
        return;
    }
    let sizes = &case.estimates.effective_samples()[case.samples.clone()];
    let fall_of = |(place, channel): (usize, &Channel)| {
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
        let one =
            Evidence::new(test, Subject::Channel(channel), case).certain(VerdictKind::Collapsed, fall / FALL, sentence);
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
    let one = Evidence::new(test, Subject::All, case).certain(
        VerdictKind::Collapsed,
        f64::from(longest) / A_WHILE as f64,
        sentence,
    );
    found.push(Evidence { statistic: least, ..one });
}

/// Limits the share of the shrinking that resampling alone explains.
const SHARE: f64 = 0.25;

/// Limits the factor on σ that resampling alone explains.
const TIMES: f64 = 3.0;

/// Limits the relative loss of a variance in one sample.
const MOST: f64 = 1.0 - 1e-6;

pub(super) static DIVERSITY: Test = Test {
    name: "diversity of the particles",
    statistic: "D = Σ -½ ln(1 - 1/N_eff) over all resamplings, as a share of D + Σ -½ ln(1 - K S Kᵀ / P) over all updates",
    distribution: "none: D is 0 for infinitely many particles",
    source: "Kong, Liu and Wong (1994), Sequential imputations and Bayesian missing data problems; Liu and West (2001)",
    reading: "a sample of N_eff particles has, on average, 1/N_eff less variance than what it is drawn from; where these losses \
              explain a quarter of how σ has shrunk, it says how few particles are left and not what is known",
    run: diversity,
};

fn diversity(case: &Case<'_>, test: &'static Test, found: &mut Vec<Evidence>) {
    let estimates = case.estimates;
    if estimates.effective_samples().is_empty() {
        return;
    }
    let resamples = |size: &&f64| **size < 0.5 * estimates.particles() as f64;
    let sizes = &estimates.effective_samples()[case.samples.clone()];
    let lost: f64 = sizes.iter().filter(resamples).map(|size| shrinks_by(1.0 / size)).sum();
    for (place, &channel) in estimates.channels().iter().enumerate().filter(|(_, c)| c.is_parameter()) {
        let told: f64 = (case.samples.start + 1..case.samples.end).map(|k| shrinks_by(told(case, k, place))).sum();
        let share = lost / (lost + told);
        if share.is_nan() {
            continue;
        }
        let times = libm::exp(lost.min(700.0));
        let sentence = format!(
            "resampling alone makes σ of the {} {} times smaller, {} of all its shrinking",
            channel.name(),
            short(times),
            percent(share)
        );
        let effect = (share / SHARE).min(lost / libm::log(TIMES));
        let one =
            Evidence::new(test, Subject::Channel(channel), case).certain(VerdictKind::Collapsed, effect, sentence);
        found.push(Evidence { statistic: share, ..one });
    }
}

/// The share by which the measurements of sample `k` reduce the variance of the channel at `place`: K S Kᵀ / P.
fn told(case: &Case<'_>, k: usize, place: usize) -> f64 {
    let (n, m) = (case.estimates.channels().len(), case.estimates.sensors().len());
    let (gain, cov) = (case.estimates.gain(k), case.estimates.innovation_cov(k));
    let innovation = case.estimates.innovation(k);
    let of = |i: usize| if innovation[i].is_nan() { 0.0 } else { gain[i * n + place] };
    let mut taken = 0.0;
    for i in (0..m).filter(|&i| of(i) != 0.0) {
        for j in (0..m).filter(|&j| of(j) != 0.0) {
            taken += of(i) * cov[i * m + j] * of(j);
        }
    }
    let variance = case.estimates.variances(place)[k - 1];
    if taken > 0.0 { taken / variance } else { 0.0 }
}

/// The decrease of ln σ if the variance loses this share.
fn shrinks_by(share: f64) -> f64 {
    -0.5 * libm::log(1.0 - share.min(MOST))
}
