//! The app: one session, its controls and its views.

mod apply;
mod files;
mod import;
mod lesson;
pub mod link;
mod panels;
mod screen_state;
mod stalled;
pub mod state;
mod window;

use std::rc::Rc;

use egui::util::undoer::Undoer;
use egui::{Context, ThemePreference, Ui};
use kalmanscope_core::{Estimates, RunError, Scenario};
use kalmanscope_diagnosis::Story;
use window::NARROW;

use crate::equation::Editor;
use crate::export::{Deliver, Exporting};
use crate::figure::FigureDialog;
use crate::finder::Finder;
use crate::import::Import;
use crate::inbox::{self, Choose, Inbox};
use crate::laboratory::Laboratory;
use crate::layout::ViewLayout;
use crate::measure::Measure;
use crate::notice::Notice;
use crate::plot::time_axis::TimeAxis;
use crate::record_store::{RecordStore, StoredFile};
use crate::request::{Request, ViewKind};
use crate::ruler::{Ruler, RulerEnd};
use crate::screen_text::ScreenText;
use crate::sensor::Sensors;
use crate::session::{Mode, ModelTime, Session, Version, Wanted};
use crate::team::{Frames, Team};
use crate::tutor::{Catalogue, Tutor};
use crate::views::view;
use crate::visibility::Visibility;
use crate::{keys, theme, views};

const LARGE: f32 = 1.4;

pub struct App {
    session: Session,
    axis: TimeAxis,
    ruler: Ruler,
    visible: Visibility,
    layout: ViewLayout,
    pub laboratory: Laboratory,
    catalogue: Catalogue,
    tutor: Option<Tutor>,
    history: Undoer<Version>,
    controls_open: Option<bool>,
    all_settings: bool,
    diagnosed: Option<u32>,
    drawers: panels::Drawers,
    presenting: bool,
    usual_zoom: f32,
    keys_open: bool,
    /// Width of the window in the last frame \[points\], and its theme.
    width: f32,
    low: bool,
    theme: ThemePreference,
    /// Whether the window is cleared in the ground's colour, so that panels need no fill.
    cleared: bool,
    inviting: bool,
    /// The time of the screen when the present record or scenario came \[s\].
    begun: f64,
    importing: Option<Import>,
    editor: Option<Editor>,
    story: Story,
    finder: Option<Finder>,
    notice: Option<Notice>,
    /// Writes a file where the user finds it. `None` if the platform has no way to do so.
    deliver: Option<Deliver>,
    exporting: Option<Exporting>,
    figure_dialog: Option<FigureDialog>,
    choose: Option<Choose>,
    store: Option<Box<dyn RecordStore>>,
    sensors: Sensors,
    measure: Option<Measure>,
    candidate: Option<StoredFile>,
    stalled: stalled::StalledWorks,
    pub inbox: Inbox,
    page: String,
    embedded: bool,
    /// The text of a saved session that could not be read; the next save keeps it.
    unreadable: Option<String>,
    requests: Vec<Request>,
}

impl App {
    pub fn new(creation: &eframe::CreationContext<'_>) -> Result<Self, RunError> {
        Self::stored(&creation.egui_ctx, creation.storage)
    }

    pub fn with_scenario(scenario: Scenario) -> Result<Self, RunError> {
        // glibc gives the memory of each frame back, until a block as large as this was freed once: 1.5 ms at rest in place of 0.8.
        #[cfg(target_os = "linux")]
        drop(std::hint::black_box(Vec::<u8>::with_capacity(16 << 20)));
        Ok(Self {
            session: Session::new(scenario)?,
            axis: TimeAxis::default(),
            ruler: Ruler::default(),
            visible: Visibility::default(),
            layout: ViewLayout::default(),
            laboratory: Laboratory::new(Rc::new(Frames::FRAME)),
            catalogue: Catalogue::default(),
            tutor: None,
            history: Undoer::default(),
            controls_open: None,
            all_settings: true,
            diagnosed: None,
            drawers: panels::Drawers::default(),
            presenting: false,
            usual_zoom: 1.0,
            keys_open: false,
            width: window::WIDE,
            low: false,
            theme: ThemePreference::System,
            cleared: false,
            inviting: false,
            begun: 0.0,
            notice: None,
            importing: None,
            editor: None,
            story: Story::default(),
            finder: None,
            deliver: None,
            exporting: None,
            figure_dialog: None,
            choose: None,
            store: None,
            sensors: Sensors::default(),
            measure: None,
            candidate: None,
            stalled: stalled::StalledWorks::default(),
            inbox: Inbox::default(),
            page: link::PAGE.unwrap_or_default().to_owned(),
            embedded: false,
            unreadable: None,
            requests: Vec::new(),
        })
    }

    /// Begins paused with the whole record on screen, without animations, as the system's setting for motion asks.
    pub fn reduce_motion(&mut self, ctx: &egui::Context) {
        ctx.all_styles_mut(|style| style.animation_time = 0.0);
        self.session.set_mode(Mode::Whole);
        self.session.pause();
        self.session.seek(self.session.end());
    }

    /// Requires that [`eframe::App::clear_color`] clears the window: to fill it twice is slow without a graphics card.
    #[must_use]
    pub fn on_cleared_window(self) -> Self {
        Self { cleared: true, ..self }
    }

    pub fn session(&self) -> &Session {
        &self.session
    }

    pub fn pointed(&self) -> Option<f64> {
        self.axis.pointed
    }

    pub fn session_mut(&mut self) -> &mut Session {
        &mut self.session
    }

    pub fn layout_mut(&mut self) -> &mut ViewLayout {
        &mut self.layout
    }

    pub fn show_all_settings(&mut self, all: bool) {
        self.all_settings = all;
    }

    pub fn axis(&self) -> &TimeAxis {
        &self.axis
    }

    pub fn ruler(&self) -> &Ruler {
        &self.ruler
    }

    pub fn report(&mut self, sentence: &str) {
        let before = self.notice.take().unwrap_or(Notice::done(""));
        self.notice = Some(Notice { is_failure: true, ..before.with(sentence) });
    }

    /// Shows a sentence that is no failure for a while, if no other is on screen.
    pub fn inform(&mut self, sentence: &str) {
        self.notice.get_or_insert_with(|| Notice::done(sentence));
    }

    pub fn notice(&self) -> Option<&str> {
        self.notice.as_ref().map(|notice| notice.sentence.as_str())
    }

    fn tried(&self) -> Vec<u32> {
        let ids = self.session.run().estimates().iter().map(Estimates::id);
        ids.filter(|id| self.diagnosed == Some(*id)).collect()
    }

    fn wanted(&self) -> Wanted {
        let of_drawer = if self.diagnosed.is_some() { Wanted::DIAGNOSTICS } else { Wanted::NOTHING };
        let of_export = self.exporting.as_ref().map_or(Wanted::NOTHING, Exporting::wanted);
        views::wanted(&self.layout.shown()).and(self.visible.wanted()).and(of_drawer).and(of_export)
    }

    fn model_time(&self) -> Option<ModelTime> {
        let wanted = self.layout.in_sight().iter().any(|kind| views::view(*kind).wants_free_runs);
        wanted.then(|| match (self.ruler.time(RulerEnd::A), self.ruler.time(RulerEnd::B)) {
            (Some(a), Some(b)) => ModelTime::Over(a, b),
            (Some(time), None) | (None, Some(time)) => ModelTime::At(time),
            (None, None) => ModelTime::Last,
        })
    }

    pub fn screen_text(&self) -> ScreenText {
        let Self { session, visible, axis, layout, .. } = self;
        ScreenText::new(session, visible, axis, layout, self.notice())
    }
}

impl eframe::App for App {
    fn logic(&mut self, ctx: &egui::Context, _frame: &mut eframe::Frame) {
        theme::fit_targets(ctx);
        // Behind the window of an import keys have no effect.
        if self.importing.is_none() {
            keys::keys(ctx, &self.session, &mut self.requests);
        }
        inbox::dropped(ctx, &self.inbox);
        self.take_files(ctx);
        link::pasted(ctx, &mut self.requests);
        self.follow_export(ctx);
        for request in std::mem::take(&mut self.requests) {
            self.apply(request, ctx);
        }
        self.notice.take_if(|notice| notice.is_over(ctx));
        self.visible.forget_filters_but(&self.session.scenario().filters);
        // A drag becomes one step of the history when it ends.
        self.history.feed_state(ctx.input(|input| input.time), &self.session.version());
        self.session.want(self.wanted());
        self.session.want_trials(self.tried());
        self.session.want_free_runs(self.model_time());
        self.session.want_spectrogram(self.layout.in_sight().contains(&ViewKind::Spectrogram));
        // A slow frame (a hidden tab, a breakpoint) must not skip part of the record.
        let elapsed = ctx.input(|input| f64::from(input.stable_dt)).min(0.1);
        // The figures and the text of an export are of one time.
        let elapsed = if self.exporting.is_some() { 0.0 } else { elapsed };
        // A number that is held is still being changed.
        let is_held = ctx.input(|input| input.pointer.any_down());
        self.session.hold(is_held);
        self.session.rest(if is_held { 0.0 } else { elapsed });
        self.follow_measure(ctx);
        self.session.advance(elapsed);
        self.follow_import(ctx);
        self.follow_laboratory(ctx);
        self.follow_stalled(ctx);
        let Self { session, importing, .. } = self;
        session.ask_for_frame(ctx);
        if session.is_before_behind()
            || session.is_trying_here()
            || session.is_free_run_behind_here()
            || session.is_spectrogram_behind_here()
            || session.owes_diagnoses()
        {
            ctx.request_repaint();
        }
        if let Some(import) = importing {
            import.ask_for_frame(ctx);
        }
    }

    fn ui(&mut self, ui: &mut Ui, _frame: &mut eframe::Frame) {
        self.window_ui(ui);
    }

    fn clear_color(&self, visuals: &egui::Visuals) -> [f32; 4] {
        visuals.panel_fill.to_normalized_gamma_f32()
    }

    fn save(&mut self, storage: &mut dyn eframe::Storage) {
        // An embedded explorer does not overwrite the saved session.
        if self.embedded {
            return;
        }
        if let Err(error) = self.store(storage) {
            log::error!("The session is not saved: {error}");
        }
    }
}

impl App {
    #[must_use]
    pub fn working_with(mut self, team: Rc<dyn Team>) -> Self {
        self.laboratory.work_with(Rc::clone(&team));
        self.session.work_with(team);
        self
    }

    fn follow_laboratory(&mut self, ctx: &Context) {
        let is_in_sight = self.layout.in_sight().iter().any(|kind| view(*kind).is_of_laboratory);
        self.laboratory.follow(&self.session, is_in_sight, self.width < NARROW, ctx);
        let filters = self.session.run().estimates().iter().map(Estimates::id);
        let filters: Vec<u32> = filters.filter(|id| self.visible.filter(*id)).collect();
        let is_in_sight = self.layout.in_sight().contains(&ViewKind::MonteCarlo);
        self.laboratory.follow_seeds(&self.session, &filters, is_in_sight, ctx);
        let is_in_sight = self.layout.in_sight().contains(&ViewKind::Tune);
        self.laboratory.follow_tuning(&self.session, is_in_sight, ctx);
        let is_in_sight = self.layout.in_sight().contains(&ViewKind::Sensors);
        self.laboratory.follow_sensors(&self.session, is_in_sight, ctx);
    }
}
