//! Files that come in and go out.

use std::path::Path;

use egui::Context;

use super::App;
use crate::export::Deliver;
use crate::figure::Figure;
use crate::inbox::{self, Arrival, Choose};
use crate::notice::Notice;
use crate::request::{FigureFormat, Request};
use crate::share;
use crate::theme::Palette;
use crate::view::ViewContext;
use crate::views::view;

impl App {
    #[must_use]
    pub fn choosing(self, choose: Option<Choose>) -> Self {
        Self { choose, ..self }
    }

    pub fn open_file(&mut self, name: &str, contents: Result<Vec<u8>, String>) {
        self.requests.push(inbox::opened(name, contents));
    }

    pub fn read_file(&self, path: &Path, ctx: &Context) {
        inbox::read(path, ctx, &self.inbox);
    }

    pub(super) fn choose_file(&mut self, ctx: &Context) {
        match &mut self.choose {
            Some(choose) => choose(ctx, &self.inbox),
            None => self.notice = Some("A file cannot be chosen here: drop it on the window.".to_owned().into()),
        }
    }

    pub(super) fn take_files(&mut self, ctx: &Context) {
        let mut opens = false;
        for arrival in self.inbox.take() {
            match arrival {
                Arrival::File(name, contents) => {
                    self.open_file(&name, contents);
                    opens = true;
                }
                // The file that names it is opened after this frame.
                Arrival::Kept(..) if opens => self.inbox.put(arrival, ctx),
                // It is opened without questions, or not at all.
                Arrival::Kept(name, bytes) if self.waits_for(&name, &bytes) => self.open_file(&name, Ok(bytes)),
                Arrival::Kept(..) => {}
                Arrival::Done(sentence) => self.notice = Some(self.notice_with(&sentence)),
                Arrival::Shelved(name) => {
                    let mut notice = self.notice_with(&format!("“{name}” will be here next time."));
                    notice.button.get_or_insert(("Forget it", Request::ForgetRecord));
                    self.notice = Some(notice);
                }
                Arrival::Failure(sentence) => self.requests.push(Request::Report(sentence)),
            }
        }
    }

    fn notice_with(&mut self, sentence: &str) -> Notice {
        let stays = |notice: &Notice| notice.is_failure || notice.button.is_some();
        self.notice.take().filter(stays).unwrap_or(Notice::done("")).with(sentence)
    }

    #[must_use]
    pub fn delivering(self, deliver: Deliver) -> Self {
        Self { deliver: Some(deliver), ..self }
    }

    pub fn figure(&self, format: FigureFormat) -> Figure {
        // Figures are for paper, whatever the theme of the screen.
        let palette = Palette::of(egui::Theme::Light);
        Figure::new(&self.figure_context(&palette), &self.layout.rows(), format)
    }

    pub(super) fn figure_context<'a>(&'a self, palette: &'a Palette) -> ViewContext<'a> {
        let Self { session, visible, axis, ruler, laboratory, .. } = self;
        ViewContext::new(session, palette, visible, axis, ruler).in_laboratory(Some(laboratory))
    }

    pub(super) fn follow_export(&mut self, ctx: &Context) {
        let Some(mut exporting) = self.exporting.take() else { return };
        let palette = Palette::of(egui::Theme::Light);
        if let Some(film) = exporting.film() {
            self.session.seek(film.time());
            let sentence = format!("Film of {}: {:.0} %", view(film.view).name, 100.0 * film.progress());
            self.notice = Some(Notice { button: Some(("Stop", Request::StopExport)), ..Notice::done(&sentence) });
        }
        let Some(made) = exporting.advance(&self.figure_context(&palette), &self.layout) else {
            self.exporting = Some(exporting);
            return ctx.request_repaint();
        };
        if exporting.film().is_some() {
            self.notice = None;
        }
        let remark = std::mem::take(&mut exporting.remark);
        let deliver = self.deliver.as_ref().ok_or_else(|| "there is no place for files here".to_owned());
        let failed = |reason: &str| format!("The file cannot be written: {reason}.");
        match made.and_then(|file| Ok((deliver?, file))) {
            Ok((deliver, file)) => {
                deliver(file, self.inbox.done(ctx, move |place| format!("Written: {place}{remark}"), failed));
            }
            Err(reason) => self.notice = Some(failed(&reason).into()),
        }
    }

    /// Playback returns to where it was before a film.
    pub(super) fn stop_export(&mut self) -> bool {
        let Some(exporting) = self.exporting.take() else { return false };
        if let Some(film) = exporting.film() {
            self.session.seek(film.before);
            self.notice = None;
        }
        true
    }

    pub(super) fn open_session(&mut self, picture: share::SavedPicture, ctx: &Context) {
        let laboratory = picture.laboratory.clone();
        self.show_picture(picture, ctx);
        self.laboratory.restore(laboratory);
        let scenario = self.session.scenario();
        let is_here = scenario.record.as_ref().is_some_and(|mapping| self.session.library().file(mapping).is_some());
        if let Some(file) = self.missing_record().filter(|file| !is_here && !file.is_empty()) {
            self.notice = Some(format!("The session needs its record “{file}”: drop that file too.").into());
        }
    }
}
