//! The saved session, and the reasons why parts of it may be unreadable.

use egui::ThemePreference;
use kalmanscope_core::{Document, Scenario};
use kalmanscope_lessons::BuiltIn;
use serde::Serialize;
use serde::de::DeserializeOwned;

use crate::laboratory::{Choice, Choices, SeedChoice, TuneChoice};
use crate::layout::Layout;
use crate::session::{Mode, Session};
use crate::tutor::Studies;

/// The storage key of the saved session.
const KEY: &str = "kalmanscope";

/// The storage key of the last text under [`KEY`] that could not be read in full; the next save would overwrite it.
const UNREADABLE_KEY: &str = "kalmanscope-unreadable";

/// The newest format. The first had no number, and its layout was JSON within JSON.
const VERSION: u64 = 2;

/// The saved state.
pub(crate) struct Saved {
    pub(crate) scenario: Scenario,
    pub(crate) mode: Mode,
    pub(crate) speed: f64,
    pub(crate) presenting: bool,
    /// The theme; the system's if none was chosen.
    dark: Option<bool>,
    pub(crate) layout: Layout,
    pub(crate) laboratory: Choices,
    pub(crate) studies: Studies,
}

/// The result of reading a saved session.
pub(crate) struct Found {
    /// Each part as it was saved, or its default.
    pub(crate) saved: Saved,
    /// Whether nothing had been saved.
    pub(crate) new_here: bool,
    /// The text and the reason why it could not be read in full.
    pub(crate) unreadable: Option<(String, String)>,
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
    layout: &'a Layout,
    map: Option<Choice>,
    seeds: Option<SeedChoice>,
    tuning: Option<TuneChoice>,
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
            layout: Layout::default(),
            laboratory: Choices::default(),
            studies: Studies::default(),
        }
    }
}

impl Saved {
    /// The session that was saved last.
    pub(crate) fn load(storage: Option<&dyn eframe::Storage>) -> Found {
        let Some(text) = storage.and_then(|storage| storage.get_string(KEY)) else {
            return Found { saved: Self::default(), new_here: true, unreadable: None };
        };
        let (saved, problems) = Self::read(&text);
        let unreadable = (!problems.is_empty()).then(|| (text, problems.join("; ")));
        Found { saved, new_here: false, unreadable }
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
        let saved = Self {
            scenario: reader.scenario(),
            mode: reader.part("mode", usual.mode),
            speed: reader.speed(usual.speed),
            presenting: reader.part("presenting", usual.presenting),
            dark: reader.part("dark", usual.dark),
            layout: reader.layout(version),
            laboratory: reader.laboratory(),
            studies: reader.part("lessons", usual.studies),
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
    /// The part under a key, or its default where it is missing or unreadable.
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
        Choices { map: self.part("map", None), seeds, tuning: self.part("tuning", None) }
    }

    fn layout(&mut self, version: u64) -> Layout {
        if version > 1 {
            return self.part("layout", Layout::default());
        }
        let text: String = self.part("layout", String::new());
        let layout = (!text.is_empty()).then(|| Document::read_json(&text));
        layout.and_then(|layout| self.note("layout", layout)).unwrap_or_default()
    }
}

/// Saves a session, and keeps the text of an unreadable one under its own key.
pub(crate) fn save(
    storage: &mut dyn eframe::Storage,
    session: &Session,
    (layout, laboratory): (&Layout, Choices),
    studies: &Studies,
    presenting: bool,
    theme: ThemePreference,
    unreadable: Option<&str>,
) {
    if let Some(text) = unreadable {
        storage.set_string(UNREADABLE_KEY, text.to_owned());
    }
    let scenario = match session.scenario().to_toml() {
        Ok(scenario) => scenario,
        Err(error) => return log::error!("The session is not saved: {error}"),
    };
    let dark = match theme {
        ThemePreference::Dark => Some(true),
        ThemePreference::Light => Some(false),
        ThemePreference::System => None,
    };
    let (mode, speed) = (session.mode(), session.speed());
    let lessons = studies;
    let Choices { map, seeds, tuning } = laboratory;
    match Document::json(&Written {
        version: VERSION,
        scenario,
        mode,
        speed,
        presenting,
        dark,
        layout,
        map,
        seeds,
        tuning,
        lessons,
    }) {
        Ok(text) => storage.set_string(KEY, text),
        Err(error) => log::error!("The session is not saved: {error}"),
    }
}
