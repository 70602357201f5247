//! Reads the address of a page: a link, a lesson, a scenario, or only the plots.
//!
//! ```text
//! https://HOST/FOLDER/?embed&lesson=NAME&step=N#link=1.DATA
//! https://HOST/FOLDER/?scenario=NAME
//! ```

use kalmanscope_lessons::{BUILT_IN, BuiltIn, EQUATIONS, LESSONS};
use thiserror::Error;

use super::{LinkError, MARK, SavedPicture};

#[derive(Clone, Debug, PartialEq)]
pub enum LinkTarget {
    Picture(Box<SavedPicture>),
    Scenario(BuiltIn),
    Lesson(usize, usize),
}

#[derive(Debug, Error)]
pub enum AddressError {
    #[error("The link cannot be opened: {0}.")]
    Link(#[from] LinkError),
    #[error("There is no scenario “{name}”. The scenarios are {}.", known.join(", "))]
    Scenario { name: String, known: Vec<&'static str> },
    #[error("There is no lesson “{name}”. The lessons are {}.", known.join(", "))]
    Lesson { name: String, known: Vec<&'static str> },
    #[error("There is no step “{step}” of the lesson “{lesson}”: it has the steps 1 to {steps}.")]
    Step { step: String, lesson: String, steps: usize },
}

pub fn target(address: &str) -> Result<Option<LinkTarget>, AddressError> {
    if let Some((_, link)) = address.split_once(MARK) {
        return Ok(Some(LinkTarget::Picture(Box::new(SavedPicture::read(link.trim_end())?))));
    }
    if let Some(name) = value(address, "lesson") {
        let (place, step) = lesson(name, value(address, "step"))?;
        return Ok(Some(LinkTarget::Lesson(place, step)));
    }
    let built_in = value(address, "scenario").map(scenario).transpose()?;
    Ok(built_in.map(LinkTarget::Scenario))
}

pub fn is_embedded(address: &str) -> bool {
    value(address, "embed").is_some()
}

/// Whether an address accepts WebGPU by a software adapter, as tests do: `?gpu=software`.
pub fn allows_software_graphics(address: &str) -> bool {
    value(address, "gpu").is_some_and(|value| value == "software")
}

pub fn page(address: &str) -> &str {
    address.split(['?', '#']).next().unwrap_or_default()
}

fn scenario(name: &str) -> Result<BuiltIn, AddressError> {
    let unknown = || AddressError::Scenario {
        name: shortened(name),
        known: BUILT_IN.iter().chain(EQUATIONS).map(|scenario| scenario.file).collect(),
    };
    BuiltIn::named(name).copied().ok_or_else(unknown)
}

fn lesson(name: &str, step: Option<&str>) -> Result<(usize, usize), AddressError> {
    // The number orders the menu and may change; links of other pages must still open.
    let without_number = |file: &'static str| file.split_once('-').map_or(file, |(_, name)| name);
    let place = LESSONS.iter().position(|(file, _)| *file == name || without_number(file) == name);
    let place = place.ok_or_else(|| AddressError::Lesson {
        name: shortened(name),
        known: LESSONS.iter().map(|(file, _)| without_number(file)).collect(),
    })?;
    let Some(step) = step else { return Ok((place, 0)) };
    let lesson = kalmanscope_lessons::lessons().into_iter().nth(place).and_then(Result::ok);
    let steps = lesson.map_or(0, |lesson| lesson.steps.len());
    let number = step.parse().ok().filter(|number| (1..=steps).contains(number));
    let impossible = || AddressError::Step { step: shortened(step), lesson: name.to_owned(), steps };
    number.map(|number| (place, number - 1)).ok_or_else(impossible)
}

fn value<'a>(address: &'a str, key: &str) -> Option<&'a str> {
    let (_, query) = address.split('#').next()?.split_once('?')?;
    query
        .split('&')
        .map(|part| part.split_once('=').unwrap_or((part, "")))
        .find(|(name, _)| *name == key)
        .map(|it| it.1)
}

fn shortened(name: &str) -> String {
    // An address may have any length; a sentence on screen may not.
    name.chars().take(60).collect()
}
