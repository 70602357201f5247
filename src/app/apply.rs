//! Applies requests.

use kalmanscope_core::Scenario;
use kalmanscope_lessons::BuiltIn;

use super::window::NARROW;
use super::{App, LARGE};
use crate::controls::number;
use crate::equation::Editor;
use crate::export;
use crate::export::Exporting;
use crate::figure::FigureDialog;
use crate::finder::Finder;
use crate::layout::ViewLayout;
use crate::plot::time_axis::TimeAxis;
use crate::request::{Request, ViewKind};
use crate::session::Mode;
use crate::text::sentence;
use crate::tutor::Tutor;

impl App {
    pub(super) fn open_built_in(&mut self, built_in: BuiltIn, ctx: &egui::Context) {
        match built_in.scenario() {
            Ok(scenario) => self.open(scenario, ctx),
            Err(error) => self.notice = Some(format!("“{}” cannot be opened: {error}.", built_in.title).into()),
        }
    }

    pub(super) fn apply(&mut self, request: Request, ctx: &egui::Context) {
        let Self { session, axis, visible, layout, laboratory, history, .. } = self;
        match request {
            Request::TogglePlay => session.toggle_play(),
            Request::Step => session.step(),
            Request::StepBack => session.step_back(),
            Request::Restart => {
                session.seek(0.0);
                *axis = TimeAxis::default();
            }
            Request::Seek(time) => session.seek(time),
            Request::SetMode(mode) => {
                session.set_mode(mode);
                *axis = TimeAxis::default();
            }
            Request::SetSpeed(speed) => session.set_speed(speed),
            Request::Open(built_in) => self.open_built_in(built_in, ctx),
            Request::OpenScenario(scenario) => self.open(*scenario, ctx),
            Request::ChooseFile => self.choose_file(ctx),
            Request::ImportFile(file) => self.import(*file),
            Request::ChangeColumns => self.change_columns(),
            Request::Measure => self.measure(),
            // Within another page this one shows plots only.
            Request::EditEquation if self.embedded => {}
            Request::EditEquation => self.editor = Some(Editor::new(session.scenario())),
            Request::HoldOut => self.hold_out(),
            Request::CancelImport => self.importing = None,
            Request::OpenAddress(address) => self.go_to_address(&address, ctx),
            Request::CopyLink => self.copy_link(ctx),
            Request::OpenOutside => self.open_outside(ctx),
            Request::Edit(change) => {
                if let Err(error) = session.edit(&change) {
                    self.notice = Some(format!("This cannot be changed: {error}.").into());
                }
            }
            Request::SwapSnapshot => session.swap_snapshot(),
            Request::ForgetBefore => session.forget_before(),
            Request::Undo | Request::Redo => {
                let now = session.version();
                let other = if request == Request::Undo { history.undo(&now) } else { history.redo(&now) };
                if let Some(version) = other.cloned() {
                    session.restore(version);
                }
            }
            Request::StartLesson(place) => self.start_lesson(place, ctx),
            Request::StudyLesson(lesson) => self.begin(Some(Tutor::new(*lesson, None)), ctx),
            Request::GoToStep(step) => {
                self.go_to_step(step);
                number::begin_anew(ctx);
            }
            Request::Answer(answer) => self.answer(answer),
            Request::ChangeLesson => self.change_lesson(),
            Request::FinishLesson => self.finish_lesson(),
            Request::LeaveLesson => self.leave_lesson(),
            Request::TurnLesson(forward) => {
                let asked = self.tutor.as_ref().map_or(vec![], |tutor| tutor.turn(forward));
                asked.into_iter().for_each(|request| self.apply(request, ctx));
            }
            Request::ToggleEntry(entry) => visible.toggle(entry),
            Request::ShowAllChannels => visible.only.clear(),
            Request::ShowAllSettings(all) => self.show_all_settings(all),
            Request::ToggleControls => self.controls_open = Some(!self.controls_open()),
            Request::TogglePresenter => {
                self.presenting = !self.presenting;
                if self.presenting {
                    self.usual_zoom = ctx.zoom_factor();
                }
                // The zoom may have been changed by keys meanwhile.
                ctx.set_zoom_factor(if self.presenting { LARGE * self.usual_zoom } else { self.usual_zoom });
                self.controls_open = None;
            }
            Request::Find => self.finder = Some(Finder::default()),
            Request::ToggleKeys => self.keys_open = !self.keys_open,
            Request::Report(sentence) => self.notice = Some(sentence.into()),
            Request::DismissNotice => self.notice = None,
            Request::Leave if self.stalled.first().is_some() => self.stop_stalled(),
            Request::Leave => {
                // Esc leaves one thing at a time: `||` stops at the first that was there.
                let is_done = std::mem::take(&mut self.keys_open)
                    || self.exporting.take().is_some()
                    || self.figure_dialog.take().is_some()
                    || session.cancel()
                    || laboratory.set_stopped(true)
                    || laboratory.seeds.set_stopped(true)
                    || laboratory.tuning.cancel()
                    || laboratory.sensors.set_stopped(true)
                    || self.editor.take().is_some()
                    || self.diagnosed.take().is_some();
                if !is_done {
                    layout.leave_enlarged();
                }
            }
            Request::ForgetRecord => self.forget_record(ctx),
            Request::Diagnose(id) => self.diagnosed = Some(id),
            Request::CloseDiagnosis => self.diagnosed = None,
            Request::ToggleView(view) => layout.toggle(view),
            Request::ChooseTab(shown, wanted) => layout.choose_tab(shown, wanted),
            Request::ShowView(view) => {
                layout.show(view);
                // In a narrow window the new view would stand below the others, out of sight.
                if self.width < NARROW {
                    layout.enlarge(view);
                }
            }
            Request::Arrange(arrangement) => (*layout, self.inviting) = (ViewLayout::of(arrangement), false),
            Request::Rearrange(tree) => layout.rearrange(*tree),
            Request::TurnView(forward) => layout.turn(forward),
            Request::ToggleEnlarged(view) => layout.toggle_enlarged(view),
            // First back to the range of interest, then to the whole record.
            Request::Follow if axis.follows => axis.framed = None,
            Request::Follow => axis.follows = true,
            Request::Unfollow => axis.follows = false,
            Request::PointAt(time) => {
                // A pointer that has rested since the record came, as on the button that opened it, points at nothing.
                let moved = ctx.input(|input| input.time - f64::from(input.pointer.time_since_last_movement()));
                axis.pointed = time.filter(|_| moved > self.begun);
            }
            Request::MarkTime(time) => self.ruler.mark(time),
            Request::PlaceMark(end, time) => self.ruler.place(end, time),
            Request::ToggleMark(end) => self.ruler.toggle(end, axis.shown_time(session)),
            Request::ClearMarks => self.ruler.clear(),
            Request::Export(export) => {
                (self.notice, self.exporting) = (None, Some(Exporting::new(export, layout)));
                ctx.request_repaint();
            }
            Request::ShowFigure => self.figure_dialog = Some(FigureDialog::default()),
            Request::ToggleExports => export::toggle(ctx),
            Request::ChooseMap(choice) => laboratory.choose(Some(*choice)),
            Request::ComputeMap(wanted) => _ = laboratory.set_stopped(!wanted),
            Request::ChooseSeeds(choice) => laboratory.seeds.choose(choice),
            Request::RunSeeds(wanted) => _ = laboratory.seeds.set_stopped(!wanted),
            Request::ChooseTuning(choice) => laboratory.tuning.choose(Some(*choice)),
            Request::Tune(true) => laboratory.tune(session),
            Request::Tune(false) => _ = laboratory.tuning.cancel(),
            Request::ChooseSensors(choice) => laboratory.sensors.choice = *choice,
            Request::CompareSensors(wanted) => _ = laboratory.sensors.set_stopped(!wanted),
            Request::OpenSession(saved) => self.open_session(*saved, ctx),
        }
    }

    pub(super) fn open(&mut self, scenario: Scenario, ctx: &egui::Context) {
        if scenario.record.is_some() {
            // Without a truth, this view shows whether a model is right.
            self.layout.show(ViewKind::Measured);
        }
        if let Some(assumed) = scenario.assumed_parameters() {
            self.inform(&format!("{}.", sentence(&assumed)));
        }
        let is_record = scenario.record.is_some();
        self.session.set_scenario(scenario);
        if is_record && self.session.mode() == Mode::Whole {
            self.session.seek_end();
        } else {
            self.session.play_from_start();
        }
        self.begin_anew(ctx);
    }

    pub(super) fn begin_anew(&mut self, ctx: &egui::Context) {
        self.session.begin_anew();
        self.begun = ctx.input(|input| input.time);
        self.axis = TimeAxis::default();
        self.ruler.clear();
        self.visible.reset();
        number::begin_anew(ctx);
    }
}
