//! Filters side by side: verdict and scores.

use egui::{Grid, Label, RichText, ScrollArea, Ui};
use kalmanscope_core::ModelClasses;
use kalmanscope_core::diagnostics::MeanSquare;
use kalmanscope_core::{Channel, Estimates, Signal, Source};
use kalmanscope_diagnosis::Summary;
use kalmanscope_diagnosis::Verdict;

use crate::plot::medium::Medium;
use crate::request::Request;
use crate::session::{Session, Wanted};
use crate::text::{significant, unit_in};
use crate::theme::{self, Palette};
use crate::verdict::{symbol, text_color};
use crate::view::{View, ViewContext};

/// Limits the width of a verdict's reason from below and above \[points\].
const REASON: (f32, f32) = (90.0, 210.0);

const NAMES: f32 = 205.0;

const ALIKE: f64 = 0.1;

const SPACING: f32 = 18.0;

pub(super) static VIEW: View = View {
    name: "Scores",
    help: [
        "The scores of each filter over the record so far, or over the kept part of a long one.",
        "RMSE is the size of the errors; the verdict says whether the filter's σ agrees with them.",
        "A small error of an inconsistent filter may be chance.",
    ],
    wanted: Wanted::DIAGNOSTICS,
    ui: Some(view_ui),
    ..View::NONE
};

fn view_ui(ui: &mut Ui, context: &ViewContext<'_>, _: &mut Vec<Request>) -> Option<f64> {
    let ViewContext { session, palette, visible, .. } = *context;
    let (estimates, record) = (session.run().estimates(), session.run().record());
    let of = |(place, (d, e))| Summary::of(d, session.diagnosis(place), e, record);
    let summaries: Vec<Summary> = session.diagnostics().iter().zip(estimates).enumerate().map(of).collect();
    let was = |estimates: &Estimates| {
        let (diagnostics, estimates) = session.before()?.diagnostics(estimates.id())?;
        Some(Summary::of(diagnostics, None, estimates, session.before()?.record()))
    };
    let before: Vec<Option<Summary>> = estimates.iter().map(was).collect();
    let rows = rows(&summaries, &before, session);
    let column = (ui.available_width() - NAMES) / summaries.len().max(1) as f32 - SPACING;
    let reason_width = column.clamp(REASON.0, REASON.1);
    ScrollArea::both().auto_shrink(false).show(ui, |ui| {
        Grid::new("scores").striped(true).spacing([SPACING, 4.0]).show(ui, |ui| {
            if Medium::of(ui.ctx()) != Medium::Screen {
                ui.label("");
            } else if ui.small_button("Copy").on_hover_text("Copy the table as text").clicked() {
                ui.ctx().copy_text(as_text(&summaries, &rows));
            }
            for estimates in estimates {
                ui.label(RichText::new(estimates.name()).family(theme::strong()).color(context.color(estimates)));
            }
            ui.end_row();
            if visible.verdicts {
                ui.weak("verdict");
                for summary in &summaries {
                    verdict_ui(ui, summary.verdict.as_ref(), reason_width, palette);
                }
                ui.end_row();
            }
            for row in &rows {
                ui.weak(&row.name).on_hover_text(row.hint);
                let best = row.best();
                for (place, (value, before)) in row.values.iter().zip(&row.before).enumerate() {
                    let value = value.map_or("–".to_owned(), |x| significant(x, 3));
                    let text = RichText::new(&value).monospace();
                    let text = if best == Some(place) { text.strong().underline() } else { text };
                    let before = before.map(|x| significant(x, 3)).filter(|before| *before != value);
                    ui.horizontal(|ui| {
                        ui.label(text);
                        if let Some(before) = before {
                            ui.weak(format!("was {before}"));
                        }
                    });
                }
                ui.end_row();
            }
            if visible.verdicts {
                // The reason comes last: it is long, and the numbers above it are for comparison.
                ui.weak("why");
                for summary in &summaries {
                    reason_ui(ui, summary.verdict.as_ref(), reason_width);
                }
                ui.end_row();
            }
        });
    });
    None
}

fn verdict_ui(ui: &mut Ui, verdict: Option<&Verdict>, width: f32, palette: &Palette) {
    ui.vertical(|ui| {
        ui.set_max_width(width);
        match verdict.map(|verdict| verdict.kind) {
            Some(kind) => ui.colored_label(text_color(kind, palette), format!("{} {}", symbol(kind), kind.name())),
            None => ui.weak("too few samples"),
        };
    });
}

fn reason_ui(ui: &mut Ui, verdict: Option<&Verdict>, width: f32) {
    ui.vertical(|ui| {
        ui.set_max_width(width);
        let reason = verdict.map_or("", |verdict| verdict.reason.as_str());
        ui.add(Label::new(RichText::new(reason).small().weak()).wrap());
    });
}

struct ScoreRow {
    name: String,
    hint: &'static str,
    values: Vec<Option<f64>>,
    before: Vec<Option<f64>>,
    /// The best value is the nearest to this, or the largest if this is infinite.
    ideal: f64,
    /// Limits a difference that is not significant: a share of the worse distance; a number if the ideal is infinite.
    alike: f64,
}

impl ScoreRow {
    fn distance(&self, value: f64) -> f64 {
        if self.ideal == f64::INFINITY { -value } else { (value - self.ideal).abs() }
    }

    fn best(&self) -> Option<usize> {
        let values = self.values.iter().enumerate().filter_map(|(place, value)| Some((place, (*value)?)));
        let mut distances: Vec<(usize, f64)> =
            values.filter(|(_, x)| x.is_finite()).map(|(place, x)| (place, self.distance(x))).collect();
        distances.sort_by(|a, b| a.1.total_cmp(&b.1));
        let [(place, best), (_, second), ..] = distances[..] else { return None };
        let alike = if self.ideal == f64::INFINITY { self.alike } else { self.alike * second };
        (second - best > alike).then_some(place)
    }
}

fn rows(summaries: &[Summary], before: &[Option<Summary>], session: &Session) -> Vec<ScoreRow> {
    let row = |name: String, hint, ideal, alike, of: &dyn Fn(&Summary) -> Option<f64>| ScoreRow {
        name,
        hint,
        ideal,
        alike,
        values: summaries.iter().map(of).collect(),
        before: before.iter().map(|summary| of(summary.as_ref()?)).collect(),
    };
    let mut channels: Vec<Channel> = Vec::new();
    for channel in summaries.iter().flat_map(|s| s.finals.iter().map(|f| f.channel)) {
        if !channels.contains(&channel) {
            channels.push(channel);
        }
    }
    channels.sort_by_key(|c| !c.is_parameter());
    let change = last_change(session);
    let mut rows = Vec::new();
    for channel in channels {
        let score = |s: &Summary| s.finals.iter().find(|f| f.channel == channel)?.score;
        let symbol = channel.symbol();
        let name = with_unit(&format!("{symbol} RMSE, last third"), unit_in(session.run().scenario(), channel.unit()));
        rows.push(row(name, "Root mean square of estimate minus truth, last third", 0.0, ALIKE, &|s| {
            Some(score(s)?.rmse_last_third)
        }));
        let name = format!("{symbol} in ±2σ, 95 is right [%]");
        rows.push(row(name, "Share of samples with the truth inside ±2σ", 95.0, ALIKE, &|s| {
            Some(100.0 * score(s)?.coverage)
        }));
        if channel.is_parameter() {
            let since = if change.is_some() { "after the change" } else { "from the start" };
            let from = change.unwrap_or_else(|| session.run().record().time_of(0));
            rows.push(row(
                format!("{symbol} settled {since} [s]"),
                "Until it stays within 5 % of the truth",
                0.0,
                ALIKE,
                &|s| Some((score(s)?.settled? - from).max(0.0)),
            ));
        }
    }
    let over_expected = |square: &Option<MeanSquare>| square.as_ref().map(|square| square.mean / square.expected);
    let hint = "Mean over all samples, over its expectation";
    rows.push(row("NIS, 1 is right".to_owned(), hint, 1.0, ALIKE, &|s| over_expected(&s.nis)));
    rows.push(row("NEES, 1 is right".to_owned(), hint, 1.0, ALIKE, &|s| over_expected(&s.nees)));
    // A difference of 2 is a likelihood ratio of 7.
    let hint = "Of all measurements: larger means better predictions";
    rows.push(row("log likelihood".to_owned(), hint, f64::INFINITY, 2.0, &|s| Some(s.log_likelihood)));
    if summaries.len() > 1 {
        let classes = ModelClasses::new(summaries.iter().map(Summary::log_evidence));
        let values = classes.probabilities.iter().map(|p| Some(100.0 * p)).collect();
        let hint = "Of the filter as a model, if one of them is right and all were equally probable at first";
        let name = "probability of the model [%]".to_owned();
        let before = || vec![None; summaries.len()];
        rows.push(ScoreRow { name, hint, values, before: before(), ideal: f64::INFINITY, alike: 1.0 });
        let best = classes.likeliest().map_or(f64::NAN, |class| summaries[class].log_evidence());
        let of = |summary: &Summary| Some(summary.log_evidence() - best).filter(|ln| ln.is_finite());
        let values = summaries.iter().map(of).collect();
        let hint =
            "Logarithm of the Bayes factor over the likeliest model: below -5, the readings are clearly against it";
        let name = "ln Bayes factor".to_owned();
        rows.push(ScoreRow { name, hint, values, before: before(), ideal: 0.0, alike: 1.0 });
    }
    rows
}

fn with_unit(name: &str, unit: &str) -> String {
    if unit.is_empty() { name.to_owned() } else { format!("{name} [{unit}]") }
}

fn last_change(session: &Session) -> Option<f64> {
    let (run, record, plant) = (session.run(), session.run().record(), &session.scenario().plant);
    if !matches!(run.source(), Source::Simulated) {
        return None;
    }
    let end = record.time(run.len().checked_sub(1)?);
    let at = |channel: &Channel| match plant.parameter(*channel) {
        Some(Signal::Step(step)) => Some(record.time_of(0) + step.at),
        _ => None,
    };
    plant.kind.channels().iter().filter_map(at).filter(|at| *at < end).reduce(f64::max)
}

fn as_text(summaries: &[Summary], rows: &[ScoreRow]) -> String {
    let names: Vec<&str> = summaries.iter().map(|s| s.name.as_str()).collect();
    let mut text = format!("\t{}\n", names.join("\t"));
    let verdicts = summaries.iter().map(|s| s.verdict.as_ref().map_or(String::new(), |v| v.kind.name().to_owned()));
    text += &format!("verdict\t{}\n", verdicts.collect::<Vec<_>>().join("\t"));
    for row in rows {
        let values = row.values.iter().map(|x| x.map_or(String::new(), |x| x.to_string()));
        text += &format!("{}\t{}\n", row.name, values.collect::<Vec<_>>().join("\t"));
    }
    text
}
