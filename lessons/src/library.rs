//! The built-in lessons, and files that may be a lesson or a scenario.

use kalmanscope_core::Scenario;
use kalmanscope_core::document;

use crate::{Lesson, LessonError};

macro_rules! files {
    ($folder:literal: $($name:literal),* $(,)?) => {
        &[$(($name, include_str!(concat!("../assets/", $folder, "/", $name, ".toml")))),*]
    };
}

/// Every lesson in the menu's order: the name of its file and the text.
pub const LESSONS: &[(&str, &str)] = files!["lessons":
    "11-recursive-estimation",
    "12-predict-and-update",
    "13-noise-reduction",
    "14-state-and-parameters",
    "15-initialisation",
    "16-excitation",
    "21-model-assumptions",
    "22-process-noise",
    "23-sensor-noise",
    "24-learning-noise",
    "25-valley-of-q-and-r",
    "26-how-much-shakes-it",
    "31-sudden-loss",
    "32-fading-against-random-walk",
    "33-wind-up",
    "34-stiffness-staircase",
    "35-jump-fade-walk-or-bank",
    "36-live-lag-and-look-ahead",
    "41-decay-by-hand",
    "42-acceleration-only",
    "43-gravity-is-a-bias",
    "44-spike-and-gate",
    "45-sampling-that-jitters",
    "46-measured-record",
    "47-earthquake",
    "51-nonlinear-models",
    "52-ekf-against-ukf",
    "53-computational-cost",
    "54-map-of-guesses",
    "55-how-much-is-luck",
    "56-what-r-does-not-know",
    "57-straight-or-hard",
];

/// Every lesson in the menu's order. They are not validated, which takes longer than reading: a test has done it.
pub fn lessons() -> Vec<Result<Lesson, LessonError>> {
    LESSONS.iter().map(|(_, text)| Lesson::read(text)).collect()
}

/// The keys that a lesson has and a scenario has not.
const OF_LESSONS: [&str; 4] = ["title", "course", "summary", "steps"];

/// The contents of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum LibraryFile {
    /// A lesson.
    Lesson(Box<Lesson>),
    /// A scenario.
    Scenario(Box<Scenario>),
}

impl LibraryFile {
    /// Reads a file and checks it. It is a lesson where it has a key that only lessons have.
    ///
    /// # Errors
    /// [`LessonError`] where it is neither a possible lesson nor a possible scenario.
    pub fn from_toml(text: &str) -> Result<Self, LessonError> {
        let document = document::from_toml(text)?;
        if OF_LESSONS.iter().any(|key| document.get(key).is_some()) {
            Lesson::from_toml(text).map(|lesson| Self::Lesson(Box::new(lesson)))
        } else {
            Ok(Self::Scenario(Box::new(Scenario::from_toml(text)?)))
        }
    }
}
