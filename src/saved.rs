//! The saved session, and the reasons why parts of it may be unreadable.

use egui::ThemePreference;
use kalmanscope_core::{Document, DocumentError, Scenario};
use kalmanscope_lessons::BuiltIn;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::laboratory::{Choice, Choices, SeedChoice, TuneChoice};
use crate::layout::Layout;
use crate::request::{LegendEntry, ViewKind};
use crate::ruler::Ruler;
use crate::session::{Mode, Session};
use crate::share::{Outline, outline_of_tiles};
use crate::tutor::Studies;

/// The storage key of the saved session.
pub const KEY: &str = "kalmanscope";

/// The storage key of the last text under [`KEY`] that could not be read in full; the next save would overwrite it.
pub const UNREADABLE_KEY: &str = "kalmanscope-unreadable";

/// The newest format. The first had no number, and its layout was JSON within JSON; the layout of the second was tiles that name
/// each other.
const VERSION: u64 = 3;

/// The state that outlasts the program.
#[derive(Clone, Debug, PartialEq)]
pub struct Saved {
    pub(crate) scenario: Scenario,
    pub(crate) mode: Mode,
    pub(crate) speed: f64,
    pub(crate) presenting: bool,
    /// The theme; the system's if none was chosen.
    pub(crate) dark: Option<bool>,
    pub(crate) views: Option<Outline>,
    pub(crate) enlarged: Option<ViewKind>,
    pub(crate) ruler: Ruler,
    pub(crate) hidden: Vec<LegendEntry>,
    /// Whether all settings are shown, and not only those that the story names.
    pub(crate) all_settings: bool,
    pub(crate) laboratory: Choices,
    pub(crate) studies: Studies,
    /// The text of a session that could not be read in full.
    pub(crate) unreadable: Option<String>,
}

/// The result of reading a saved session.
pub(crate) struct Found {
    /// Each part as it was saved, or its default.
    pub(crate) saved: Saved,
    /// Whether nothing had been saved.
    pub(crate) new_here: bool,
    /// The reason why it could not be read in full.
    pub(crate) problem: Option<String>,
}

/// The format, with one key per part.
#[derive(Serialize)]
struct Written<'a> {
    version: u64,
    /// A scenario file.
    scenario: String,
    mode: Mode,
    speed: f64,
    presenting: bool,
    dark: Option<bool>,
    views: &'a Option<Outline>,
    enlarged: Option<ViewKind>,
    marks: Ruler,
    hidden: &'a [LegendEntry],
    all_settings: bool,
    map: &'a Option<Choice>,
    seeds: &'a Option<SeedChoice>,
    tuning: &'a Option<TuneChoice>,
    posterior: Option<u32>,
    lessons: &'a Studies,
}

impl Default for Saved {
    fn default() -> Self {
        Self {
            scenario: BuiltIn::FIRST.scenario().unwrap_or_default(),
            mode: Mode::default(),
            speed: Session::DEFAULT_SPEED,
            presenting: false,
            dark: None,
            views: usual_views(),
            enlarged: None,
            ruler: Ruler::default(),
            hidden: Vec::new(),
            all_settings: false,
            laboratory: Choices::default(),
            studies: Studies::default(),
            unreadable: None,
        }
    }
}

/// The views of a first start.
fn usual_views() -> Option<Outline> {
    Outline::of(Layout::default().tree())
}

impl Saved {
    /// The session that was saved last.
    pub(crate) fn load(storage: Option<&dyn eframe::Storage>) -> Found {
        let Some(text) = storage.and_then(|storage| storage.get_string(KEY)) else {
            return Found { saved: Self::default(), new_here: true, problem: None };
        };
        let (mut saved, problems) = Self::read(&text);
        let problem = (!problems.is_empty()).then(|| problems.join("; "));
        saved.unreadable = problem.is_some().then_some(text);
        Found { saved, new_here: false, problem }
    }

    /// Writes the session into a storage, and keeps the text of an unreadable one under its own key.
    ///
    /// # Errors
    /// [`DocumentError`] where the scenario cannot be written.
    pub fn store(&self, storage: &mut dyn eframe::Storage) -> Result<(), DocumentError> {
        let Self { unreadable, .. } = self;
        if let Some(text) = unreadable {
            storage.set_string(UNREADABLE_KEY, text.clone());
        }
        storage.set_string(KEY, self.text()?);
        Ok(())
    }

    /// The session as text.
    ///
    /// # Errors
    /// [`DocumentError`] where the scenario cannot be written.
    pub fn text(&self) -> Result<String, DocumentError> {
        let Self {
            scenario,
            mode,
            speed,
            presenting,
            dark,
            views,
            enlarged,
            ruler,
            hidden,
            all_settings,
            laboratory,
            ..
        } = self;
        let Choices { map, seeds, tuning, posterior } = laboratory;
        Document::json(&Written {
            version: VERSION,
            scenario: scenario.to_toml().map_err(serde::ser::Error::custom)?,
            mode: *mode,
            speed: *speed,
            presenting: *presenting,
            dark: *dark,
            views,
            enlarged: *enlarged,
            marks: *ruler,
            hidden,
            all_settings: *all_settings,
            map,
            seeds,
            tuning,
            posterior: *posterior,
            lessons: &self.studies,
        })
    }

    /// The views.
    pub(crate) fn layout(&self) -> Layout {
        Layout::of_outline(self.views.as_ref(), self.enlarged)
    }

    /// The parts that can be read, defaults for the others, and the reasons.
    fn read(text: &str) -> (Self, Vec<String>) {
        let document = match Document::from_json(text) {
            Ok(document @ Document::Table(_)) => document,
            Ok(_) => return (Self::default(), vec!["it is not an object".to_owned()]),
            Err(error) => return (Self::default(), vec![error.to_string()]),
        };
        let mut reader = Reader { document, problems: Vec::new() };
        let version: u64 = reader.part("version", 1);
        if version > VERSION {
            reader.problems.push(format!("it has version {version}, and this program reads versions up to {VERSION}"));
        }
        if !reader.problems.is_empty() {
            return (Self::default(), reader.problems);
        }
        let usual = Self::default();
        let views = reader.views(version);
        let saved = Self {
            scenario: reader.scenario(),
            mode: reader.part("mode", usual.mode),
            speed: reader.speed(usual.speed),
            presenting: reader.part("presenting", usual.presenting),
            dark: reader.part("dark", usual.dark),
            enlarged: reader.enlarged(views.as_ref()),
            views,
            ruler: reader.part("marks", usual.ruler),
            hidden: reader.part("hidden", usual.hidden),
            // Sessions from before it could be chosen had all of them.
            all_settings: reader.part("all_settings", true),
            laboratory: reader.laboratory(),
            studies: reader.part("lessons", usual.studies),
            unreadable: None,
        };
        (saved, reader.problems)
    }

    /// Applies the chosen theme.
    pub(crate) fn apply_theme(&self, ctx: &egui::Context) {
        if let Some(dark) = self.dark {
            ctx.set_theme(if dark { ThemePreference::Dark } else { ThemePreference::Light });
        }
    }
}

/// Reads one part after the other, and notes the unreadable ones.
struct Reader {
    document: Document,
    problems: Vec<String>,
}

impl Reader {
    /// The part under a key, or its default if it is missing or unreadable.
    fn part<T: DeserializeOwned>(&mut self, key: &str, usual: T) -> T {
        let part = self.document.get(key).map(Document::read);
        part.and_then(|part| self.note(key, part)).unwrap_or(usual)
    }

    fn note<T>(&mut self, key: &str, part: Result<T, impl std::fmt::Display>) -> Option<T> {
        part.map_err(|error| self.problems.push(format!("{key}: {error}"))).ok()
    }

    fn scenario(&mut self) -> Scenario {
        let file: String = self.part("scenario", String::new());
        self.note("scenario", Scenario::from_toml(&file)).unwrap_or_default()
    }

    fn speed(&mut self, usual: f64) -> f64 {
        let speed = self.part("speed", usual);
        let possible = if speed > 0.0 { Ok(speed) } else { Err(format!("{speed} is not above 0")) };
        self.note("speed", possible).unwrap_or(usual)
    }

    fn laboratory(&mut self) -> Choices {
        let seeds: Option<SeedChoice> = self.part("seeds", None);
        let checked = seeds.map(|seeds| seeds.check().map(|()| seeds));
        let seeds = checked.and_then(|seeds| self.note("seeds", seeds));
        let (map, tuning, posterior) =
            (self.part("map", None), self.part("tuning", None), self.part("posterior", None));
        Choices { map, seeds, tuning, posterior }
    }

    fn views(&mut self, version: u64) -> Option<Outline> {
        let views = match version {
            0 | 1 => {
                let text: String = self.part("layout", String::new());
                if text.is_empty() {
                    return usual_views();
                }
                Document::from_json(&text).map_err(|error| error.to_string()).and_then(|layout| of_tiles(&layout))
            }
            2 => self.document.get("layout").map_or_else(|| Ok(usual_views()), of_tiles),
            _ => self.document.get("views").map_or_else(|| Ok(usual_views()), outline),
        };
        self.note("layout", views).unwrap_or_else(usual_views)
    }

    fn enlarged(&mut self, views: Option<&Outline>) -> Option<ViewKind> {
        let enlarged: Option<ViewKind> = self.part("enlarged", None);
        enlarged.filter(|view| views.is_some_and(|views| views.has(*view)))
    }
}

/// The views of a layout of tiles that name each other.
fn of_tiles(layout: &Document) -> Result<Option<Outline>, String> {
    outline_of_tiles(layout.get("tree").ok_or("it has no tree")?)
}

/// The views of an outline, checked.
fn outline(views: &Document) -> Result<Option<Outline>, String> {
    let views: Option<Outline> = views.read().map_err(|error| error.to_string())?;
    views.as_ref().map_or(Ok(()), Outline::validate)?;
    Ok(views)
}

#[cfg(test)]
mod tests;
