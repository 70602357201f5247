//! The curves, computed again when their inputs have changed.

use std::sync::Arc;

use egui::{Id, Ui};
use kalmanscope_core::frequency_response::{Believed, believed, transfer_function, true_transfer_function};
use kalmanscope_core::{Estimates, Spectrum};

use crate::plot::cache::cached;
use crate::session::Session;

/// Number of frequencies of a curve: enough for a peak of one per cent's width.
const POINTS: usize = 385;
/// Frequencies of a curve per frequency of the spectrum, whose windows cannot resolve sharper peaks.
const COARSER: usize = 2;
const BEYOND: f64 = 4.0;
/// Margin beyond round numbers, so that the last ticks' texts are not cut off, as a ratio.
const ROOM: f64 = 1.15;
/// Limits the windows of the spectrum, as a share of the whole record.
const LONGEST: f64 = 2.0 / 3.0;

/// The curves over `frequencies` \[rad/s\].
pub(super) struct ResponseCurves {
    pub(super) frequencies: Vec<f64>,
    /// |H| of the truth \[s²\], if it is known.
    pub(super) truth: Option<Vec<f64>>,
    /// The response of each filter with its band; `None` for a filter without estimates.
    pub(super) filters: Vec<Option<Arc<Believed>>>,
    /// Frequencies \[rad/s\] and square root of the force's density, scaled to a maximum of 1; `None` without a force.
    pub(super) spectrum: Option<Vec<(f64, f64)>>,
}

impl ResponseCurves {
    pub(super) fn at(ui: &Ui, session: &Session, k: usize, is_shown: impl Fn(u32) -> bool) -> Self {
        let (run, (low, high)) = (session.run(), range(session));
        let ratio = |i: usize| (high / low).powf(i as f64 / (POINTS - 1) as f64);
        let frequencies: Vec<f64> = (0..POINTS).map(|i| low * ratio(i)).collect();
        let of_filter = |estimates: &Estimates| {
            let k = k.min(estimates.len().checked_sub(1)?);
            // The belief itself is the key: while it stands still, its band is not computed again.
            let numbers = estimates.mean(k).iter().chain(estimates.cov(k)).chain([&low, &high]);
            let numbers: Vec<u64> = numbers.map(|number| number.to_bits()).collect();
            let of = (numbers, format!("{:?}", estimates.plant));
            let id = Id::unique(("frequency response", estimates.id()));
            let make = || Some(believed(estimates, k, &frequencies));
            is_shown(estimates.id()).then(|| cached(ui.ctx(), id, of, make))
        };
        let truth = true_transfer_function(&run.scenario().plant.kind, run.record(), k);
        let spectrum = |force: &mut ForceSpectrum| force.spectrum(session, &frequencies);
        Self {
            truth: truth.map(|truth| truth.magnitude(&frequencies)),
            filters: run.estimates().iter().map(of_filter).collect(),
            spectrum: ui.data_mut(|data| spectrum(data.get_temp_mut_or_default(Id::unique("spectrum of the force")))),
            frequencies,
        }
    }
}

#[derive(Clone, Default)]
struct ForceSpectrum {
    taken: Vec<f64>,
    /// Time between samples and longest window \[s\], and the ends of the frequencies \[rad/s\].
    of: [f64; 4],
    spectrum: Option<Spectrum>,
}

impl ForceSpectrum {
    fn spectrum(&mut self, session: &Session, frequencies: &[f64]) -> Option<Vec<(f64, f64)>> {
        let Self { taken, of, spectrum } = self;
        let run = session.run();
        let [low, .., high] = *frequencies else { return None };
        let now = [run.record().dt(), LONGEST * session.end(), low, high];
        let force = &run.record().input()[..run.len()];
        // While a record grows only its new samples are taken in; another force begins again.
        let follows = *of == now && force.starts_with(taken);
        let spectrum = match spectrum {
            Some(spectrum) if follows => spectrum,
            _ => {
                taken.clear();
                *of = now;
                let coarser = frequencies.iter().copied().step_by(COARSER).collect();
                spectrum.insert(Spectrum::new(coarser, now[0], now[1]))
            }
        };
        let new = &force[taken.len()..];
        spectrum.extend(new);
        taken.extend_from_slice(new);
        let density = spectrum.density();
        let most = density.iter().copied().fold(0.0, f64::max);
        let height = |(&w, density): (&f64, f64)| (w, (density / most).sqrt());
        (most > 0.0 && most.is_finite()).then(|| spectrum.frequencies.iter().zip(density).map(height).collect())
    }
}

/// Around the natural frequencies at the first sample, so that the axis is constant; below Nyquist's \[rad/s\].
fn range(session: &Session) -> (f64, f64) {
    let run = session.run();
    let truth = true_transfer_function(&run.scenario().plant.kind, run.record(), 0);
    let of_filter = |estimates: &Estimates| {
        let first = (!estimates.is_empty()).then(|| estimates.mean(0))?;
        let value = |channel| estimates.place(channel).map_or(0.0, |place| first[place]);
        transfer_function(&estimates.plant, value).natural_span()
    };
    let filters = || run.estimates().iter().filter_map(of_filter).reduce(|a, b| (a.0.min(b.0), a.1.max(b.1)));
    let (least, most) = truth.and_then(|truth| truth.natural_span()).or_else(filters).unwrap_or((1.0, 10.0));
    let nyquist = std::f64::consts::PI / run.record().dt();
    let high = (ROOM * round_up(BEYOND * most)).min(nyquist);
    ((round_down(least / BEYOND) / ROOM).min(0.1 * high), high)
}

fn round_down(x: f64) -> f64 {
    let power = 10_f64.powf(x.log10().floor());
    // Rounding may give a power above x.
    [5.0, 2.0, 1.0].into_iter().map(|digit| digit * power).find(|y| *y <= x).unwrap_or(power)
}

fn round_up(x: f64) -> f64 {
    1.0 / round_down(1.0 / x)
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::Scenario;

    use super::*;
    use crate::session::Mode;

    fn session() -> Session {
        let mut session = Session::new(Scenario { duration: 6.0, ..Scenario::default() }).unwrap();
        session.set_mode(Mode::Whole);
        session
    }

    #[test]
    fn the_axis_holds_the_natural_frequencies_and_ends_at_round_numbers_or_nyquist() {
        assert_eq!((round_down(1.5), round_down(0.07), round_up(24.0), round_up(50.1)), (1.0, 0.05, 50.0, 100.0));
        assert_eq!(range(&session()), (1.0 / ROOM, 50.0 * ROOM));
        let coarse = Scenario { dt: 0.2, duration: 20.0, ..Scenario::default() };
        assert_eq!(range(&Session::new(coarse).unwrap()), (1.0 / ROOM, std::f64::consts::PI / 0.2));
    }

    #[test]
    fn the_spectrum_is_that_of_the_force_so_far_however_one_came_there() {
        let (mut session, mut force, frequencies) = (session(), ForceSpectrum::default(), [1.0, 7.0, 50.0]);
        let whole = force.spectrum(&session, &frequencies);
        session.seek(0.0);
        session.set_mode(Mode::Live);
        assert_ne!(force.spectrum(&session, &frequencies), whole);
        for _ in 0..700 {
            session.step();
            force.spectrum(&session, &frequencies);
        }
        assert_eq!(force.spectrum(&session, &frequencies), whole);
        let mut silent = session.scenario().clone();
        silent.force = kalmanscope_core::Force::None;
        session.set_scenario(silent);
        assert_eq!(force.spectrum(&session, &frequencies), None);
    }
}
