//! Files that leave the explorer.

use std::fmt::Display;

use egui::{Context, Id, Popup, Theme, Ui};
use kalmanscope_cli::{ReportParts, Results, report, write_estimates};
use kalmanscope_core::document::DocumentError;
use kalmanscope_core::{Estimates, Task};
use kalmanscope_diagnosis::Analysis;
use kalmanscope_diagnosis::Remedy;

use crate::figure::Figure;
use crate::film::Film;
use crate::inbox::Done;
use crate::laboratory::Laboratory;
use crate::layout::ViewLayout;
use crate::menu;
use crate::menu::Closing;
use crate::probe::Remembered as _;
use crate::request::{Export, FigureFormat, Request, ViewKind};
use crate::session::{Attempt, Session, Wanted};
use crate::team::{Lost, Priority, RunningTask};
use crate::view::ViewContext;
use crate::views::view;
use crate::widgets::named;

const ALWAYS: [ViewKind; 2] = [ViewKind::Innovations, ViewKind::Measured];

const TABLES: [ViewKind; 2] = [ViewKind::Scores, ViewKind::Filters];

const JSON: &str = "application/json";
const GIF: &str = "image/gif";
const SVG: &str = "image/svg+xml";
const TOML: &str = "application/toml";

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ExportFile {
    pub name: String,
    pub kind: &'static str,
    pub contents: Vec<u8>,
}

pub type Deliver = Box<dyn Fn(ExportFile, Done)>;

const DATA: [(Export, &str, &str); 6] = [
    (Export::Estimates, "Estimates (CSV)", "Every mean, standard deviation, innovation and prediction of every filter"),
    (Export::Record, "Record (CSV)", "Force, measurements and truth, for the command line"),
    (Export::Map, "Map (CSV)", "Every score of every cell of the map"),
    (Export::MonteCarlo, "Monte Carlo (CSV)", "Mean NEES and NIS, error quantiles and σ over time"),
    (Export::Scenario, "Scenario (TOML)", "The settings, for this window or the command line"),
    (Export::All, "Everything (JSON)", "Scenario, record, estimates, verdicts and causes, for a program"),
];

pub(crate) struct Exporting {
    export: Export,
    figures: Vec<(Vec<Vec<ViewKind>>, FigureFormat)>,
    drawn: Vec<String>,
    film: Option<Film>,
    /// A sentence about the file, besides its place.
    pub(crate) remark: String,
    written: Option<RunningTask<Everything>>,
}

impl Exporting {
    pub(crate) fn new(export: Export, layout: &ViewLayout, session: &Session, theme: Theme) -> Self {
        let figures = match export {
            Export::Figure(format) => vec![(layout.rows(), format)],
            Export::Report => {
                let more = ALWAYS.into_iter().filter(|kind| !layout.shown().contains(kind));
                let views = layout.in_order().into_iter().chain(more).filter(|kind| !TABLES.contains(kind));
                views.map(|kind| (vec![vec![kind]], FigureFormat::Page)).collect()
            }
            _ => Vec::new(),
        };
        let film = match export {
            Export::Film(view) if !session.is_live() => view.or_else(|| layout.in_sight().first().copied()),
            _ => None,
        };
        let film = film.map(|view| Film::new(view, session, theme));
        Self { export, figures, drawn: Vec::new(), film, remark: String::new(), written: None }
    }

    pub(crate) fn wanted(&self) -> Wanted {
        if self.needs_results() { Wanted::DIAGNOSTICS } else { Wanted::NOTHING }
    }

    fn needs_results(&self) -> bool {
        matches!(self.export, Export::Report | Export::All)
    }

    pub(crate) fn film(&self) -> Option<&Film> {
        self.film.as_ref()
    }

    pub(crate) fn progress(&self) -> f64 {
        if let Some(film) = &self.film {
            return film.progress();
        }
        // One more for the text: the share is not whole before the file is.
        self.drawn.len() as f64 / (self.figures.len() + 1) as f64
    }

    pub(crate) fn advance(
        &mut self,
        context: &ViewContext<'_>,
        layout: &ViewLayout,
    ) -> Option<Result<ExportFile, String>> {
        let session = context.session;
        if let Some(film) = &mut self.film {
            let (contents, remark) = match film.advance(context)? {
                Ok(made) => made,
                Err(reason) => return Some(Err(reason)),
            };
            self.remark = remark.map_or_else(String::new, |remark| format!(". {remark}"));
            let name = format!("{}.gif", view(film.view).name.replace(' ', "-").to_lowercase());
            return Some(Ok(ExportFile { name, kind: GIF, contents }));
        }
        // One figure a frame, since all figures of a report would be one long frame.
        if let Some((rows, format)) = self.figures.get(self.drawn.len()) {
            self.drawn.push(Figure::new(context, rows, *format).svg());
            return None;
        }
        if self.needs_results() && (session.behind() || session.owes_diagnoses()) {
            return None;
        }
        self.file(context, layout).transpose()
    }

    fn file(&mut self, context: &ViewContext<'_>, layout: &ViewLayout) -> Result<Option<ExportFile>, String> {
        let (session, figures) = (context.session, &self.drawn);
        Ok(Some(match self.export {
            Export::Film(_) if session.is_live() => return Err("the measurement has not ended".to_owned()),
            Export::Film(_) => return Err("no view is shown".to_owned()),
            Export::Figure(format) => text(&format!("kalmanscope-{}.svg", format.key()), SVG, figures.concat()),
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
            Export::Scenario => text("scenario.toml", TOML, session.scenario().to_toml().map_err(reason)?),
            Export::All => return self.everything(session),
            Export::Session => text("kalmanscope-session.json", JSON, context.picture(layout).lines().map_err(reason)?),
        }))
    }

    fn everything(&mut self, session: &Session) -> Result<Option<ExportFile>, String> {
        let begin = || {
            let series = session.run().estimates().to_vec();
            let task = Everything { results: results_of(session).into_owned(), series };
            RunningTask::begin(&**session.team(), Priority::Hand, task, Everything::progress)
        };
        match self.written.get_or_insert_with(begin).advance(&mut || true) {
            Ok(written) => Ok(written.transpose().map_err(reason)?.map(|json| text("kalmanscope.json", JSON, json))),
            Err(Lost) => Err("the thread that wrote it has failed".to_owned()),
        }
    }
}

fn record_name(session: &Session) -> Option<String> {
    let file = session.scenario().record.as_ref().map(|mapping| mapping.file.clone());
    file.filter(|file| !file.is_empty())
}

fn results_of(session: &Session) -> Results<'_> {
    let run = session.run();
    let attempts = run.estimates().iter().map(|estimates: &Estimates| session.attempt(estimates.id()));
    let causes: Vec<Vec<Remedy>> =
        attempts.map(|attempt| attempt.map_or_else(Vec::new, |attempt: &Attempt| attempt.remedies.to_vec())).collect();
    let results = match session.whole_analysis() {
        Some(analysis) => Results::of_run(run, analysis, causes),
        None => Results::of_run(run, &Analysis::new(run, Wanted::DIAGNOSTICS), causes),
    };
    let name = record_name(session).unwrap_or_else(|| "its own record".to_owned());
    let records = [(name.as_str(), run.record())];
    results.with_free_runs(run, if session.is_measured() { &records } else { &[] })
}

fn report_on(session: &Session, figures: &[String]) -> Result<String, String> {
    let title = record_name(session).unwrap_or_else(|| "A simulated oscillator".to_owned());
    let parts = ReportParts { title: &title, reasons: &session.library().reasons, figures };
    report(&results_of(session), &parts).map_err(reason)
}

fn text(name: &str, kind: &'static str, text: String) -> ExportFile {
    ExportFile { name: name.to_owned(), kind, contents: text.into_bytes() }
}

fn csv<E: Display>(name: &str, write: impl FnOnce(&mut Vec<u8>) -> Result<(), E>) -> Result<ExportFile, String> {
    let mut contents = Vec::new();
    write(&mut contents).map_err(reason)?;
    Ok(ExportFile { name: name.to_owned(), kind: "text/csv", contents })
}

fn reason(error: impl Display) -> String {
    error.to_string()
}

struct Everything {
    results: Results<'static>,
    series: Vec<Estimates>,
}

impl Task for Everything {
    type Outcome = Result<String, DocumentError>;

    fn progress(&self) -> f64 {
        0.0
    }

    // JSON is written in one go, in `finish`: on a thread, and on a page, which has none, in a frame.
    fn advance(&mut self, _: &mut dyn FnMut() -> bool) -> bool {
        true
    }

    fn finish(self) -> Self::Outcome {
        self.results.json(&self.series)
    }
}

const FIGURE: (&str, &str) = ("Figure…", "The views on screen as outlines and text, for a document");

const FILM: (&str, &str) = ("Film…", "Five seconds of a view from now on as an animated GIF, for a slide");

const REPORT: (Export, &str, &str) = (
    Export::Report,
    "Report (HTML)",
    "Verdicts, evidence, estimates, scores and figures as one page, to print or to send",
);

const SESSION: (Export, &str, &str) =
    (Export::Session, "Session file", "Settings, views and time: open or drop it to continue");

pub(crate) fn entries() -> impl Iterator<Item = (Request, &'static str, &'static str)> {
    let film = (Export::Film(None), FILM.0, FILM.1);
    let all = [film, REPORT].into_iter().chain(DATA).chain([SESSION]);
    let all = all.map(|(export, name, hint)| (Request::Export(export), name, hint));
    std::iter::once((Request::ShowFigure, FIGURE.0, FIGURE.1)).chain(all)
}

pub(crate) fn menu_ui(ui: &mut Ui, narrow: bool, layout: &ViewLayout, requests: &mut Vec<Request>) {
    let button = menu::menu_ui(ui, if narrow { "↓" } else { "Export" }, Closing::AtOnce, |ui| {
        let mut entry = |ui: &mut Ui, (request, name, hint): (Request, &str, &str)| {
            if ui.button(name).on_hover_text(hint).remembered(name).clicked() {
                requests.push(request);
                ui.close();
            }
        };
        entry(ui, (Request::CopyLink, "Copy link", "To this picture: settings, views and time (C)"));
        let as_request = |(export, name, hint)| (Request::Export(export), name, hint);
        entry(ui, (Request::ShowFigure, FIGURE.0, FIGURE.1));
        match layout.in_sight()[..] {
            [] => {}
            [kind] => entry(ui, as_request((Export::Film(Some(kind)), FILM.0, FILM.1))),
            ref kinds => {
                let films = ui.menu_button(FILM.0, |ui| {
                    for kind in kinds {
                        entry(ui, as_request((Export::Film(Some(*kind)), view(*kind).name, FILM.1)));
                    }
                });
                films.response.remembered(FILM.0);
            }
        }
        entry(ui, as_request(REPORT));
        let data = ui.menu_button("Data…", |ui| {
            // Nothing is computed for a view that is not there.
            let is_there = |export: Export| match export {
                Export::Map => layout.shown().contains(&ViewKind::Map),
                Export::MonteCarlo => layout.shown().contains(&ViewKind::MonteCarlo),
                _ => true,
            };
            for one in DATA.into_iter().filter(|(export, ..)| is_there(*export)) {
                entry(ui, as_request(one));
            }
        });
        data.response.remembered("Data…");
        entry(ui, as_request(SESSION));
    });
    let button = named(button, "Export").remembered("Export");
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
