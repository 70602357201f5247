//! A session as a file: the picture on screen, with the choices in the laboratory.

use kalmanscope_core::{Document, DocumentError};
use serde::{Deserialize, Serialize};
use thiserror::Error;

use crate::laboratory::{Choice, SeedChoice, TuneChoice};
use crate::ruler::Ruler;
use crate::session::Mode;
use crate::share::{Picture, PictureError, Screen, outline_of_tiles};

/// The key by which such a file is recognised; its value is the format.
const KEY: &str = "kalmanscope_session";

/// The newest format. The first had tiles that name each other, no marks, and all of the legend.
const VERSION: u64 = 2;

/// The reason why a session cannot be read or written.
#[derive(Debug, Error)]
pub(crate) enum SessionFileError {
    #[error("it has format {0}, and this program reads formats up to {VERSION}")]
    Newer(u64),
    #[error("the session cannot be read: {0}")]
    Json(#[from] DocumentError),
    #[error(transparent)]
    Picture(#[from] PictureError),
}

/// The format.
#[derive(Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Written {
    kalmanscope_session: u64,
    /// The program's version.
    program: String,
    /// A scenario file.
    scenario: String,
    screen: Screen,
}

/// The first format, with one key per part.
#[derive(Deserialize)]
struct First {
    scenario: String,
    mode: Mode,
    speed: f64,
    time: f64,
    layout: Document,
    map: Option<Choice>,
    seeds: Option<SeedChoice>,
    tuning: Option<TuneChoice>,
}

/// The text of the file.
pub(crate) fn text(picture: &Picture) -> Result<String, SessionFileError> {
    let (screen, scenario) = picture.parts()?;
    let program = env!("CARGO_PKG_VERSION").to_owned();
    Ok(Document::json_lines(&Written { kalmanscope_session: VERSION, program, scenario, screen })?)
}

/// Reads the session in a file. `None` for another kind of file.
pub(crate) fn read(bytes: &[u8]) -> Option<Result<Picture, SessionFileError>> {
    if bytes.iter().find(|byte| !byte.is_ascii_whitespace()) != Some(&b'{') {
        return None;
    }
    let document = Document::from_json(std::str::from_utf8(bytes).ok()?).ok()?;
    let version = document.get(KEY)?.read().unwrap_or(u64::MAX);
    Some(match version {
        0 | 1 => first(&document),
        VERSION => newest(&document),
        _ => Err(SessionFileError::Newer(version)),
    })
}

fn newest(document: &Document) -> Result<Picture, SessionFileError> {
    let Written { scenario, screen, .. } = document.read()?;
    Ok(Picture::of_parts(screen, &scenario)?)
}

fn first(document: &Document) -> Result<Picture, SessionFileError> {
    let First { scenario, mode, speed, time, layout, map, seeds, tuning } = document.read()?;
    let views = outline_of_tiles(&layout).map_err(PictureError::Screen)?;
    let (enlarged, marks, hidden) = (None, Ruler::default(), Vec::new());
    let posterior = None;
    let screen = Screen { views, enlarged, map, seeds, tuning, posterior, mode, time, speed, marks, hidden };
    Ok(Picture::of_parts(screen, &scenario)?)
}

#[cfg(test)]
mod tests {
    use kalmanscope_core::Scenario;
    use serde_json::{Value, json};

    use super::*;
    use crate::layout::Layout;
    use crate::request::{Arrangement, LegendEntry, ViewKind};
    use crate::ruler::End;

    fn picture() -> Picture {
        let mut scenario = Scenario::default();
        scenario.number_filters();
        let mut picture = Picture::new(scenario, &Layout::of(Arrangement::Compare), Mode::Whole, 7.25);
        picture.ruler.place(End::A, 1.5);
        picture.ruler.place(End::B, 40.0);
        picture.hidden = vec![LegendEntry::Truth, LegendEntry::Filter(picture.scenario.filters[1].id)];
        picture.enlarged = Some(ViewKind::Scores);
        Picture { speed: 0.25, ..picture }
    }

    /// A file as a value to change.
    fn file() -> Value {
        serde_json::from_str(&text(&picture()).expect("it can be written")).expect("it is JSON")
    }

    /// A file of the first format.
    fn first_file() -> Value {
        let Picture { scenario, mode, speed, time, .. } = picture();
        let layout = serde_json::to_value(Layout::of(Arrangement::Compare).tree()).expect("a tree is data");
        let toml = scenario.to_toml().expect("it can be written");
        json!({
            "kalmanscope_session": 1, "program": "0.1.0", "scenario": toml, "mode": mode, "speed": speed, "time": time,
            "layout": layout,
        })
    }

    fn opened(file: &Value) -> Result<Picture, String> {
        read(file.to_string().as_bytes()).expect("it is a session").map_err(|error| error.to_string())
    }

    #[test]
    fn a_file_keeps_all_that_a_link_keeps() {
        let picture = picture();
        assert_eq!(opened(&file()), Ok(picture.clone()));
        let fragment = picture.fragment().expect("it is short");
        let link = fragment.strip_prefix(crate::share::MARK).expect("it is a link");
        assert_eq!(Picture::read(link).expect("it can be read"), picture);
    }

    #[test]
    fn a_file_of_the_first_format_can_be_read() {
        let (hidden, enlarged) = (Vec::new(), None);
        let expected = Picture { ruler: Ruler::default(), hidden, enlarged, ..picture() };
        assert_eq!(opened(&first_file()), Ok(expected));
    }

    #[test]
    fn impossible_files_are_refused_in_words() {
        let with = |mut file: Value, pointer: &str, value: Value| {
            *file.pointer_mut(pointer).expect("it is there") = value;
            file
        };
        let deep =
            |depth: usize| (0..depth).fold(json!({ "view": "States" }), |inner, _| json!({ "tabs": [0, [inner]] }));
        for (file, reason) in [
            (with(file(), "/kalmanscope_session", 3.into()), "it has format 3, and this program reads formats up to 2"),
            (with(file(), "/kalmanscope_session", "two".into()), "it has format"),
            (with(file(), "/screen/views", deep(20)), "more than 16 containers"),
            (with(file(), "/screen/views", json!({ "rows": [[1e38, { "view": "States" }]] })), "a share is 1"),
            (with(file(), "/screen/enlarged", "Phase".into()), "enlarged is not shown"),
            (with(file(), "/screen/time", (-1).into()), "the time is -1"),
            (with(file(), "/scenario", "dt = -1".into()), "`dt` is -1"),
            (with(file(), "/screen", json!({})), "missing field"),
            (with(first_file(), "/layout/height", 1e38.into()), "its height is 1e38"),
            (with(first_file(), "/speed", 0.into()), "the speed is 0"),
            (with(first_file(), "/layout", Value::Null), "cannot be shown"),
        ] {
            let refused = opened(&file).expect_err(reason);
            assert!(refused.contains(reason), "{refused}, not {reason}");
        }
        // So deep that not even the text is read: it is no session.
        let views = format!("{}null{}", r#"{"tabs":[0,["#.repeat(20_000), "]]}".repeat(20_000));
        let text = file().to_string().replace(&file()["screen"]["views"].to_string(), &views);
        assert!(text.len() > 200_000 && read(text.as_bytes()).is_none());
    }
}
