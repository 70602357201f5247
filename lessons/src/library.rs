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

#[cfg(test)]
pub(crate) mod tests {
    use crate::BUILT_IN;

    use super::*;

    /// The names of the files in a folder of the assets, without their ending.
    pub(crate) fn files(folder: &str) -> Vec<String> {
        let folder = format!("{}/assets/{folder}", env!("CARGO_MANIFEST_DIR"));
        let name = |file: std::io::Result<std::fs::DirEntry>| file.unwrap().file_name().into_string().unwrap();
        let mut names: Vec<String> = std::fs::read_dir(folder).unwrap().map(name).collect();
        names.sort();
        names.into_iter().map(|name| name.trim_end_matches(".toml").to_owned()).collect()
    }

    #[test]
    fn each_file_is_in_its_list() {
        assert_eq!(files("lessons"), LESSONS.iter().map(|(name, _)| *name).collect::<Vec<_>>());
    }

    #[test]
    fn five_courses_have_five_to_nine_lessons_and_the_first_lesson_asks() {
        let lessons: Vec<Lesson> = lessons().into_iter().filter_map(Result::ok).collect();
        let courses: Vec<&[Lesson]> = lessons.chunk_by(|one, next| one.course == next.course).collect();
        let names: Vec<&str> = courses.iter().map(|course| course[0].course.as_str()).collect();
        let expected = ["Start here", "Tune Q and R", "When things change", "Sensors and records", "Know when it lies"];
        assert_eq!(names, expected);
        assert!(courses.iter().all(|course| (5..=9).contains(&course.len())), "{names:?}");
        assert!(lessons[0].steps[0].question.is_some());
    }

    #[test]
    fn every_lesson_is_valid_and_complete() {
        for (name, text) in LESSONS {
            let lesson = Lesson::from_toml(text).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(lesson.picture.is_some() && (2..=12).contains(&lesson.minutes()), "{name}: {}", lesson.minutes());
            assert!((2..=4).contains(&lesson.steps.len()), "{name}: {} steps", lesson.steps.len());
            assert!(lesson.summary.ends_with('.'), "{name}");
            let same = LESSONS.iter().filter(|(_, text)| text.contains(&format!("title = \"{}\"\n", lesson.title)));
            assert_eq!(same.count(), 1, "a lesson is known by its title: {name}");
            for (number, step) in lesson.steps.iter().enumerate() {
                let because = step.question.iter().map(|question| &question.because);
                let mut texts = [&step.look, &step.happens, &step.why].into_iter().chain(because);
                assert!(texts.all(|t| t.ends_with('.') && t.len() > 20), "{name}, step {}", number + 1);
                assert!(
                    step.question.iter().all(|question| question.ask.ends_with('?')),
                    "{name}, step {}",
                    number + 1
                );
                assert!(!step.views.is_empty() && !step.checks.is_empty(), "{name}, step {}", number + 1);
            }
        }
    }

    #[test]
    fn lessons_and_scenarios_are_told_apart() {
        assert!(matches!(LibraryFile::from_toml(LESSONS[0].1), Ok(LibraryFile::Lesson(_))));
        assert!(matches!(LibraryFile::from_toml(BUILT_IN[0].toml()), Ok(LibraryFile::Scenario(_))));
        assert_eq!(LibraryFile::from_toml("").unwrap(), LibraryFile::Scenario(Box::default()));
    }

    #[test]
    fn errors_are_those_of_the_kind_of_file() {
        for (text, part) in
            [("title = 1", "invalid type"), ("steps = []", "missing field"), ("fading = 1", "fading"), ("=", "TOML")]
        {
            let error = LibraryFile::from_toml(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
