//! Messages between the page and one that embeds it, as JSON. `docs/embed.md` has the whole set.

use kalmanscope_core::{Document, Scenario};
use serde::Deserialize;

use super::address::{self, Target};
use crate::request::Request;
use crate::session::Mode;

/// The newest set of messages.
const VERSION: i64 = 1;

/// Limits the characters of a message.
pub const LONGEST: usize = 65_536;

/// Limits the characters of the name that a message has in its answer.
const LONGEST_ID: usize = 100;

/// A message that can be followed.
#[derive(Debug, PartialEq)]
pub struct Message {
    /// The name of the message, which its answer repeats.
    pub id: Document,
    /// The request in it.
    pub wish: Wish,
}

/// A request of another page.
#[derive(Debug, PartialEq)]
pub enum Wish {
    /// To change the screen.
    Set(Vec<Request>),
    /// To tell something.
    Get(Topic),
}

/// The values that another page can read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Topic {
    /// Playback and the latest estimates.
    State,
    /// A link to the picture.
    Link,
    /// The scenario as TOML.
    Scenario,
}

/// The reason why a message is not followed.
#[derive(Debug, PartialEq)]
pub struct Refusal {
    /// The name of the message. `None` if the message is not one of ours; it then gets no answer.
    pub id: Option<Document>,
    /// The sentence.
    pub reason: String,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    #[serde(rename = "kalmanscope")]
    _version: u64,
    #[serde(default, rename = "id")]
    _id: Option<Document>,
    set: Option<Set>,
    get: Option<Topic>,
}

#[derive(Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
struct Set {
    link: Option<String>,
    scenario: Option<String>,
    lesson: Option<String>,
    step: Option<u32>,
    toml: Option<String>,
    mode: Option<WrittenMode>,
    speed: Option<f64>,
    time: Option<f64>,
    playing: Option<bool>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum WrittenMode {
    Live,
    Whole,
}

impl Message {
    /// Reads and checks a message.
    ///
    /// # Errors
    /// [`Refusal`] where it is too long, not one of ours, of a newer version, or asks for something impossible.
    pub fn read(text: &str) -> Result<Self, Refusal> {
        let foreign = |reason: &str| Refusal { id: None, reason: reason.to_owned() };
        if text.len() > LONGEST {
            return Err(foreign(&format!("A message is longer than {LONGEST} characters.")));
        }
        let value = Document::from_json(text).map_err(|_| foreign("A message is not an object."))?;
        let Some(version) = value.get("kalmanscope") else {
            return Err(foreign("A message has no key `kalmanscope`."));
        };
        let id = value.get("id").filter(|id| is_name(id)).cloned().unwrap_or(Document::Null);
        let refused = |reason: String| Refusal { id: Some(id.clone()), reason };
        if *version != Document::Integer(VERSION) {
            let version = Document::json(version).unwrap_or_default();
            return Err(refused(format!("The version of a message is {version}, but must be {VERSION}.")));
        }
        // A list would be read as an object's values.
        if value.get("set").is_some_and(|set| !matches!(set, Document::Table(_))) {
            return Err(refused("The value of `set` must be an object.".to_owned()));
        }
        let Written { set, get, .. } =
            value.read().map_err(|error| refused(format!("A message is impossible: {error}.")))?;
        let wish = match (set, get) {
            (Some(set), None) => Wish::Set(set.requests().map_err(refused)?),
            (None, Some(topic)) => Wish::Get(topic),
            _ => return Err(refused("A message has either `set` or `get`.".to_owned())),
        };
        Ok(Self { id, wish })
    }
}

impl Refusal {
    /// The answer, if there is one.
    pub fn answer(&self) -> Option<Document> {
        self.id.as_ref().map(|id| answer_error(id, &self.reason))
    }
}

/// The answer to a message.
pub fn answer(id: &Document, key: &str, contents: Document) -> Document {
    Document::of_entries([("kalmanscope", Document::Integer(VERSION)), ("id", id.clone()), (key, contents)])
}

/// The answer with the reason of a failure.
pub(crate) fn answer_error(id: &Document, reason: &str) -> Document {
    answer(id, "error", reason.into())
}

/// The message that the page can be spoken to from now on.
pub fn ready() -> Document {
    let version = env!("CARGO_PKG_VERSION").into();
    Document::of_entries([("kalmanscope", Document::Integer(VERSION)), ("ready", version)])
}

impl Set {
    /// The requests, first that for something to show, then those for playback.
    fn requests(self) -> Result<Vec<Request>, String> {
        let Self { link, scenario, lesson, step, toml, mode, speed, time, playing } = self;
        let named = [link.is_some(), scenario.is_some(), lesson.is_some(), toml.is_some()];
        if named.into_iter().filter(|is_named| *is_named).count() > 1 {
            return Err("A message has at most one of `link`, `scenario`, `lesson` and `toml`.".to_owned());
        }
        if step.is_some() && lesson.is_none() {
            return Err("A message with a `step` needs a `lesson`.".to_owned());
        }
        let mut requests = if let Some(link) = link {
            match address::target(&link).map_err(|error| error.to_string())? {
                Some(Target::Picture(_)) => vec![Request::OpenAddress(link)],
                _ => return Err(format!("A `link` must have `{}` in it.", super::MARK)),
            }
        } else if let Some(name) = scenario {
            vec![Request::Open(address::scenario(&name).map_err(|error| error.to_string())?)]
        } else if let Some(name) = lesson {
            let step = step.map(|step| step.to_string());
            let (place, step) = address::lesson(&name, step.as_deref()).map_err(|error| error.to_string())?;
            vec![Request::StartLesson(place), Request::GoToStep(step)]
        } else if let Some(toml) = toml {
            let scenario =
                Scenario::from_toml(&toml).map_err(|error| format!("A scenario cannot be used: {error}."))?;
            vec![Request::OpenScenario(Box::new(scenario))]
        } else {
            Vec::new()
        };
        requests.extend(mode.map(|mode| match mode {
            WrittenMode::Live => Request::SetMode(Mode::Live),
            WrittenMode::Whole => Request::SetMode(Mode::Whole),
        }));
        if speed.is_some_and(|speed| !(0.01..=100.0).contains(&speed)) {
            return Err("The `speed` must be from 0.01 to 100.".to_owned());
        }
        if time.is_some_and(|time| time < 0.0 || !time.is_finite()) {
            return Err("The `time` must be 0 or more.".to_owned());
        }
        requests.extend(speed.map(Request::SetSpeed));
        requests.extend(time.map(Request::Seek));
        requests.extend(playing.map(Request::Play));
        Ok(requests)
    }
}

/// Whether a message's name is short enough to be repeated: a number, or a text of at most [`LONGEST_ID`].
fn is_name(id: &Document) -> bool {
    match id {
        Document::Text(text) => text.len() <= LONGEST_ID,
        Document::Integer(_) | Document::Large(_) | Document::Number(_) => true,
        _ => false,
    }
}
