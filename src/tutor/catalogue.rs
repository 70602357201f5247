//! The lessons on offer, and which of them are finished.

use std::collections::BTreeSet;
use std::sync::LazyLock;

use kalmanscope_lessons::Lesson;

pub struct Catalogue {
    lessons: LazyLock<Vec<Lesson>>,
    /// The titles of the finished lessons, also of those that this program does not have.
    finished: BTreeSet<String>,
}

impl Default for Catalogue {
    fn default() -> Self {
        let read = || kalmanscope_lessons::lessons().into_iter().filter_map(Result::ok).collect();
        Self { lessons: LazyLock::new(read), finished: BTreeSet::new() }
    }
}

impl Catalogue {
    pub(crate) fn with_finished(finished: BTreeSet<String>) -> Self {
        Self { finished, ..Self::default() }
    }

    pub(crate) fn lessons(&self) -> &[Lesson] {
        &self.lessons
    }

    pub(crate) fn at(&self, place: usize) -> Option<&Lesson> {
        self.lessons.get(place)
    }

    pub(crate) fn place_of(&self, title: &str) -> Option<usize> {
        self.lessons.iter().position(|lesson| lesson.title == title)
    }

    pub(crate) fn finish(&mut self, place: usize) {
        let title = self.at(place).map(|lesson| lesson.title.clone());
        self.finished.extend(title);
    }

    pub(crate) fn is_finished(&self, lesson: &Lesson) -> bool {
        self.finished.contains(&lesson.title)
    }

    pub(crate) fn finished(&self) -> &BTreeSet<String> {
        &self.finished
    }
}
