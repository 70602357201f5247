//! Files that leave the explorer.

use std::fmt::Display;

use egui::{Context, Id, Popup, Ui};
use kalmanscope_cli::{Parts, day, report, write_estimates};
use kalmanscope_core::diagnosis::{Evidence, Remedy};
use kalmanscope_core::diagnostics::Depth;
use kalmanscope_core::document::{self, Document, DocumentError, json};
use kalmanscope_core::{Analysis, Channel, Diagnosis, Estimates, Record, Scenario, Stop, Task};

use crate::figure::Figure;
use crate::inbox::Done;
use crate::laboratory::Laboratory;
use crate::layout::Layout;
use crate::menu::Closing;
use crate::request::{Export, FigureFormat, Request, ViewKind};
use crate::session::{Attempt, Session, Wanted};
use crate::team::{Lost, Priority, Running};
use crate::view::ViewContext;
use crate::widgets::named;
use crate::{menu, probe};

/// The views that a report has besides those on screen: innovations, and measurements against predictions.
const ALWAYS: [ViewKind; 2] = [ViewKind::Innovations, ViewKind::Measured];

const TEXT: [ViewKind; 3] = [ViewKind::Matrices, ViewKind::Scores, ViewKind::Filters];

const JSON: &str = "application/json";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    pub name: String,
    pub kind: &'static str,
    pub contents: Vec<u8>,
}

pub type Deliver = Box<dyn Fn(File, Done)>;

/// Files of data, each with its name and a hint.
const DATA: [(Export, &str, &str); 6] = [
    (Export::Estimates, "Estimates (CSV)", "Every mean, standard deviation, innovation and prediction of every filter"),
    (Export::Record, "Record (CSV)", "Force, measurements and truth, as the command line reads them"),
    (Export::Map, "Map (CSV)", "Every score of every cell of the map in the laboratory"),
    (
        Export::MonteCarlo,
        "Monte Carlo (CSV)",
        "Mean NEES and NIS, error quantiles and σ over time, of all seeds in the laboratory",
    ),
    (Export::Scenario, "Scenario (TOML)", "The settings, for the command line or to be dropped on this window"),
    (Export::All, "Everything (JSON)", "Version, scenario, record, estimates and diagnosis, for a program"),
];

/// An export under way: a frame draws one figure, and the text follows from the analysis of the session, or is written beside the
/// frames.
pub(crate) struct Exporting {
    export: Export,
    figures: Vec<(Vec<Vec<ViewKind>>, FigureFormat)>,
    drawn: Vec<String>,
    written: Option<Running<Everything>>,
}

impl Exporting {
    pub(crate) fn new(export: Export, layout: &Layout) -> Self {
        let figures = match export {
            Export::Figure(format) => vec![(layout.rows(), format)],
            Export::Report => {
                let more = ALWAYS.into_iter().filter(|kind| !layout.shown().contains(kind));
                let views = layout.in_order().into_iter().chain(more).filter(|kind| !TEXT.contains(kind));
                views.map(|kind| (vec![vec![kind]], FigureFormat::Page)).collect()
            }
            _ => Vec::new(),
        };
        Self { export, figures, drawn: Vec::new(), written: None }
    }

    pub(crate) fn wanted(&self) -> Wanted {
        if self.export == Export::Report { Wanted::diagnostics(Depth::All) } else { Wanted::NOTHING }
    }

    pub(crate) fn progress(&self) -> f64 {
        self.drawn.len() as f64 / (self.figures.len() + 1) as f64
    }

    /// Continues for a frame. Returns the file once, or the reason why it cannot be made. Results are those that have been computed
    /// so far.
    pub(crate) fn advance(&mut self, context: &ViewContext<'_>, layout: &Layout) -> Option<Result<File, String>> {
        let session = context.session;
        if let Some((rows, format)) = self.figures.get(self.drawn.len()) {
            self.drawn.push(Figure::new(context, rows, *format).svg());
            return None;
        }
        if self.export == Export::Report && (session.behind() || session.owes_diagnoses()) {
            return None;
        }
        self.file(context, layout).transpose()
    }

    fn file(&mut self, context: &ViewContext<'_>, layout: &Layout) -> Result<Option<File>, String> {
        let (session, figures) = (context.session, &self.drawn);
        Ok(Some(match self.export {
            Export::Figure(format) => {
                text(&format!("kalmanscope-{}.svg", format.key()), "image/svg+xml", figures.concat())
            }
            Export::Report => text("report.html", "text/html", report_on(session, figures)?),
            Export::Estimates => csv("estimates.csv", |out| write_estimates(session.run(), out))?,
            Export::Record => csv("record.csv", |out| session.run().record().write_csv(out))?,
            Export::Map => {
                let survey = context.laboratory.and_then(Laboratory::shown);
                text("map.csv", "text/csv", survey.ok_or("there is no map yet: show the view Map")?.to_csv())
            }
            Export::MonteCarlo => {
                let runs = context.laboratory.and_then(|laboratory| laboratory.seeds.shown());
                let runs = runs.ok_or("no seed has been run yet: show the view Monte Carlo")?;
                text("monte-carlo.csv", "text/csv", runs.to_csv())
            }
            Export::Scenario => {
                text("scenario.toml", "application/toml", session.scenario().to_toml().map_err(reason)?)
            }
            Export::All => return self.everything(session),
            Export::Session => text("kalmanscope-session.json", JSON, context.picture(layout).lines().map_err(reason)?),
        }))
    }

    fn everything(&mut self, session: &Session) -> Result<Option<File>, String> {
        let begin = || Running::begin(&**session.team(), Priority::Hand, Everything::of(session), Everything::progress);
        match self.written.get_or_insert_with(begin).advance(&mut || true) {
            Ok(written) => Ok(written.transpose().map_err(reason)?.map(|json| text("kalmanscope.json", JSON, json))),
            Err(Lost) => Err("the thread that wrote it has failed".to_owned()),
        }
    }
}

/// The report as one page for a browser or a printer. Causes are those that have been found so far.
fn report_on(session: &Session, figures: &[String]) -> Result<String, String> {
    let run = session.run();
    let attempts = run.estimates().iter().map(|estimates: &Estimates| session.attempt(estimates.id()));
    let causes: Vec<Vec<Remedy>> =
        attempts.map(|attempt| attempt.map_or_else(Vec::new, |attempt: &Attempt| attempt.remedies.to_vec())).collect();
    let file = session.scenario().record.as_ref().map(|mapping| mapping.file.clone());
    let title = file.filter(|file| !file.is_empty()).unwrap_or_else(|| "A simulated oscillator".to_owned());
    let records = [(title.as_str(), run.record())];
    let parts = Parts {
        title: &title,
        day: &now().map(day).unwrap_or_default(),
        causes: &causes,
        reasons: &session.library().reasons,
        figures,
        free_runs: if session.is_measured() { &records } else { &[] },
    };
    let so_far = || Analysis::new(run, Wanted::diagnostics(Depth::All));
    match session.whole_analysis() {
        Some(analysis) => report(run, analysis, &parts),
        None => report(run, &so_far(), &parts),
    }
    .map_err(reason)
}

fn text(name: &str, kind: &'static str, text: String) -> File {
    File { name: name.to_owned(), kind, contents: text.into_bytes() }
}

fn csv<E: Display>(name: &str, write: impl FnOnce(&mut Vec<u8>) -> Result<(), E>) -> Result<File, String> {
    let mut contents = Vec::new();
    write(&mut contents).map_err(reason)?;
    Ok(File { name: name.to_owned(), kind: "text/csv", contents })
}

fn reason(error: impl Display) -> String {
    error.to_string()
}

#[cfg(not(target_arch = "wasm32"))]
fn now() -> Option<f64> {
    let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH);
    now.ok().map(|now| now.as_secs_f64())
}

#[cfg(target_arch = "wasm32")]
fn now() -> Option<f64> {
    Some(js_sys::Date::now() / 1e3)
}

/// Makes the text of the file. Undefined numbers are `null`. Means are canonical, as everywhere on screen.
struct Everything {
    scenario: Scenario,
    record: Record,
    filters: Vec<(Estimates, Option<Diagnosis>)>,
}

impl Everything {
    fn of(session: &Session) -> Self {
        let run = session.run();
        let filters = run.estimates().iter().cloned().enumerate();
        let filters = filters.map(|(place, estimates)| (estimates, session.diagnosis(place).cloned())).collect();
        Self { scenario: session.scenario().clone(), record: run.record().clone(), filters }
    }
}

impl Task for Everything {
    type Outcome = Result<String, DocumentError>;

    fn progress(&self) -> f64 {
        0.0
    }

    fn advance(&mut self, _: &mut dyn FnMut() -> bool) -> bool {
        true
    }

    fn finish(self) -> Self::Outcome {
        let filters = self.filters.iter().map(|(estimates, diagnosis)| filter(estimates, diagnosis.as_ref()));
        document::to_json(&json!({
            "kalmanscope": env!("CARGO_PKG_VERSION"),
            "scenario": self.scenario,
            "record": record(&self.record),
            "filters": Document::from_iter(filters),
        }))
    }
}

fn record(record: &Record) -> Document {
    let measured = record.sensors().iter().enumerate().map(|(i, q)| (q.key(), record.measured(i)));
    let truth = Channel::all().iter().filter_map(|c| Some((c.key(), record.truth(*c)?)));
    json!({
        "dt": record.dt(),
        "time": Document::from_iter((0..record.len()).map(|k| record.time(k))),
        "input_kind": record.input_kind(),
        "hold": record.hold(),
        "input": record.input(),
        "measured": Document::from_iter(measured),
        "truth": Document::from_iter(truth),
    })
}

fn filter(estimates: &Estimates, found: Option<&Diagnosis>) -> Document {
    let of_channels = |column: &dyn Fn(usize) -> Document| {
        let channels = estimates.channels().iter().enumerate();
        Document::from_iter(channels.map(|(place, channel)| (channel.key(), column(place))))
    };
    let of_sensors = |column: &dyn Fn(usize) -> Document| {
        let sensors = estimates.sensors().iter().enumerate();
        Document::from_iter(sensors.map(|(place, sensor)| (sensor.key(), column(place))))
    };
    json!({
        "name": estimates.name(),
        "kind": estimates.kind().name(),
        "plant": estimates.plant(),
        "mean": of_channels(&|place| Document::from_iter(estimates.canonical_means(place).iter().copied())),
        "std": of_channels(&|place| Document::from_iter(estimates.stds(place))),
        "innovation": of_sensors(&|place| Document::from_iter(estimates.innovations(place))),
        "innovation_std": of_sensors(&|place| Document::from_iter(estimates.innovation_stds(place))),
        "nis": estimates.nis(),
        "log_likelihood": Document::from_iter(estimates.log_likelihoods()),
        "stop": estimates.stop().map(stop),
        "diagnosis": found.map(diagnosis),
    })
}

fn stop(stop: Stop) -> Document {
    json!({ "sample": stop.sample, "reason": stop.reason.to_string() })
}

fn diagnosis(diagnosis: &Diagnosis) -> Document {
    let verdict = diagnosis.verdict.as_ref();
    json!({
        "verdict": verdict.map(|verdict| verdict.kind.key()),
        "reason": verdict.map(|verdict| &*verdict.reason),
        "evidence": Document::from_iter(diagnosis.evidence.iter().map(evidence)),
        "bad_parts": Document::from_iter(diagnosis.bad_parts.iter().map(|range| json!([range.start, range.end]))),
    })
}

fn evidence(one: &Evidence) -> Document {
    json!({
        "test": one.test.name,
        "sentence": one.sentence,
        "statistic": one.statistic,
        "p_value": one.p_value,
        "effect": one.effect,
        "counts": one.counts,
    })
}

pub(crate) fn menu_ui(ui: &mut Ui, narrow: bool, layout: &Layout, requests: &mut Vec<Request>) {
    let button = menu::menu_ui(ui, if narrow { "↓" } else { "Export" }, Closing::AtOnce, |ui| {
        let mut entry = |ui: &mut Ui, request: Request, name: &str, hint: &str| {
            let button = ui.button(name).on_hover_text(hint);
            probe::remember(ui.ctx(), name, button.rect);
            if button.clicked() {
                requests.push(request);
                ui.close();
            }
        };
        entry(ui, Request::CopyLink, "Copy link", "To this picture: settings, views and time (C)");
        entry(ui, Request::ShowFigure, "Figure…", "The views on screen as outlines and text, for a document");
        let hint = "Verdicts, evidence, estimates, scores and figures as one page, to print or to send";
        entry(ui, Request::Export(Export::Report), "Report (HTML)", hint);
        let data = ui.menu_button("Data…", |ui| {
            // Nothing is computed for a view that is not there.
            let is_there = |export: Export| match export {
                Export::Map => layout.shown().contains(&ViewKind::Map),
                Export::MonteCarlo => layout.shown().contains(&ViewKind::MonteCarlo),
                _ => true,
            };
            for (export, name, hint) in DATA.into_iter().filter(|(export, ..)| is_there(*export)) {
                entry(ui, Request::Export(export), name, hint);
            }
        });
        probe::remember(ui.ctx(), "Data…", data.response.rect);
        let hint = "Settings, views and playback; drop the file on this window to go on";
        entry(ui, Request::Export(Export::Session), "Session, to open again", hint);
    });
    let button = named(button, "Export");
    probe::remember(ui.ctx(), "Export", button.rect);
    let popup = Popup::default_response_id(&button);
    ui.data_mut(|data| data.insert_temp(popup_key(), popup));
}

pub(crate) fn toggle(ctx: &Context) {
    if let Some(popup) = ctx.data(|data| data.get_temp::<Id>(popup_key())) {
        Popup::toggle_id(ctx, popup);
    }
}

fn popup_key() -> Id {
    Id::unique("the popup of the menu of exports")
}
