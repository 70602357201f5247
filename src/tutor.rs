//! A lesson in progress. Each step has something to look at, a question, a change, its effect and an explanation.

mod menu;
mod panel;

use std::collections::BTreeSet;
use std::sync::LazyLock;

use kalmanscope_core::{Axis, Scenario};
use kalmanscope_lessons::{Lesson, LessonError, LessonStep, Map, Presentation, Question, ViewName};

use crate::kinds::{Answer, ViewKind};
use crate::laboratory::MapChoice;
use crate::session::{Mode, Session};
use crate::share::Bookmark;
use crate::team::Precision;
use crate::visibility::Visibility;

pub(crate) use menu::{invitation_ui, menu_ui};
pub(crate) use panel::text_id;

pub struct Tutor {
    lesson: Lesson,
    /// The lesson's place in the menu; `None` for a lesson from a file.
    pub(crate) place: Option<usize>,
    pub(crate) step: usize,
    changed: bool,
    answer: Option<Answer>,
    lit: Vec<String>,
}

impl Tutor {
    pub(crate) fn new(lesson: Lesson, place: Option<usize>) -> Self {
        Self { lesson, place, step: 0, changed: false, answer: None, lit: Vec::new() }
    }

    pub(crate) fn at_bookmark(lesson: Lesson, place: usize, bookmark: &Bookmark) -> Option<Self> {
        let Bookmark { lesson: _, step, changed, answer } = *bookmark;
        (step < lesson.steps.len()).then(|| Self { step, changed, answer, ..Self::new(lesson, Some(place)) })
    }

    pub(crate) fn bookmark(&self) -> Option<Bookmark> {
        let Self { lesson, place, step, changed, answer, lit: _ } = self;
        place.map(|_| Bookmark { lesson: lesson.title.clone(), step: *step, changed: *changed, answer: *answer })
    }

    pub fn title(&self) -> &str {
        &self.lesson.title
    }

    fn current(&self) -> Option<&LessonStep> {
        self.lesson.steps.get(self.step)
    }

    fn open_question(&self) -> Option<&Question> {
        self.current()?.question.as_ref().filter(|_| self.answer.is_none())
    }

    fn is_revealed(&self) -> bool {
        self.open_question().is_none() && self.current().is_some_and(|step| self.changed || step.change.is_none())
    }

    pub fn views(&self) -> Vec<ViewKind> {
        self.current().map_or(vec![], |step| step.views.iter().map(|view| kind(*view)).collect())
    }

    pub(crate) fn map(&self, scenario: &Scenario) -> Result<Option<MapChoice>, String> {
        let Some(map) = self.current().and_then(|step| step.map.as_ref()) else { return Ok(None) };
        match map.missing_filter(scenario) {
            None => choice_of(map, scenario).map(Some),
            Some(missing) if *missing == map.filter => Ok(None),
            // The step's change adds the second filter.
            Some(_) => choice_of(&Map { second: None, ..map.clone() }, scenario).map(Some),
        }
    }

    /// Lessons name filters, and the user may rename them: an address that is found is kept with the filter's id.
    pub(crate) fn lit(&mut self, scenario: &Scenario) -> Vec<String> {
        if self.lit.is_empty()
            && let Some(change) = self.current().and_then(|step| step.change.as_ref())
        {
            self.lit = change.paths();
        }
        for path in &mut self.lit {
            *path = scenario.address_by_id(path);
        }
        self.lit.clone()
    }

    pub fn choose(&self, visible: &mut Visibility) {
        if let Some(step) = self.current() {
            visible.only.clone_from(&step.channels);
            visible.bands = step.bands;
            visible.verdicts |= step.speaks_of_verdicts() && self.open_question().is_none();
        }
    }

    pub fn frame(&self, session: &Session) -> Option<(f64, f64)> {
        let step = self.current().filter(|step| step.mode != Presentation::Live && self.waits_at().is_none())?;
        let (from, to) = (step.from.unwrap_or(0.0), step.to.unwrap_or(session.end()).min(session.end()));
        ((step.from.is_some() || step.to.is_some()) && from < to).then_some((from, to))
    }

    fn waits_at(&self) -> Option<f64> {
        self.open_question()?.until
    }

    pub fn go_to(&mut self, step: usize, session: &mut Session) -> Result<(), LessonError> {
        self.step = step.min(self.lesson.steps.len().saturating_sub(1));
        self.changed = false;
        self.lit.clear();
        self.answer = None;
        let scenario = match self.step.checked_sub(1) {
            Some(before) => self.lesson.scenario_at(before)?,
            None => self.lesson.first_scenario()?,
        };
        session.set_scenario(scenario);
        self.show(session);
        Ok(())
    }

    pub(crate) fn answer(&mut self, answer: Answer, session: &mut Session) {
        let waited = self.waits_at().is_some();
        if self.open_question().is_some() || !self.is_revealed() {
            self.answer = Some(answer);
        }
        if waited {
            self.show(session);
        }
    }

    pub fn change(&mut self, session: &mut Session) -> Result<(), LessonError> {
        if let Some(change) = self.current().and_then(|step| step.change.as_ref()) {
            session.edit(&change.change(session.scenario())?)?;
            self.changed = true;
            self.show(session);
        }
        Ok(())
    }

    pub(crate) fn show(&self, session: &mut Session) {
        let Some(step) = self.current() else { return };
        let from = step.from.unwrap_or(0.0);
        match (self.waits_at(), step.mode) {
            (Some(until), _) => {
                session.set_mode(Mode::Live);
                session.pause();
                session.seek(until);
            }
            (None, Presentation::Whole) => {
                session.set_mode(Mode::Whole);
                session.pause();
                session.seek(step.to.unwrap_or_else(|| session.end()));
            }
            (None, Presentation::Live) => {
                session.set_mode(Mode::Live);
                session.play_from_start();
                session.seek(from);
            }
            (None, Presentation::Step) => {
                session.set_mode(Mode::Live);
                session.pause();
                session.seek(from);
            }
        }
    }
}

fn kind(view: ViewName) -> ViewKind {
    match view {
        ViewName::States => ViewKind::States,
        ViewName::Parameters => ViewKind::Parameters,
        ViewName::Errors => ViewKind::Errors,
        ViewName::Innovations => ViewKind::Innovations,
        ViewName::NisNees => ViewKind::Consistency,
        ViewName::ModelClasses => ViewKind::Classes,
        ViewName::Autocorrelation => ViewKind::Autocorrelation,
        ViewName::Gain => ViewKind::Gain,
        ViewName::Phase => ViewKind::Phase,
        ViewName::ParameterPlane => ViewKind::ParameterPlane,
        ViewName::Matrices => ViewKind::Matrices,
        ViewName::Oscillator => ViewKind::Oscillator,
        ViewName::Measured => ViewKind::Measured,
        ViewName::FrequencyResponse => ViewKind::FrequencyResponse,
        ViewName::Map => ViewKind::Map,
    }
}

pub struct Catalogue {
    pub(crate) lessons: LazyLock<Vec<Lesson>>,
    pub(crate) finished: BTreeSet<String>,
}

impl Default for Catalogue {
    fn default() -> Self {
        // Read when a menu first needs them: a start need not wait for all lessons.
        let read = || kalmanscope_lessons::lessons().into_iter().filter_map(Result::ok).collect();
        Self { lessons: LazyLock::new(read), finished: BTreeSet::new() }
    }
}

impl Catalogue {
    pub(crate) fn at(&self, place: usize) -> Option<&Lesson> {
        self.lessons.get(place)
    }

    pub(crate) fn finish(&mut self, place: usize) {
        let title = self.at(place).map(|lesson| lesson.title.clone());
        self.finished.extend(title);
    }

    pub(crate) fn is_finished(&self, lesson: &Lesson) -> bool {
        self.finished.contains(&lesson.title)
    }
}

fn choice_of(map: &Map, scenario: &Scenario) -> Result<MapChoice, String> {
    let Map { x, y, measure, filter, second } = map;
    let mut scenario = scenario.clone();
    scenario.number_filters();
    let id = |name: &String| {
        let filter = scenario.filters.iter().find(|filter| filter.name == *name);
        filter.map(|filter| filter.id).ok_or_else(|| format!("the scenario has no filter `{name}`"))
    };
    let axis = |text: &String| Axis::parse(text).map_err(|error| error.to_string());
    let choice = MapChoice {
        axes: [axis(x)?, axis(y)?],
        measure: *measure,
        filter: id(filter)?,
        second: second.as_ref().map(id).transpose()?,
        precision: Precision::default(),
    };
    choice.check(&scenario)?;
    Ok(choice)
}
