//! Outcomes as bits.

use kalmanscope_core::score::Outcome;

/// Every number of an outcome, bit by bit; all NaNs count as equal.
pub(crate) fn bits(outcome: &Outcome) -> (Vec<u64>, String) {
    let Outcome { samples, nees, nis, log_likelihood, stop, diverged, channels, mean, std, looks } = outcome;
    let mut numbers = vec![nees.sum, nis.sum, *log_likelihood];
    numbers.extend(mean.iter().chain(std));
    for (_, score) in channels {
        numbers.extend([score.error, score.std, score.rmse, score.coverage]);
    }
    for look in looks {
        numbers.extend([look.nees, look.nis]);
        numbers.extend(look.channels.as_flattened());
    }
    let settled: Vec<_> = channels.iter().map(|(channel, score)| (channel.key(), score.settled)).collect();
    let counts = [nees.degrees, nees.samples, nis.degrees, nis.samples];
    let rest = format!("{samples} {counts:?} {stop:?} {diverged} {settled:?}");
    (numbers.iter().map(|x| if x.is_nan() { u64::MAX } else { x.to_bits() }).collect(), rest)
}
