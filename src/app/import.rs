//! Measured records: their import, and the scenarios that name them.

use std::rc::Rc;
use std::sync::Arc;

use egui::{Context, Frame, Panel, Ui};
use kalmanscope_core::import::hash;

use super::App;
use super::window::NARROW;
use crate::import::{Import, Opened};
use crate::inbox::Arrival;
use crate::layout::ViewLayout;
use crate::measure::{Measure, News};
use crate::notice::Notice;
use crate::record_store::{RecordStore, StoredFile};
use crate::request::{RawFile, Request, ViewKind};
use crate::sensor::Sensors;
use crate::session::{Mode, name_of};
use crate::text::sentence;
use crate::theme::Palette;

const MEASURED: &str = "measured.csv";

const VIEWS: [ViewKind; 3] = [ViewKind::Measured, ViewKind::Parameters, ViewKind::Innovations];

impl App {
    pub(super) fn import(&mut self, RawFile { name, bytes, is_measured }: RawFile) {
        self.inviting = false;
        // It is stored once it has opened: a file that is no record must not take the place of one that is.
        self.candidate = self.store.is_some().then(|| StoredFile::of(&name, &bytes)).flatten();
        // A phone has no room for the columns, and those of a measurement are known.
        let at_once = is_measured || self.width < NARROW;
        self.importing = Some(Import::new(&name, bytes, at_once, Rc::clone(self.session.team())));
    }

    #[must_use]
    pub fn keeping_records(mut self, store: Box<dyn RecordStore>, ctx: &Context) -> Self {
        let mapping = self.session.scenario().record.as_ref();
        if mapping.is_some_and(|mapping| self.session.library().file(mapping).is_none()) {
            store.fetch(ctx, &self.inbox);
        }
        self.store = Some(store);
        self
    }

    #[must_use]
    pub fn measuring_with(self, sensors: Sensors) -> Self {
        Self { sensors, ..self }
    }

    pub fn measure(&mut self) {
        self.measure = Measure::new(&self.sensors);
    }

    pub fn watch(&mut self, ctx: &Context) {
        self.measure();
        self.measure.iter_mut().for_each(|measure| measure.begin_watched(ctx));
    }

    pub(super) fn follow_measure(&mut self, ctx: &Context) {
        match self.measure.as_mut().and_then(Measure::follow) {
            Some(News::Longer(record)) => self.session.lengthen(record),
            Some(News::Another(scenario, record)) => {
                self.tutor = None;
                self.layout = ViewLayout::column(&VIEWS);
                self.session.follow_live(*scenario, record);
                self.begin_anew(ctx);
            }
            None => {}
        }
    }

    pub(super) fn live_ui(&mut self, ui: &mut Ui, frame: Frame, palette: &Palette) {
        let Self { measure: Some(measure), requests, .. } = self else { return };
        if !measure.is_watched() {
            return;
        }
        let strip = Panel::top("live").frame(frame);
        if !strip.show(ui, |ui| measure.strip_ui(ui, palette, requests)).inner {
            self.end_measure(ui.ctx());
        }
    }

    pub(super) fn measure_ui(&mut self, ctx: &Context, palette: &Palette) {
        let Self { measure: Some(measure), requests, .. } = self else { return };
        if !measure.is_watched() && !measure.ui(ctx, palette, requests) {
            self.end_measure(ctx);
        }
    }

    fn end_measure(&mut self, ctx: &Context) {
        self.measure = None;
        // The importer stores the file itself once it has opened it.
        let is_imported = self.requests.iter().any(|request| matches!(request, Request::ImportFile(_)));
        if let Some(bytes) = self.session.end_live(MEASURED).filter(|_| !is_imported) {
            self.candidate = self.store.is_some().then(|| StoredFile::of(MEASURED, &bytes)).flatten();
            self.shelve(ctx);
        }
    }

    pub(super) fn forget_record(&self, ctx: &Context) {
        if let Some(store) = &self.store {
            let forgotten = |_: &str| "This record will not be here next time.".to_owned();
            let failed = |reason: &str| format!("The record could not be forgotten: {reason}.");
            store.forget(self.inbox.done(ctx, forgotten, failed));
        }
    }

    fn shelve(&mut self, ctx: &Context) {
        let (Some(store), Some(file)) = (&self.store, self.candidate.take()) else { return };
        let (name, inbox, ctx) = (file.name.clone(), self.inbox.clone(), ctx.clone());
        let done = move |end: Result<String, String>| {
            let failed = |reason: String| Arrival::Failure(format!("“{name}” will not be here next time: {reason}."));
            inbox.put(end.map_or_else(failed, |_| Arrival::Shelved(name.clone())), &ctx);
        };
        store.keep(&file.name, file.bytes, Arc::new(done));
    }

    pub(super) fn change_columns(&mut self) {
        let scenario = self.session.scenario();
        let file = scenario.record.as_ref().and_then(|mapping| self.session.library().file(mapping));
        self.importing = file.map(|file| Import::again(file, scenario, Rc::clone(self.session.team())));
    }

    pub(super) fn follow_import(&mut self, ctx: &Context) {
        let Some(import) = &mut self.importing else { return };
        let mut while_time = self.session.budget().slice();
        let opened = import.advance(&mut while_time);
        let file = import.file().cloned();
        if let Some(file) = file.filter(|file| self.awaits(&file.name, || file.hash.clone())) {
            self.importing = None;
            self.session.keep_file(file);
            self.candidate = None;
            self.notice = None;
        } else if let Some(opened) = opened {
            self.open_record(opened, ctx);
        }
    }

    pub(super) fn hold_out(&mut self) {
        let Some(file) = self.importing.take().and_then(|import| import.file().cloned()) else { return };
        self.notice = match self.session.hold_out(&file) {
            Ok(()) => None,
            Err(reason) => Some(format!("The models cannot be tested: {reason}.").into()),
        };
        self.layout.show(ViewKind::Measured);
    }

    pub(super) fn waits_for(&self, name: &str, bytes: &[u8]) -> bool {
        self.importing.is_none() && self.awaits(name, || hash(bytes))
    }

    // A function, as hashing 85 MB takes 150 ms, and most files are not waited for.
    fn awaits(&self, name: &str, hash: impl FnOnce() -> String) -> bool {
        let Some(mapping) = &self.session.scenario().record else { return false };
        let is_it = if mapping.hash.is_empty() { name_of(mapping) == name } else { mapping.hash == hash() };
        is_it && self.session.library().file(mapping).is_none()
    }

    pub(super) fn import_ui(&mut self, ctx: &Context, palette: &Palette) {
        let Some(import) = &mut self.importing else { return };
        let can_hold_out = self.session.is_measured();
        if let Some(opened) = import.ui(ctx, palette, can_hold_out, &mut self.requests) {
            self.open_record(opened, ctx);
        }
    }

    fn open_record(&mut self, Opened { file, scenario, reasons, problem, summary }: Opened, ctx: &Context) {
        self.importing = None;
        self.tutor = None;
        self.session.keep_file(file);
        let is_new = self.session.scenario().record.as_ref().map(|mapping| &mapping.hash)
            != scenario.record.as_ref().map(|mapping| &mapping.hash);
        if is_new {
            self.layout = ViewLayout::column(&VIEWS);
            self.session.set_mode(Mode::Whole);
            self.session.set_scenario(scenario);
            self.session.pause();
            self.session.seek_end();
            self.begin_anew(ctx);
        } else {
            self.session.replace(scenario);
        }
        let problem = problem.map(|problem| format!("{}.", sentence(&problem)));
        self.notice = problem.clone().map(Into::into);
        if let Some(summary) = summary {
            let notice = self.notice.get_or_insert_with(|| Notice::done(&summary));
            notice.button = Some(("Columns…", Request::ChangeColumns));
        }
        self.shelve(ctx);
        self.session.explain(reasons, problem);
    }
}
