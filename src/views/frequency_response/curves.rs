//! The curves, computed again when their inputs have changed.

use std::sync::Arc;

use egui::{Id, Ui};
use kalmanscope_core::frequency_response::{
    Believed, TransferFunction, believed, transfer_function, true_transfer_function,
};
use kalmanscope_core::{Estimates, PlantKind, Spectrum};

use crate::session::Session;

/// Number of frequencies of a curve: enough for a peak of one per cent's width.
const POINTS: usize = 385;
/// The number of a curve's frequencies per frequency of the spectrum. The spectrum's windows cannot resolve sharper
/// peaks.
const COARSER: usize = 2;
const BEYOND: f64 = 4.0;
/// Margin beyond round numbers, so that the last ticks' texts are not cut off, as a ratio.
const ROOM: f64 = 1.15;
/// Limits the windows of the spectrum, as a share of the whole record.
const LONGEST: f64 = 2.0 / 3.0;

/// The curves over `frequencies` \[rad/s\].
pub(super) struct Curves {
    pub(super) frequencies: Arc<[f64]>,
    /// |H| of the truth \[s²\], if it is known.
    pub(super) truth: Option<Arc<[f64]>>,
    /// The response of each filter with its band; `None` for a filter without estimates.
    pub(super) filters: Vec<Option<Arc<Believed>>>,
    /// Frequencies \[rad/s\] and square root of the force's density, scaled to a maximum of 1; empty without a force.
    pub(super) spectrum: Option<Vec<(f64, f64)>>,
}

impl Curves {
    /// The curves at sample `k` for the filters that are shown; unchanged ones come from `ui`'s memory.
    pub(super) fn at(ui: &Ui, session: &Session, k: usize, is_shown: impl Fn(u32) -> bool) -> Self {
        let range = range(session);
        ui.data_mut(|data| {
            let memory: &mut Memory = data.get_temp_mut_or_default(Id::unique("frequency response"));
            if memory.range != Some(range) {
                *memory = Memory::over(range);
            }
            memory.curves(session, k, is_shown)
        })
    }
}

#[derive(Clone, Default)]
struct Memory {
    range: Option<(f64, f64)>,
    frequencies: Arc<[f64]>,
    truth: Cached<TransferFunction, [f64]>,
    filters: Vec<Cached<Belief, Believed>>,
    force: Force,
}

impl Memory {
    fn over((low, high): (f64, f64)) -> Self {
        let ratio = |i: usize| (high / low).powf(i as f64 / (POINTS - 1) as f64);
        Self { range: Some((low, high)), frequencies: (0..POINTS).map(|i| low * ratio(i)).collect(), ..Self::default() }
    }

    fn curves(&mut self, session: &Session, k: usize, is_shown: impl Fn(u32) -> bool) -> Curves {
        let Self { range: _, frequencies, truth, filters, force } = self;
        let run = session.run();
        filters.resize_with(run.estimates().len(), Cached::default);
        let of_filter = |(estimates, cached): (&Estimates, &mut Cached<_, _>)| {
            let k = k.min(estimates.len().checked_sub(1)?);
            let make = || Arc::new(believed(estimates, k, frequencies));
            is_shown(estimates.id()).then(|| cached.get(Belief::new(estimates, k), make))
        };
        let truth_now = true_transfer_function(&run.scenario().plant.kind, run.record(), k);
        Curves {
            frequencies: frequencies.clone(),
            truth: truth_now.map(|now| truth.get(now.clone(), || now.magnitude(frequencies).into())),
            filters: run.estimates().iter().zip(filters).map(of_filter).collect(),
            spectrum: force.spectrum(session, frequencies),
        }
    }
}

struct Cached<K, V: ?Sized>(Option<(K, Arc<V>)>);

impl<K, V: ?Sized> Default for Cached<K, V> {
    fn default() -> Self {
        Self(None)
    }
}

impl<K: Clone, V: ?Sized> Clone for Cached<K, V> {
    fn clone(&self) -> Self {
        Self(self.0.clone())
    }
}

impl<K: PartialEq, V: ?Sized> Cached<K, V> {
    fn get(&mut self, key: K, make: impl FnOnce() -> Arc<V>) -> Arc<V> {
        match &self.0 {
            Some((known, value)) if *known == key => value.clone(),
            _ => self.0.insert((key, make())).1.clone(),
        }
    }
}

#[derive(Clone, PartialEq)]
struct Belief {
    plant: PlantKind,
    mean: Vec<f64>,
    cov: Vec<f64>,
}

impl Belief {
    fn new(estimates: &Estimates, k: usize) -> Self {
        Self { plant: estimates.plant().clone(), mean: estimates.mean(k).to_vec(), cov: estimates.cov(k).to_vec() }
    }
}

#[derive(Clone, Default)]
struct Force {
    taken: Vec<f64>,
    /// Time between samples and longest window \[s\].
    times: (f64, f64),
    spectrum: Option<Spectrum>,
}

impl Force {
    fn spectrum(&mut self, session: &Session, frequencies: &[f64]) -> Option<Vec<(f64, f64)>> {
        let Self { taken, times, spectrum } = self;
        let run = session.run();
        let now = (run.record().dt(), LONGEST * session.end());
        let force = &run.record().input()[..run.len()];
        let follows = *times == now && force.starts_with(taken);
        let spectrum = match spectrum {
            Some(spectrum) if follows => spectrum,
            _ => {
                taken.clear();
                *times = now;
                let coarser = frequencies.iter().copied().step_by(COARSER).collect();
                spectrum.insert(Spectrum::new(coarser, now.0, now.1))
            }
        };
        let new = &force[taken.len()..];
        spectrum.extend(new);
        taken.extend_from_slice(new);
        let density = spectrum.density();
        let most = density.iter().copied().fold(0.0, f64::max);
        let height = |(&w, density): (&f64, f64)| (w, (density / most).sqrt());
        (most > 0.0 && most.is_finite()).then(|| spectrum.frequencies().iter().zip(density).map(height).collect())
    }
}

/// The frequencies of the curves \[rad/s\]: those around the natural frequencies at the first sample, so that the axis
/// is constant, and below the Nyquist frequency.
fn range(session: &Session) -> (f64, f64) {
    let run = session.run();
    let truth = true_transfer_function(&run.scenario().plant.kind, run.record(), 0);
    let of_filter = |estimates: &Estimates| {
        let first = (!estimates.is_empty()).then(|| estimates.mean(0))?;
        let value = |channel| estimates.place(channel).map_or(0.0, |place| first[place]);
        transfer_function(estimates.plant(), value).natural_span()
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

    fn curves_of(memory: &mut Memory, session: &Session, k: usize) -> Curves {
        memory.curves(session, k, |_| true)
    }

    #[test]
    fn the_axis_holds_the_natural_frequencies_and_ends_at_round_numbers_or_nyquist() {
        assert_eq!((round_down(1.5), round_down(0.07), round_up(24.0), round_up(50.1)), (1.0, 0.05, 50.0, 100.0));
        assert_eq!(range(&session()), (1.0 / ROOM, 50.0 * ROOM));
        let coarse = Scenario { dt: 0.2, duration: 20.0, ..Scenario::default() };
        assert_eq!(range(&Session::new(coarse).unwrap()), (1.0 / ROOM, std::f64::consts::PI / 0.2));
    }

    #[test]
    fn what_has_not_changed_is_not_computed_again() {
        let (mut session, mut memory) = (session(), Memory::over((1.0, 50.0)));
        let same = |a: &Curves, b: &Curves, place: usize| {
            Arc::ptr_eq(a.filters[place].as_ref().unwrap(), b.filters[place].as_ref().unwrap())
        };
        let before = curves_of(&mut memory, &session, 200);
        let after = curves_of(&mut memory, &session, 200);
        assert!(same(&before, &after, 0) && same(&before, &after, 1));
        assert!(Arc::ptr_eq(&before.truth.unwrap(), after.truth.as_ref().unwrap()));
        let mut edited = session.scenario().clone();
        edited.filters[1].fading = 1.02;
        session.set_scenario(edited);
        let edited = curves_of(&mut memory, &session, 200);
        assert!(same(&after, &edited, 0) && !same(&after, &edited, 1));
        assert!(!same(&edited, &curves_of(&mut memory, &session, 201), 0));
    }

    #[test]
    fn the_spectrum_is_that_of_the_force_so_far_however_one_came_there() {
        let (mut session, mut memory) = (session(), Memory::over((1.0, 50.0)));
        let whole = curves_of(&mut memory, &session, 0).spectrum;
        session.seek(0.0);
        session.set_mode(Mode::Live);
        let early = curves_of(&mut memory, &session, 0).spectrum;
        assert_ne!(early, whole);
        for _ in 0..700 {
            session.step();
            curves_of(&mut memory, &session, 0);
        }
        assert_eq!(curves_of(&mut memory, &session, 0).spectrum, whole);
        let mut silent = session.scenario().clone();
        silent.force = kalmanscope_core::Force::None;
        session.set_scenario(silent);
        assert_eq!(curves_of(&mut memory, &session, 0).spectrum, None);
    }
}
