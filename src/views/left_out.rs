//! Readings that robust filters leave out.

use kalmanscope_core::{Estimates, Quantity};

use crate::plot::heading::Readout;
use crate::plot::layers::Layer;
use crate::plot::series::Series;
use crate::view::ViewContext;

/// Limits the samples that are counted in a frame.
const MOST_COUNTED: usize = 20_000;

/// The filters on screen that weigh the readings of a quantity, with the place of that sensor among theirs.
fn weighing<'a>(
    quantity: Quantity,
    context: &ViewContext<'a>,
) -> impl Iterator<Item = (usize, &'a Estimates)> + use<'a> {
    let settings = &context.session.run().scenario().filters;
    context.filters().filter_map(move |(place, estimates)| {
        let is_robust = settings.get(place).is_some_and(|filter| filter.robust.is_on());
        let sensor = estimates.sensors().iter().position(|own| *own == quantity)?;
        is_robust.then_some((sensor, estimates))
    })
}

/// Whether a filter has left out the reading of a sensor at a sample. The first one counts for no filter.
fn is_left_out(estimates: &Estimates, sensor: usize, measured: &[f64], k: usize) -> bool {
    estimates.forgotten() + k > 0 && !measured[k].is_nan() && estimates.innovation(k)[sensor].is_nan()
}

/// Dots in a filter's colour at the readings of a quantity that it leaves out.
pub(super) fn layers<'a>(quantity: Quantity, measured: &'a [f64], context: &ViewContext<'a>) -> Vec<Layer<'a>> {
    let palette = context.palette;
    let layer = |(sensor, estimates): (usize, &'a Estimates)| {
        let value = move |k: usize| if is_left_out(estimates, sensor, measured, k) { measured[k] } else { f64::NAN };
        let series = Series::new(estimates.len().min(measured.len()), move |samples| samples.map(value));
        Layer::Dots { series, color: palette.shade(estimates.color()) }
    };
    weighing(quantity, context).map(layer).collect()
}

/// The share of the readings of a quantity that each filter leaves out, in words.
pub(super) fn shares(quantity: Quantity, measured: &[f64], context: &ViewContext<'_>) -> Vec<Readout> {
    let share = |(sensor, estimates): (usize, &Estimates)| {
        let len = estimates.len().min(measured.len());
        let samples = len.saturating_sub(MOST_COUNTED)..len;
        let readings = samples.clone().filter(|&k| !measured[k].is_nan()).count();
        let out = samples.filter(|&k| is_left_out(estimates, sensor, measured, k)).count();
        let percent = 100.0 * out as f64 / readings.max(1) as f64;
        let hint = format!(
            "{out} of the last {readings} readings count for nothing, or next to nothing, in {}",
            estimates.name()
        );
        Readout::new(format!("{percent:.1} % left out"), context.palette.shade(estimates.color()), hint)
    };
    weighing(quantity, context).map(share).collect()
}

#[cfg(test)]
mod tests {
    use egui::Theme;
    use kalmanscope_lessons::BuiltIn;

    use super::*;
    use crate::plot::time_axis::TimeAxis;
    use crate::ruler::Ruler;
    use crate::session::{Mode, Session};
    use crate::theme::Palette;
    use crate::visibility::Visibility;

    #[test]
    fn what_robust_filters_leave_out_is_drawn_and_counted() {
        let scenario = BuiltIn::named("outliers").expect("it is built in").scenario().expect("it is valid");
        let mut session = Session::new(scenario).expect("it can be run");
        session.set_mode(Mode::Whole);
        session.advance(0.0);
        let (palette, visible) = (Palette::of(Theme::Light), Visibility::default());
        let (axis, ruler) = (TimeAxis::default(), Ruler::default());
        let context = ViewContext::new(&session, &palette, &visible, &axis, &ruler);
        let of = |quantity: Quantity| {
            let measured = session.run().record().measured_quantity(quantity).expect("it is measured");
            let words: Vec<String> = shares(quantity, measured, &context).into_iter().map(|one| one.text).collect();
            (layers(quantity, measured, &context).len(), words)
        };
        let (drawn, words) = of(Quantity::DISPLACEMENT);
        assert_eq!((drawn, words.len()), (2, 2), "the plain filter leaves out none");
        for text in words {
            let percent: f64 = text.split(' ').next().and_then(|number| number.parse().ok()).expect("a number");
            assert!((9.0..11.0).contains(&percent), "{text}");
        }
        let (_, words) = of(Quantity::VELOCITY);
        assert!(words.iter().all(|text| text.starts_with("0.0 %")), "{words:?}");
    }
}
