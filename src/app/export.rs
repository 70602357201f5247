//! Writes files, and restores a session from one.

use egui::Context;

use super::App;
use crate::export::{self, Deliver};
use crate::figure::Figure;
use crate::notice::Notice;
use crate::request::{Export, FigureFormat};
use crate::share;
use crate::theme::Palette;
use crate::view::ViewContext;

impl App {
    /// The explorer with a way to put files where the user finds them.
    #[must_use]
    pub fn delivering(self, deliver: Deliver) -> Self {
        Self { deliver: Some(deliver), ..self }
    }

    /// The views on screen as a figure.
    pub fn figure(&self, format: FigureFormat) -> Figure {
        let palette = Palette::of(egui::Theme::Light);
        Figure::new(&self.figure_context(&palette), &self.layout.rows(), format)
    }

    pub(super) fn figure_context<'a>(&'a self, palette: &'a Palette) -> ViewContext<'a> {
        let Self { session, visible, axis, ruler, laboratory, .. } = self;
        ViewContext::new(session, palette, visible, axis, ruler).in_laboratory(Some(laboratory))
    }

    /// Makes a file and delivers it. Shows its place, or the reason why it cannot be written.
    pub(super) fn export(&mut self, export: Export) {
        let palette = Palette::of(egui::Theme::Light);
        let made = export::file(export, &self.figure_context(&palette), &self.layout);
        let deliver = self.deliver.as_ref().ok_or_else(|| "there is no place for files here".to_owned());
        let written = made.and_then(|file| deliver?(&file));
        self.notice = Some(match written {
            Ok(place) => Notice::done(&format!("Written: {place}")),
            Err(error) => format!("The file cannot be written: {error}.").into(),
        });
    }

    /// Restores a session from a file. Undo brings back the earlier settings.
    pub(super) fn open_session(&mut self, picture: share::Picture, ctx: &Context) {
        let record = picture.scenario.record.as_ref().map(|mapping| mapping.file.clone());
        let laboratory = picture.laboratory.clone();
        self.show_picture(picture, ctx);
        self.laboratory.restore(laboratory);
        if let Some(file) = record.filter(|file| !file.is_empty()) {
            self.notice = Some(format!("The session belongs to the record “{file}”: drop that file too.").into());
        }
    }
}
