//! The spectra of the first sensor before and after the conditioning.

use egui::{Color32, Ui};
use egui_plot::{Legend, Line, Plot};
use kalmanscope_core::import::{Builder, Mapping};
use kalmanscope_core::{Record, Task as _, Windows};

use super::{Choices, Shared};
use crate::theme::Palette;
use crate::widgets::named;

/// The windows side by side in a record, at least: more make a smoother spectrum, longer ones a finer one.
const COUNT: usize = 4;

/// Both spectra, in the making: frequency \[Hz\], and density in dB below the highest before the conditioning.
pub(super) struct Spectra {
    plain: Option<Builder<'static>>,
    windows: [Option<Windows>; 2],
    curves: [Vec<[f64; 2]>; 2],
}

impl Spectra {
    pub(super) fn new(table: Shared, (mapping, kind, hold): &Choices, record: &Record) -> Option<Self> {
        if mapping.band.is_none() && mapping.every == 1 {
            return None;
        }
        let sensors = mapping.sensors.iter().take(1).map(|(quantity, mapped)| (*quantity, mapped.clone()));
        let plain = Mapping {
            band: None,
            every: 1,
            interpolate: 1,
            input: None,
            sensors: sensors.collect(),
            ..mapping.clone()
        };
        Some(Self {
            plain: Some(Builder::new(table, &plain, *kind, *hold).ok()?),
            windows: [None, Some(Windows::new(record, 0, record.len(), COUNT)?)],
            curves: [Vec::new(), Vec::new()],
        })
    }

    /// Continues until `while_time` returns false.
    pub(super) fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) {
        let Self { plain, windows, curves } = self;
        if let Some(mut builder) = plain.take() {
            match builder.advance(while_time) {
                Ok(false) => return *plain = Some(builder),
                Ok(true) => {
                    let made = builder.finish().ok();
                    windows[0] = made.and_then(|made| Windows::new(&made.record, 0, made.record.len(), COUNT));
                    return;
                }
                Err(_) => return *windows = [None, None],
            }
        }
        for windows in windows.iter_mut().flatten() {
            if !windows.advance(while_time) {
                return;
            }
        }
        let densities = std::mem::take(windows).map(|windows| windows.map_or_else(Vec::new, |w| w.density()));
        let highest = densities[0].iter().map(|[_, density]| *density).fold(f64::MIN_POSITIVE, f64::max);
        let decibels = |[hertz, density]: [f64; 2]| [hertz, 10.0 * (density / highest).max(1e-12).log10()];
        *curves = densities.map(|density| density.into_iter().map(decibels).collect());
    }

    pub(super) fn is_behind(&self) -> bool {
        self.plain.is_some() || self.windows.iter().any(Option::is_some)
    }

    #[cfg(test)]
    pub(super) fn curves(&self) -> &[Vec<[f64; 2]>; 2] {
        &self.curves
    }

    pub(super) fn ui(&self, ui: &mut Ui, palette: &Palette) {
        let line = |name: &str, points: &[[f64; 2]], color: Color32| {
            Line::new(name.to_owned(), points.to_vec()).color(color).width(1.5)
        };
        let plot = Plot::new("spectra of the import").height(110.0).legend(Legend::default()).show_grid(true);
        let plot = plot
            .x_axis_label("frequency [Hz]")
            .y_axis_label("power [dB]")
            .allow_scroll(false)
            .allow_drag(false)
            .allow_zoom(false);
        let [before, after] = &self.curves;
        let response = plot.show(ui, |plot| {
            plot.line(line("before", before, palette.weak));
            plot.line(line("after", after, palette.truth));
        });
        named(response.response, "Plot of the spectrum before and after");
    }
}
