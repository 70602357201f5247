//! The same step as equations with the numbers filled in, whose results a reader may hide.

use egui::{Grid, RichText, TextWrapMode, Ui};
use kalmanscope_core::Quantity;

use super::step::{FilterStep, StepResult};
use crate::text::significant;
use crate::theme;
use crate::widgets::named;

/// Limits the width below which an equation takes two lines \[points\].
const ONE_LINE: f32 = 600.0;

struct Equation {
    left: String,
    formula: String,
    numbers: String,
    result: StepResult,
    text: String,
    unit: String,
}

/// Shows the equations; returns the result that the reader wants to see.
pub(super) fn equations_ui(
    ui: &mut Ui,
    id: u32,
    step: &FilterStep,
    shown: &dyn Fn(StepResult, String) -> String,
) -> Option<StepResult> {
    let (is_wide, mut wanted) = (ui.available_width() >= ONE_LINE, None);
    Grid::new(("by hand", id)).spacing([8.0, 3.0]).show(ui, |ui| {
        ui.style_mut().wrap_mode = Some(TextWrapMode::Extend);
        for Equation { left, formula, numbers, result, text, unit } in equations(step, shown) {
            ui.label(RichText::new(format!("{left} =")).family(theme::strong()));
            ui.weak(formula);
            if !is_wide {
                ui.end_row();
                ui.label("");
            }
            ui.horizontal(|ui| {
                ui.spacing_mut().item_spacing.x = 5.0;
                ui.label(if numbers.is_empty() { "=".to_owned() } else { format!("= {numbers} =") });
                let text = shown(result, text);
                if text == HIDDEN {
                    let button = ui.button(HIDDEN).on_hover_text("Work it out, then look");
                    if named(button, format!("Show {left}")).clicked() {
                        wanted = Some(result);
                    }
                } else {
                    ui.label(RichText::new(text).family(theme::strong()));
                }
                ui.weak(unit);
            });
            ui.end_row();
        }
    });
    wanted
}

pub(super) const HIDDEN: &str = "?";

fn equations(step: &FilterStep, shown: &dyn Fn(StepResult, String) -> String) -> Vec<Equation> {
    use StepResult::{Gain, Innovation, InnovationVariance, Mean, PredictedMean, PredictedVariance, Shift, Variance};
    let (y, unit, [prior, ahead, after]) = (step.channel.symbol(), step.unit, step.beliefs);
    let [m, v] = step.digits.map(|digits| move |x: f64| digits.text(x));
    let one = |left: &str, formula: String, numbers: String, (result, text): (StepResult, String), unit: &str| {
        Equation { left: left.to_owned(), formula, numbers, result, text, unit: unit.to_owned() }
    };
    let squared = |unit: &str| match unit {
        "" => String::new(),
        unit if unit.contains('/') => format!("({unit})²"),
        unit => format!("{unit}²"),
    };
    let carried = if step.is_fading { "λ Φ P Φᵀ" } else { "Φ P Φᵀ" };
    let spread = step.process.map(|q| format!("{} + {}", v(ahead.variance - q), significant(q, 3)));
    let moved = format!("{y} + Δ, one step of g over {} s", significant(step.dt, 4));
    let sum = format!("{} + {}", m(prior.mean), in_brackets(m(ahead.mean - prior.mean)));
    let mut all = vec![
        one(&format!("{y}⁻"), moved, sum, (PredictedMean, m(ahead.mean)), unit),
        one(
            "P⁻",
            format!("{carried} + Q"),
            spread.unwrap_or_default(),
            (PredictedVariance, v(ahead.variance)),
            &squared(unit),
        ),
    ];
    let is_alone = step.terms.len() == 1;
    if let Some(update) = &step.update {
        let (z, other) = (update.quantity.symbol(), update.unit);
        let [r, s] = update.digits.map(|digits| move |x: f64| digits.text(x));
        let [h, reading] = [update.expected, update.measured];
        let ratio = match (unit, other) {
            (unit, other) if unit == other => String::new(),
            (unit, other) => format!("{unit} per {other}").trim().to_owned(),
        };
        let variance = || (InnovationVariance, s(h.variance));
        let divisor = shown(InnovationVariance, s(h.variance));
        let quotient = format!("{} / {divisor}", significant(update.gain * h.variance, 4));
        let of_all = format!("P⁻Hᵀ S⁻¹ of {} sensors, for {z}", step.terms.len());
        let (formula, quotient) =
            if is_alone { ("P⁻Hᵀ / S".to_owned(), quotient) } else { (of_all, String::new()) };
        let difference = format!("{} − {}", r(reading.mean), in_brackets(r(h.mean)));
        let parts = format!("{} + {}", s(h.variance - reading.variance), s(reading.variance));
        all.extend([
            one("e", format!("{z} − h(y⁻)"), difference, (Innovation, update.innovation()), other),
            one("S", "H P⁻Hᵀ + R".to_owned(), parts, variance(), &squared(other)),
            one("K", formula, quotient, (Gain, significant(update.gain, 4)), &ratio),
        ]);
    }
    if step.terms.is_empty() {
        return all;
    }
    let product = |(quantity, e, gain): &(Quantity, f64, f64)| {
        let gain = significant(*gain, 4);
        let factors = match step.update.as_ref().filter(|update| update.quantity == *quantity) {
            Some(update) => [shown(Gain, gain), shown(Innovation, update.innovation())],
            None => [gain, significant(*e, 3)],
        };
        factors.map(in_brackets).join(" · ")
    };
    let products = step.terms.iter().map(product).collect::<Vec<_>>().join(" + ");
    let formula = if is_alone { "K · e".to_owned() } else { "K · e of each sensor".to_owned() };
    let shift = || m(after.mean - ahead.mean);
    let sum = format!("{} + {}", shown(PredictedMean, m(ahead.mean)), in_brackets(shown(Shift, shift())));
    let taken = v(ahead.variance - after.variance);
    let difference = format!("{} − {taken}", shown(PredictedVariance, v(ahead.variance)));
    all.extend([
        one("K e", formula, products, (Shift, shift()), unit),
        one(y, format!("{y}⁻ + K e"), sum, (Mean, m(after.mean)), unit),
        one("P", "P⁻ − K S Kᵀ".to_owned(), difference, (Variance, v(after.variance)), &squared(unit)),
    ]);
    all
}

/// A negative number within a sum or product.
fn in_brackets(text: String) -> String {
    if text.starts_with('−') { format!("({text})") } else { text }
}
