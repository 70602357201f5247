//! Files that may be a lesson or a scenario.

use kalmanscope_core::{Document, Scenario};

use crate::{Lesson, LessonError};

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
        let document = Document::from_toml(text)?;
        if OF_LESSONS.iter().any(|key| document.get(key).is_some()) {
            Lesson::from_toml(text).map(|lesson| Self::Lesson(Box::new(lesson)))
        } else {
            Ok(Self::Scenario(Box::new(Scenario::from_toml(text)?)))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{BUILT_IN, LESSONS};

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
