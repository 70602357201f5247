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
    "01-recursive-estimation",
    "02-noise-reduction",
    "03-nonlinear-models",
    "04-state-and-parameters",
    "05-model-assumptions",
    "06-computational-cost",
    "07-initialisation",
    "08-instability",
    "09-predict-and-update",
    "10-sudden-loss",
    "11-slow-drift",
    "12-wind-up",
    "13-process-noise",
    "14-sensor-noise",
    "15-learning-noise",
    "16-excitation",
    "17-acceleration-only",
    "18-overconfident-guess",
    "19-ekf-against-ukf",
    "20-measured-record",
    "21-input-between-samples",
    "22-earthquake",
    "23-stiffness-staircase",
    "24-map-of-guesses",
    "25-valley-of-q-and-r",
    "26-fading-against-random-walk",
    "27-how-much-is-luck",
    "28-jump-in-place-of-fading",
    "29-decay-by-hand",
    "30-spike-and-gate",
    "31-gravity-is-a-bias",
    "32-live-lag-and-look-ahead",
    "33-sampling-that-jitters",
    "34-straight-or-hard",
    "35-jump-fade-walk-or-bank",
    "36-what-r-does-not-know",
    "37-how-much-shakes-it",
];

/// Every lesson in the menu's order. They are not validated, which takes longer than reading: a test has done it.
pub fn lessons() -> Vec<Result<Lesson, LessonError>> {
    LESSONS.iter().map(|(_, text)| Lesson::read(text)).collect()
}

/// The keys that a lesson has and a scenario has not.
const OF_LESSONS: [&str; 4] = ["title", "group", "summary", "steps"];

/// The contents of a file.
#[derive(Clone, Debug, PartialEq)]
pub enum File {
    /// A lesson.
    Lesson(Box<Lesson>),
    /// A scenario.
    Scenario(Box<Scenario>),
}

impl File {
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
mod tests {
    use crate::BUILT_IN;

    use super::*;

    fn files(folder: &str) -> Vec<String> {
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
    fn many_lessons_begin_with_a_question() {
        let lessons = lessons().into_iter().filter_map(Result::ok);
        assert!(lessons.filter(|lesson| lesson.steps[0].question.is_some()).count() >= 6);
    }

    #[test]
    fn every_lesson_is_valid_and_complete() {
        for (name, text) in LESSONS {
            let lesson = Lesson::from_toml(text).unwrap_or_else(|error| panic!("{name}: {error}"));
            assert!(["Advantages", "Challenges", "Practice"].contains(&lesson.group.as_str()), "{name}");
            assert!((2..=4).contains(&lesson.steps.len()), "{name}: {} steps", lesson.steps.len());
            assert!(lesson.summary.ends_with('.'), "{name}");
            let same = LESSONS.iter().filter(|(_, text)| text.contains(&format!("title = \"{}\"\n", lesson.title)));
            assert_eq!(same.count(), 1, "a lesson is known by its title: {name}");
            for (number, step) in lesson.steps.iter().enumerate() {
                let texts = [&step.look, &step.happens, &step.why];
                assert!(texts.iter().all(|t| t.ends_with('.') && t.len() > 20), "{name}, step {}", number + 1);
                assert!(
                    step.change.as_ref().is_none_or(|change| change.label.len() > 2),
                    "{name}, step {}",
                    number + 1
                );
                if let Some(question) = &step.question {
                    assert!(question.ask.ends_with('?'), "{name}, step {}", number + 1);
                    assert!(
                        question.because.ends_with('.') && question.because.len() > 20,
                        "{name}, step {}",
                        number + 1
                    );
                }
                assert!(!step.views.is_empty() && !step.checks.is_empty(), "{name}, step {}", number + 1);
            }
        }
    }

    #[test]
    fn lessons_and_scenarios_are_told_apart() {
        assert!(matches!(File::from_toml(LESSONS[0].1), Ok(File::Lesson(_))));
        assert!(matches!(File::from_toml(BUILT_IN[0].toml()), Ok(File::Scenario(_))));
        assert_eq!(File::from_toml("").unwrap(), File::Scenario(Box::default()));
    }

    #[test]
    fn errors_are_those_of_the_kind_of_file() {
        for (text, part) in
            [("title = 1", "invalid type"), ("steps = []", "missing field"), ("fading = 1", "fading"), ("=", "TOML")]
        {
            let error = File::from_toml(text).unwrap_err().to_string();
            assert!(error.contains(part), "{error}");
        }
    }
}
