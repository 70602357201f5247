//! Writes files, and restores a session from one.

use egui::Context;

use super::App;
use crate::export::{self, Deliver};
use crate::figure::Figure;
use crate::request::{Export, FigureFormat};
use crate::share;
use crate::theme::Palette;
use crate::view::ViewContext;

impl App {
    #[must_use]
    pub fn delivering(self, deliver: Deliver) -> Self {
        Self { deliver: Some(deliver), ..self }
    }

    pub fn figure(&self, format: FigureFormat) -> Figure {
        let palette = Palette::of(egui::Theme::Light);
        Figure::new(&self.figure_context(&palette), &self.layout.rows(), format)
    }

    pub(super) fn figure_context<'a>(&'a self, palette: &'a Palette) -> ViewContext<'a> {
        let Self { session, visible, axis, ruler, laboratory, .. } = self;
        ViewContext::new(session, palette, visible, axis, ruler).in_laboratory(Some(laboratory))
    }

    pub(super) fn export(&mut self, export: Export, ctx: &Context) {
        self.notice = None;
        let palette = Palette::of(egui::Theme::Light);
        let made = export::file(export, &self.figure_context(&palette), &self.layout);
        let deliver = self.deliver.as_ref().ok_or_else(|| "there is no place for files here".to_owned());
        let failed = |reason: &str| format!("The file cannot be written: {reason}.");
        match made.and_then(|file| Ok((deliver?, file))) {
            Ok((deliver, file)) => deliver(file, self.inbox.done(ctx, |place| format!("Written: {place}"), failed)),
            Err(reason) => self.notice = Some(failed(&reason).into()),
        }
    }

    pub(super) fn open_session(&mut self, picture: share::Picture, ctx: &Context) {
        let laboratory = picture.laboratory.clone();
        self.show_picture(picture, ctx);
        self.laboratory.restore(laboratory);
        let scenario = self.session.scenario();
        let is_here = scenario.record.as_ref().is_some_and(|mapping| self.session.library().file(mapping).is_some());
        if let Some(file) = self.missing_record().filter(|file| !is_here && !file.is_empty()) {
            self.notice = Some(format!("The session belongs to the record “{file}”: drop that file too.").into());
        }
    }
}
