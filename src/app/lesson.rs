//! Applies requests about lessons.

use egui::Context;

use super::App;
use crate::controls::number;
use crate::layout::ViewLayout;
use crate::plot::time_axis::TimeAxis;
use crate::request::Answer;
use crate::share::{Bookmark, Studies};
use crate::tutor::Tutor;

impl App {
    pub(super) fn start_lesson(&mut self, place: usize, ctx: &Context) {
        let lesson = self.catalogue.at(place).cloned();
        self.begin(lesson.map(|lesson| Tutor::new(lesson, Some(place))), ctx);
    }

    pub(super) fn begin(&mut self, lesson: Option<Tutor>, ctx: &Context) {
        self.inviting = false;
        self.tutor = lesson;
        self.ruler.clear();
        self.visible.reset();
        self.go_to_step(0);
        number::begin_anew(ctx);
    }

    pub(super) fn go_to_step(&mut self, step: usize) {
        let Self { session, layout, tutor, .. } = self;
        let Some(lesson) = tutor else { return };
        if let Err(error) = lesson.go_to(step, session) {
            self.notice = Some(format!("This step of the lesson cannot be shown: {error}.").into());
            *tutor = None;
            return;
        }
        session.begin_anew();
        let views = lesson.views();
        if !views.is_empty() {
            *layout = ViewLayout::column(&views);
        }
        self.show_map();
        self.show_step();
    }

    fn show_map(&mut self) {
        let Self { session, laboratory, tutor: Some(lesson), .. } = self else { return };
        match lesson.map(session.scenario()) {
            Ok(None) => {}
            Ok(map) => laboratory.choose(map),
            Err(error) => self.notice = Some(format!("The map of this step cannot be shown: {error}.").into()),
        }
    }

    fn show_step(&mut self) {
        let Self { session, axis, visible, tutor: Some(lesson), .. } = self else { return };
        *axis = TimeAxis { framed: lesson.frame(session), ..TimeAxis::default() };
        lesson.choose(visible);
    }

    pub(super) fn answer(&mut self, answer: Answer) {
        let Self { session, tutor: Some(lesson), .. } = self else { return };
        lesson.answer(answer, session);
        self.show_step();
    }

    pub(super) fn change_lesson(&mut self) {
        let Self { session, axis, tutor: Some(lesson), .. } = self else { return };
        if lesson.change(session).is_err() {
            // The target of the change is gone: begin the step again.
            let step = lesson.step;
            self.go_to_step(step);
        } else {
            // The record may have become longer.
            axis.framed = lesson.frame(session);
            // The map may be of a filter that the change has added.
            self.show_map();
        }
    }

    pub(super) fn finish_lesson(&mut self) {
        if let Some(place) = self.tutor.as_ref().and_then(|tutor| tutor.place) {
            self.catalogue.finish(place);
        }
    }

    pub(super) fn leave_lesson(&mut self) {
        if self.tutor.take().is_some() {
            self.axis.framed = None;
            self.visible.reset();
        }
    }

    pub(super) fn studies(&self) -> Studies {
        let bookmark = self.tutor.as_ref().and_then(Tutor::bookmark);
        Studies { bookmark, finished: self.catalogue.finished.clone() }
    }

    pub(super) fn resume(&mut self, Studies { bookmark, finished }: Studies) {
        self.catalogue.finished = finished;
        let Some(bookmark) = bookmark else { return };
        let Some(lesson) = self.bookmarked(&bookmark) else {
            let Bookmark { lesson, step, .. } = bookmark;
            let reason = format!("The lesson “{lesson}” cannot be continued: there is no step {} of it.", step + 1);
            return self.notice = Some(reason.into());
        };
        lesson.show(&mut self.session);
        self.tutor = Some(lesson);
        self.show_step();
    }

    fn bookmarked(&self, bookmark: &Bookmark) -> Option<Tutor> {
        let place = self.catalogue.lessons.iter().position(|lesson| lesson.title == bookmark.lesson)?;
        Tutor::at_bookmark(self.catalogue.at(place)?.clone(), place, bookmark)
    }
}
