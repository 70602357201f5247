//! Work that makes no progress: reported after ten seconds, and stopped by Esc or a button.

use std::time::Duration;

use egui::Context;

use super::App;
use crate::export::Exporting;
use crate::import::Import;
use crate::notice::Notice;
use crate::request::ViewKind;

/// Limits the time for which work under way may make no progress, before it is reported \[s\].
const PATIENCE: f64 = 10.0;

/// While work is under way, frames come at least this often, and one frame counts for at most this time: that of a page that
/// was hidden is no standstill \[s\].
const BETWEEN: f64 = 1.0;

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Work {
    Import,
    Picture,
    Map,
    Seeds,
    Tuning,
    Posterior,
    Causes,
    FreeRuns,
    Spectrogram,
    Export,
}

#[derive(Default)]
pub(super) struct Standstill {
    /// The works with their names, their shares, and the times for which these have stood still.
    works: Vec<((Work, &'static str), f64, f64)>,
    /// The time of the last frame \[s\].
    last: f64,
}

impl Standstill {
    pub(super) fn first(&self) -> Option<(Work, &'static str)> {
        self.works.iter().find(|(.., still)| *still >= PATIENCE).map(|(work, ..)| *work)
    }
}

impl App {
    /// Reports work that makes no progress, until it does or has ended.
    pub(super) fn follow_standstill(&mut self, ctx: &Context) {
        let under_way = self.under_way();
        let Standstill { works, last } = &mut self.standstill;
        let now = ctx.input(|input| input.time);
        let elapsed = (now - *last).clamp(0.0, BETWEEN);
        *last = now;
        let still = |work, share| {
            let before = works.iter().find(|before| (before.0, before.1) == (work, share));
            before.map_or(0.0, |before| before.2 + elapsed)
        };
        *works = under_way.into_iter().map(|(work, share)| (work, share, still(work, share))).collect();
        if !works.is_empty() {
            ctx.request_repaint_after(Duration::from_secs_f64(BETWEEN));
        }
        let first = self.standstill.first();
        if let Some(import) = &mut self.importing {
            import.is_still = first.is_some_and(|(work, _)| work == Work::Import);
        }
        let is_said = self.notice.as_ref().is_some_and(Notice::is_of_standstill);
        match first.filter(|(work, _)| *work != Work::Import) {
            Some((_, name)) if !is_said => {
                let sentence = format!("{name} has made no progress for {PATIENCE} s. Esc stops it.");
                self.notice = Some(Notice::of_standstill(sentence));
            }
            None if is_said => self.notice = None,
            _ => {}
        }
    }

    fn under_way(&self) -> Vec<((Work, &'static str), f64)> {
        let Self { session, laboratory, layout, importing, exporting, .. } = self;
        let is_in_sight = |kind| layout.in_sight().contains(&kind);
        let (map, seeds) = (laboratory, &laboratory.seeds);
        let works = [
            ((Work::Import, "The import"), importing.as_ref().and_then(Import::progress)),
            ((Work::Picture, "The computation of the plots"), session.progress()),
            ((Work::Map, "The map"), map.progress().filter(|_| map.is_working() && !map.state.is_stopped)),
            (
                (Work::Seeds, "The runs with many seeds"),
                seeds.progress().filter(|_| seeds.is_working()).map(|[done, _]| done as f64),
            ),
            ((Work::Tuning, "The tuning"), map.tuning.progress().filter(|_| is_in_sight(ViewKind::Tune))),
            (
                (Work::Posterior, "The search of the posterior"),
                map.posteriors.progress().filter(|_| is_in_sight(ViewKind::ParameterPlane)),
            ),
            ((Work::Causes, "The search for causes"), session.trials_beside().filter(|_| !session.behind())),
            ((Work::FreeRuns, "The free run"), session.free_run_beside()),
            ((Work::Spectrogram, "The spectrogram"), session.spectrogram_beside()),
            ((Work::Export, "The export"), exporting.as_ref().map(Exporting::progress)),
        ];
        works.into_iter().filter_map(|(work, share)| Some((work, share?))).collect()
    }

    pub(super) fn stop_standing_still(&mut self) {
        let Some((work, _)) = self.standstill.first() else { return };
        let Self { session, laboratory, importing, exporting, .. } = self;
        match work {
            Work::Import => *importing = None,
            Work::Picture => _ = session.cancel(),
            Work::Map => _ = laboratory.set_stopped(true),
            Work::Seeds => _ = laboratory.seeds.set_stopped(true),
            Work::Tuning => _ = laboratory.tuning.cancel(),
            Work::Posterior => _ = laboratory.posteriors.cancel(),
            Work::Causes => session.give_up_trials(),
            Work::FreeRuns => session.give_up_free_runs(),
            Work::Spectrogram => session.give_up_spectrogram(),
            Work::Export => *exporting = None,
        }
        self.standstill.works.clear();
    }
}
