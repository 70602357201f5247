//! Files that leave the explorer.

mod everything;
mod report;

use std::fmt::Display;

use kalmanscope_cli::write_estimates;

use crate::figure::Figure;
use crate::inbox::Done;
use crate::laboratory::Laboratory;
use crate::layout::Layout;
use crate::request::Export;
use crate::view::ViewContext;

#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    pub name: String,
    pub kind: &'static str,
    pub contents: Vec<u8>,
}

pub type Deliver = Box<dyn Fn(File, Done)>;

impl Export {
    pub const DATA: [Self; 8] = [
        Self::Report,
        Self::Estimates,
        Self::Record,
        Self::Map,
        Self::MonteCarlo,
        Self::Scenario,
        Self::All,
        Self::Session,
    ];

    pub(crate) fn name(self) -> String {
        match self {
            Self::Figure(format) => format!("{} (SVG)", format.name()),
            Self::Report => "Report (HTML)".to_owned(),
            Self::Estimates => "Estimates (CSV)".to_owned(),
            Self::Record => "Record (CSV)".to_owned(),
            Self::Map => "Map (CSV)".to_owned(),
            Self::MonteCarlo => "Monte Carlo (CSV)".to_owned(),
            Self::Scenario => "Scenario (TOML)".to_owned(),
            Self::All => "Everything (JSON)".to_owned(),
            Self::Session => "Session, to open again".to_owned(),
        }
    }

    pub(crate) fn hint(self) -> &'static str {
        match self {
            Self::Figure(_) => "The views on screen as outlines and text, for a document",
            Self::Report => "Verdicts, evidence, estimates, scores and figures as one page, to print or to send",
            Self::Estimates => "Every mean, standard deviation, innovation and prediction of every filter",
            Self::Map => "Every score of every cell of the map in the laboratory",
            Self::MonteCarlo => "Mean NEES and NIS, error quantiles and σ over time, of all seeds in the laboratory",
            Self::Record => "Force, measurements and truth, as the command line reads them",
            Self::Scenario => "The settings, for the command line or to be dropped on this window",
            Self::All => "Version, scenario, record, estimates and diagnosis, for a program",
            Self::Session => "Settings, views and playback; drop the file on this window to go on",
        }
    }
}

/// The file of an export. Results are those that have been computed so far.
///
/// # Errors
/// The reason why it cannot be made.
pub fn file(export: Export, context: &ViewContext<'_>, layout: &Layout) -> Result<File, String> {
    let session = context.session;
    Ok(match export {
        Export::Figure(format) => {
            let svg = Figure::new(context, &layout.rows(), format).svg();
            text(&format!("kalmanscope-{}.svg", format.key()), "image/svg+xml", svg)
        }
        Export::Report => text("report.html", "text/html", report::html(context, layout)?),
        Export::Estimates => csv("estimates.csv", |out| write_estimates(session.run(), out))?,
        Export::Record => csv("record.csv", |out| session.run().record().write_csv(out))?,
        Export::Map => text("map.csv", "text/csv", map(context)?),
        Export::MonteCarlo => text("monte-carlo.csv", "text/csv", seeds(context)?),
        Export::Scenario => text("scenario.toml", "application/toml", session.scenario().to_toml().map_err(reason)?),
        Export::All => text("kalmanscope.json", JSON, everything::json(session).map_err(reason)?),
        Export::Session => text("kalmanscope-session.json", JSON, written(context, layout)?),
    })
}

const JSON: &str = "application/json";

fn written(context: &ViewContext<'_>, layout: &Layout) -> Result<String, String> {
    context.picture(layout).lines().map_err(reason)
}

fn map(context: &ViewContext<'_>) -> Result<String, String> {
    let survey = context.laboratory.and_then(Laboratory::shown);
    Ok(survey.ok_or("there is no map yet: show the view Map")?.to_csv())
}

fn seeds(context: &ViewContext<'_>) -> Result<String, String> {
    let runs = context.laboratory.and_then(|laboratory| laboratory.seeds().shown());
    Ok(runs.ok_or("no seed has been run yet: show the view Monte Carlo")?.to_csv())
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
