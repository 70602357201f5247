//! Parameters that change, a guess that is far off, and a record without information on them.

use kalmanscope_core::internals::mapped;
use kalmanscope_core::setting::Edit;
use kalmanscope_core::{Channel, Quantity};

use super::{BadFilter, Cause, LikelyCause};
use crate::VerdictKind;
use crate::case::normal_tail;
use crate::words::{percent, short};

/// Limits the correlation at lag 1 of readings that are only noise.
const WHITE: f64 = 0.3;

/// Limits the mean square of readings that are only noise, over R.
const NOISE: f64 = 1.5;

pub(super) static NO_EXCITATION: Cause = Cause {
    key: "no_excitation",
    name: "too little excitation",
    hint: "A filter learns parameters from motion. Shake the oscillator near its resonance; until then, set λ = 1.",
    likely_causes: |bad, cause, found| {
        let of = [VerdictKind::NotIdentifiable, VerdictKind::WoundUp];
        let still = is_still(bad);
        let weight = bad.effect_of(|one| of.contains(&one.speaks_for)).max(if still { 0.8 } else { 0.0 });
        if weight == 0.0 {
            return;
        }
        let samples =
            bad.evidence.iter().find(|one| one.counts && of.contains(&one.speaks_for)).map(|one| one.samples.clone());
        let sentence = "the motion is too small, compared with the noise, to show the parameters".to_owned();
        let likely = LikelyCause::new(cause, 0.9 * weight, 0.0, Vec::new(), sentence);
        found.push(LikelyCause { certain: true, samples, ..likely });
    },
};

/// Whether readings are white, and of the size R: those of an accelerometer under a broadband force are white, but larger.
fn is_still(bad: &BadFilter<'_>) -> bool {
    let is_noise = |sensor: Quantity| {
        let Some(values) = bad.case.record.measured_quantity(sensor) else { return true };
        // A sensor that reads at few of the samples is compared from reading to reading.
        let read: Vec<f64> = values.iter().copied().filter(|x| !x.is_nan()).collect();
        let (product, square, count) = read.windows(2).fold((0.0, 0.0, 0_u32), |(product, square, count), pair| {
            (product + pair[0] * pair[1], square + pair[0] * pair[0], count + 1)
        });
        let place = bad.scenario.sensor_place(sensor);
        let std = place.and_then(|place| bad.filter.sensor_std.get(place));
        let is_small = std.is_none_or(|std| square <= NOISE * std * std * f64::from(count));
        square <= 0.0 || (product < WHITE * square && is_small)
    };
    let mut sensors = bad.case.sensors.iter().peekable();
    sensors.peek().is_some() && sensors.all(|one| is_noise(one.sensor))
}

// A slow drift rises by 1.1 where it rises most, and was taken for a sudden change.
const RISE: f64 = 1.3;

/// The weight of fading relative to a jump: it forgets what was before the change too; λ = 1.005 doubled all errors.
const FADES: f64 = 0.9;

pub(super) static SUDDEN_CHANGE: Cause = Cause {
    key: "sudden_change",
    name: "a sudden change",
    hint: "A parameter changed suddenly, and a filter that is sure of its parameters does not follow. Let it widen P \
           once, when its innovations jump, or let it forget (fading factor).",
    likely_causes: sudden_change,
};

fn sudden_change(bad: &BadFilter<'_>, cause: &'static Cause, found: &mut Vec<LikelyCause>) {
    let case = bad.case;
    let change = change_point(&case.estimates.nis()[case.samples.clone()]);
    let is_one = |change: &ParameterChange| change.rise >= RISE && change.p_value < 1e-4;
    let Some(ParameterChange { at, rise, p_value }) = change.filter(is_one) else { return };
    let at = case.samples.start + at;
    let samples = at..case.samples.end;
    let time = short(case.record.time(at));
    let chance = if p_value > 0.0 { format!(" (p = {p_value:.0e})") } else { String::new() };
    let weight = 1.0 - 1.0 / rise;
    let jump = (!bad.filter.jump).then(|| bad.edit("jump", true));
    let fading = [1.005, 1.02].into_iter().filter(|fading| *fading > bad.filter.fading);
    let fading = fading.map(|fading| (FADES, bad.edit("fading", fading)));
    for (share, edit) in jump.map(|jump| (1.0, jump)).into_iter().chain(fading) {
        let sentence =
            format!("something changed near {time} s: innovations² are {} times larger after it{chance}", short(rise));
        let likely = LikelyCause::new(cause, share * weight, 2.0, vec![edit], sentence);
        found.push(LikelyCause { samples: Some(samples.clone()), begins_anew: true, ..likely });
    }
}

pub(super) static SLOW_DRIFT: Cause = Cause {
    key: "slow_drift",
    name: "a slow drift, or Q of the parameters",
    hint: "The parameters change, but the filter assumes that they are constant. Give them process noise.",
    likely_causes: |bad, cause, found| {
        // Tries all parameters together, and each alone: a random walk of a constant parameter only adds to its error.
        let case = bad.case;
        let own = |channel: &Channel| channel.is_parameter() && !channel.is_augmentation();
        let all: Vec<(usize, Channel)> =
            case.estimates.channels().iter().copied().enumerate().filter(|(_, c)| own(c)).collect();
        let mut propose = |parameters: &[(usize, Channel)], told: &str| {
            for walk in [0.05, 0.3] {
                let edits: Vec<_> = parameters.iter().filter_map(|&one| edit(bad, one, walk)).collect();
                if !edits.is_empty() {
                    let sentence = format!("{told}, by about {} over the record", percent(walk));
                    found.push(LikelyCause::new(cause, 0.3, 1.0, edits, sentence));
                }
            }
        };
        propose(&all, "the parameters drift");
        if (2..=4).contains(&all.len()) {
            for one in &all {
                propose(std::slice::from_ref(one), &format!("{} drifts", one.1.name()));
            }
        }
    },
};

fn edit(bad: &BadFilter<'_>, (place, channel): (usize, Channel), walk: f64) -> Option<Edit> {
    let (mean, doubt) = (bad.case.estimates.initial_mean(place).abs(), bad.case.estimates.initial_std(place));
    // A walk of n steps goes by √n times one. A guess of zero has its doubt as a size.
    let std = walk * mean.max(doubt) / (bad.case.len().max(2) as f64).sqrt();
    let moves = std > bad.filter.process_std[channel] && doubt > 0.0;
    moves.then(|| bad.entry("process_std", channel, std))
}

const OPEN: f64 = 0.3;

/// A guess is far off where it differs by more than this share from the measured frequency, which is spread by that share.
const FAR: f64 = 0.1;
const SPREAD: f64 = 0.2;

pub(super) static INITIAL_GUESS: Cause = Cause {
    key: "initial_guess",
    name: "an initial guess with too small a σ",
    hint: "A filter searches only near its guess. Begin with larger standard deviations, or with a better guess.",
    likely_causes: |bad, cause, found| {
        let channels = bad.case.estimates.channels();
        let doubt = |channel: &Channel| bad.filter.initial_std[*channel];
        let is_open = |channel: &&Channel| doubt(channel) > 0.0 && !bad.filter.knows(**channel);
        let wider = |one: &Channel| bad.entry("initial_std", *one, 5.0 * doubt(one));
        let edits: Vec<_> = channels.iter().filter(is_open).map(wider).collect();
        let frozen = |one: &&Channel| one.is_parameter() && doubt(one) == 0.0 && !bad.filter.knows(**one);
        let frozen: Vec<Channel> = channels.iter().filter(frozen).copied().collect();
        if !frozen.is_empty() {
            let spread = |channel: &Channel| {
                let mean = bad.filter.initial_mean[*channel].abs();
                bad.entry("initial_std", *channel, if mean > 0.0 { OPEN * mean } else { OPEN })
            };
            let names = mapped(&frozen, &|channel| channel.name()).join(" and of the ");
            let sentence = format!("σ of the {names} is 0 at first, so the filter assumes that its guess is exact");
            let edits = mapped(&frozen, &spread);
            found.push(LikelyCause::new(cause, 0.5, frozen.len() as f64, edits, sentence));
        }
        if edits.is_empty() {
            return;
        }
        let sentence = "the initial guess is far off, and its σ is too small".to_owned();
        found.push(LikelyCause::new(cause, 0.1, 1.0, edits.clone(), sentence));
        // From far off, a filter may settle elsewhere however wide it begins: then the measured motion has a better guess.
        let frequency = Channel::NATURAL_FREQUENCY;
        let is_estimated = bad.filter.initial_std[frequency] > 0.0 && !bad.filter.knows(frequency);
        let guess = bad.frequency().filter(|_| is_estimated);
        let peak = bad.measured_peak().filter(|peak| guess.is_some_and(|guess| (peak / guess - 1.0).abs() > FAR));
        if let Some(peak) = peak {
            let new = [("initial_mean", peak), ("initial_std", SPREAD * peak)]
                .map(|(table, x)| bad.entry(table, frequency, x));
            let edits = edits.into_iter().filter(|edit| edit.key != new[1].key).chain(new.clone()).collect();
            let sentence =
                format!("the initial guess is far off, and its σ is too small: the motion has {} rad/s", short(peak));
            found.push(LikelyCause::new(cause, 0.1, 2.0, edits, sentence));
        }
    },
};

/// Limits a square, so that one reading makes no change.
const LARGEST: f64 = 50.0;

/// Limits the search for a change: the shares of a record, at its beginning and end, that it leaves out.
const MARGINS: (f64, f64) = (0.15, 0.03);

/// Samples of a block. The dispersion of block means includes the correlation of successive squares.
const BLOCK: usize = 20;

/// A rise of the squares of innovations.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ParameterChange {
    /// The first sample after it.
    pub at: usize,
    /// The mean after it over that before it.
    pub rise: f64,
    /// The probability of such a rise by chance.
    pub p_value: f64,
}

/// Finds the largest likelihood of two levels of exponential squares:
/// ```text
/// least over k of k ln m₁ + (n - k) ln m₂,  m₁, m₂ the means before and after k
/// ```
/// The likelihood ratio is divided by the dispersion of the squares, so that neither their distribution nor their autocorrelation looks
/// like a change. Source: Basseville and Nikiforov (1993), *Detection of Abrupt Changes*, section 2.6; McCullagh and Nelder (1989),
/// *Generalized Linear Models*, section 9.2.
pub fn change_point(squares: &[f64]) -> Option<ParameterChange> {
    let limited = |x: &f64| if x.is_nan() { 0.0 } else { x.min(LARGEST) };
    let n = squares.len();
    let total: f64 = squares.iter().map(limited).sum();
    let mut before = 0.0;
    let mut best: Option<(f64, usize, [f64; 2])> = None;
    for (k, x) in squares.iter().enumerate() {
        let share = k as f64 / n as f64;
        if share > MARGINS.0 && share < 1.0 - MARGINS.1 && before > 0.0 {
            let (first, second) = (before / k as f64, (total - before) / (n - k) as f64);
            // The rest of a sum may round to zero or less, where there is no logarithm.
            let cost = k as f64 * libm::log(first) + (n - k) as f64 * libm::log(second.max(f64::MIN_POSITIVE));
            if second > first && best.is_none_or(|(least, ..)| cost < least) {
                best = Some((cost, k, [first, second]));
            }
        }
        before += limited(x);
    }
    let (cost, at, [first, second]) = best?;
    let dispersion = |samples: &[f64], level: f64| {
        let blocks = samples.chunks_exact(BLOCK);
        let count = blocks.len();
        let means = blocks.map(|block| block.iter().map(limited).sum::<f64>() / BLOCK as f64 / level - 1.0);
        (means.map(|x| BLOCK as f64 * x * x).sum::<f64>(), count)
    };
    let of_both = [dispersion(&squares[..at], first), dispersion(&squares[at..], second)];
    let blocks: usize = of_both.iter().map(|(_, count)| count).sum();
    // Blocks of both levels together, each about its own mean: the change itself is no dispersion.
    let dispersion = of_both.iter().map(|(sum, _)| sum).sum::<f64>() / blocks.max(1) as f64;
    let ratio = 2.0 * (n as f64 * libm::log(total / n as f64) - cost);
    // Squares that vary less than exponential numbers make no change more certain.
    let p_value = if blocks < 4 { 1.0 } else { supremum_p((ratio / dispersion.max(1.0)).sqrt()) };
    Some(ParameterChange { at, rise: second / first, p_value })
}

/// The p-value of the root of the largest likelihood ratio over all samples between the margins:
/// ```text
/// P ≈ x φ(x) (T (1 - 1/x²) + 4/x²),  T = ln((1 - h)(1 - l) / (h l)),  h, l the margins
/// ```
/// Source: Csörgő and Horváth (1997), *Limit Theorems in Change-Point Analysis*, equation 1.3.26 with one parameter.
fn supremum_p(x: f64) -> f64 {
    if x.is_nan() || x <= 1.0 {
        return 1.0;
    }
    let (h, l) = MARGINS;
    let t = libm::log((1.0 - h) * (1.0 - l) / (h * l));
    let density = libm::exp(-0.5 * x * x) / std::f64::consts::TAU.sqrt();
    // The probability is at least twice the tail at one sample.
    let both = 2.0 * normal_tail(x);
    (x * density * (t * (1.0 - 1.0 / (x * x)) + 4.0 / (x * x))).clamp(both, 1.0)
}
