//! Shows how much each reading counts for a robust filter.

use kalmanscope_core::{Estimates, Quantity, Robust};

use crate::plot::heading::Readout;
use crate::plot::layers::Layer;
use crate::plot::series::PlotSeries;
use crate::view::ViewContext;

/// Limits the samples that are counted in a frame.
const MOST_COUNTED: usize = 20_000;

/// The weights below which a reading gets a dot, each with its opacity: the fuller, the less the reading counts.
const SHADES: [(f64, f32); 3] = [(0.9, 0.35), (0.5, 0.65), (Robust::LEFT_OUT, 1.0)];

fn weighing<'a>(
    quantity: Quantity,
    context: &ViewContext<'a>,
) -> impl Iterator<Item = (usize, &'a Estimates, Robust)> + use<'a> {
    let settings = &context.session.run().scenario().filters;
    context.filters().filter_map(move |(place, estimates)| {
        let rule = settings.get(place)?.robust;
        let sensor = estimates.sensors().iter().position(|own| *own == quantity)?;
        estimates.weighs.then_some((sensor, estimates, rule))
    })
}

fn weight(estimates: &Estimates, sensor: usize, k: usize) -> f64 {
    estimates.weights(k).get(sensor).copied().unwrap_or(f64::NAN)
}

pub(super) fn layers<'a>(quantity: Quantity, measured: &'a [f64], context: &ViewContext<'a>) -> Vec<Layer<'a>> {
    let layers = |(sensor, estimates, _): (usize, &'a Estimates, Robust)| {
        let next = SHADES.iter().skip(1).map(|(below, _)| *below).chain([f64::NEG_INFINITY]);
        SHADES.iter().zip(next).map(move |(&(below, opacity), least)| {
            let value = move |k: usize| {
                let weight = weight(estimates, sensor, k);
                if weight < below && weight >= least { measured[k] } else { f64::NAN }
            };
            let series = PlotSeries::each(estimates.len().min(measured.len()), value);
            Layer::Dots { series, color: context.color(estimates).gamma_multiply(opacity) }
        })
    };
    weighing(quantity, context).flat_map(layers).collect()
}

pub(super) fn at<'a>(quantity: Quantity, k: usize, context: &ViewContext<'a>) -> Vec<Readout> {
    let said = |(sensor, estimates, rule): (usize, &'a Estimates, Robust)| {
        let weight =
            (k < estimates.len()).then(|| weight(estimates, sensor, k)).filter(|weight| *weight < SHADES[0].0)?;
        let (text, hint) = if rule.info().is_probable {
            (format!("{:.2} an outlier", 1.0 - weight), "The probability that this reading is an outlier, in")
        } else {
            (format!("{weight:.2} of a reading"), "The weight of this reading in")
        };
        let color = context.color(estimates);
        Some(Readout::new(text, color, format!("{hint} {}", estimates.name())))
    };
    weighing(quantity, context).filter_map(said).collect()
}

pub(super) fn shares(quantity: Quantity, measured: &[f64], context: &ViewContext<'_>) -> Vec<Readout> {
    let share = |(sensor, estimates, _): (usize, &Estimates, Robust)| {
        let len = estimates.len().min(measured.len());
        let samples = len.saturating_sub(MOST_COUNTED)..len;
        let readings = samples.clone().filter(|&k| !measured[k].is_nan()).count();
        let out = samples.filter(|&k| weight(estimates, sensor, k) < Robust::LEFT_OUT).count();
        let percent = 100.0 * out as f64 / readings.max(1) as f64;
        let hint = format!(
            "{out} of the last {readings} readings count for nothing, or next to nothing, in {}",
            estimates.name()
        );
        Readout::new(format!("{percent:.1} % left out"), context.color(estimates), hint)
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
        assert_eq!((drawn, words.len()), (2 * SHADES.len(), 2), "the plain filter leaves out none");
        for text in words {
            let percent: f64 = text.split(' ').next().and_then(|number| number.parse().ok()).expect("a number");
            assert!((9.0..11.0).contains(&percent), "{text}");
        }
        // Both filters report the weight of the same outlier.
        let estimates = &session.run().estimates()[1];
        let k = (1000..estimates.len()).find(|&k| weight(estimates, 0, k) == 0.0).expect("one is left out");
        let said: Vec<String> = at(Quantity::DISPLACEMENT, k, &context).into_iter().map(|one| one.text).collect();
        assert_eq!((said.len(), said[0].as_str()), (2, "0.00 of a reading"), "{said:?}");
        let (_, words) = of(Quantity::VELOCITY);
        assert!(words.iter().all(|text| text.starts_with("0.0 %")), "{words:?}");
    }
}
