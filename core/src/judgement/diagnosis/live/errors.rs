//! The errors of each channel with a known truth, granule by granule.

use std::ops::Range;

use super::granule::{AFTER, GRANULE, first_in, pieces, samples_of};
use super::series::Series;
use crate::judgement::diagnosis::errors::{ChannelErrors, Sums};
use crate::judgement::diagnosis::lagged::product;
use crate::judgement::diagnosis::parts::{self, PARTS};
use crate::{Channel, Estimates, Record};

/// The errors of all channels.
#[derive(Debug)]
pub(super) struct LiveErrors {
    channels: Vec<LiveChannel>,
}

/// The errors of one channel.
#[derive(Debug)]
struct LiveChannel {
    channel: Channel,
    place: usize,
    granules: Series<Stretch>,
}

/// The sums of some successive samples, with the first and the last known error.
#[derive(Clone, Copy, Debug)]
struct Stretch {
    sums: Sums,
    first: f64,
    last: f64,
}

/// The numbers of one channel from which its errors follow, of kept samples.
#[derive(Clone, Copy)]
struct Columns<'a> {
    means: &'a [f64],
    truth: &'a [f64],
    variances: &'a [f64],
}

impl LiveErrors {
    /// The channels with a truth in the record, before the sample `start`.
    pub(super) fn new(estimates: &Estimates, record: &Record, start: usize) -> Self {
        let all = estimates.channels().iter().enumerate();
        let known = all.filter(|(_, channel)| record.truth(**channel).is_some());
        let granules = Series::starting_at(first_in(start));
        let one = |(place, &channel)| LiveChannel { channel, place, granules: granules.clone() };
        Self { channels: known.map(one).collect() }
    }

    /// Takes in the new granules of a window, and forgets those before it.
    pub(super) fn follow(&mut self, window: &Range<usize>, estimates: &Estimates, record: &Record) {
        for LiveChannel { channel, place, granules } in &mut self.channels {
            let Some(columns) = Columns::of(*place, *channel, estimates, record) else { continue };
            granules.skip_to(first_in(window.start));
            while (granules.end() + 1) * GRANULE + AFTER <= window.end {
                granules.push(columns.stretch(&samples_of(granules.end()), record.forgotten()));
            }
            granules.forget_before(window.start / GRANULE);
        }
    }

    /// The errors in each part of a window that has been followed.
    pub(super) fn by_part(&self, window: &Range<usize>, estimates: &Estimates, record: &Record) -> Vec<ChannelErrors> {
        let one = |of: &LiveChannel| {
            let columns = Columns::of(of.place, of.channel, estimates, record)?;
            let mut by_part = [Sums::default(); PARTS];
            let mut before = 0.0;
            for (part, sums) in by_part.iter_mut().enumerate() {
                for piece in pieces(&parts::range(part, window), window) {
                    match piece.granule {
                        Some(number) => of.granules.at(number).add_to(sums, &mut before),
                        None => columns.stretch(&piece.samples, record.forgotten()).add_to(sums, &mut before),
                    }
                }
            }
            let any = by_part.iter().any(|sums| sums.count > 0.0);
            any.then_some(ChannelErrors { channel: of.channel, by_part })
        };
        self.channels.iter().filter_map(one).collect()
    }
}

impl<'a> Columns<'a> {
    fn of(place: usize, channel: Channel, estimates: &'a Estimates, record: &'a Record) -> Option<Self> {
        let truth = record.truth(channel)?;
        Some(Self { means: estimates.canonical_means(place), truth, variances: estimates.variances(place) })
    }

    /// The sums of the samples with these numbers, at most a granule of them; the first sample that is kept has the number
    /// `kept`.
    fn stretch(&self, samples: &Range<usize>, kept: usize) -> Stretch {
        let samples = samples.start - kept..samples.end - kept;
        let [means, truth, variances] = [self.means, self.truth, self.variances].map(|all| &all[samples.clone()]);
        // First all errors, so that the compiler can vectorise over them.
        let mut errors = [0.0; GRANULE];
        for (((error, mean), truth), variance) in errors.iter_mut().zip(means).zip(truth).zip(variances) {
            *error = (mean - truth) / variance.sqrt();
        }
        let errors = &errors[..samples.len()];
        let known =
            errors.iter().zip(variances).map(|(error, variance)| u32::from(!error.is_nan() & (*variance != 0.0)));
        match known.sum::<u32>() as usize == samples.len() {
            true => Stretch::of_known(errors),
            false => Stretch::of_any(errors, variances),
        }
    }
}

impl Stretch {
    /// The sums of some known errors, at least one.
    fn of_known(errors: &[f64]) -> Self {
        let sums = Sums {
            count: errors.len() as f64,
            square: product(errors, errors),
            product: product(&errors[1..], &errors[..errors.len() - 1]),
            inside: f64::from(errors.iter().map(|error| u32::from(error.abs() <= 2.0)).sum::<u32>()),
        };
        Self { sums, first: errors[0], last: errors[errors.len() - 1] }
    }

    /// The sums of the errors that are known.
    fn of_any(errors: &[f64], variances: &[f64]) -> Self {
        let (mut sums, mut first, mut last) = (Sums::default(), 0.0, 0.0);
        for (&error, &variance) in errors.iter().zip(variances) {
            let is_first = sums.count == 0.0;
            sums.take_in(error, variance, &mut last);
            if is_first {
                (first, sums.product) = (last, 0.0);
            }
        }
        Self { sums, first, last }
    }

    /// Adds itself to the sums of the samples before it. `before` is their last known error.
    fn add_to(&self, sums: &mut Sums, before: &mut f64) {
        if self.sums.count == 0.0 {
            return;
        }
        let Sums { count, square, product, inside } = self.sums;
        sums.count += count;
        sums.square += square;
        sums.product += product + self.first * *before;
        sums.inside += inside;
        *before = self.last;
    }
}
