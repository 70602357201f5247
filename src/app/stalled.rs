//! Work that makes no progress: reported after ten seconds, and stopped by Esc or a button.

use std::time::Duration;

use egui::Context;

use super::App;
use crate::export::Exporting;
use crate::import::Import;
use crate::laboratory::Laboratory;
use crate::notice::Notice;
use crate::request::ViewKind;

/// Limits the time for which work under way may make no progress, before it is reported \[s\].
const PATIENCE: f64 = 10.0;

/// While work is under way, frames come at least this often, and one frame counts for at most this time: that of a page that
/// was hidden does not count \[s\].
const BETWEEN: f64 = 1.0;

type LongWork = (&'static str, Option<f64>, fn(&mut App));

const IMPORT: &str = "The import";

#[derive(Default)]
pub(super) struct StalledWorks {
    works: Vec<(&'static str, f64, f64)>,
    last: f64,
}

impl StalledWorks {
    pub(super) fn first(&self) -> Option<&'static str> {
        self.works.iter().find(|(.., still)| *still >= PATIENCE).map(|(name, ..)| *name)
    }
}

impl App {
    pub(super) fn follow_stalled(&mut self, ctx: &Context) {
        let under_way = self.works();
        let StalledWorks { works, last } = &mut self.stalled;
        let now = ctx.input(|input| input.time);
        let elapsed = (now - *last).clamp(0.0, BETWEEN);
        *last = now;
        let still = |name, share| {
            let before = works.iter().find(|before| (before.0, before.1) == (name, share));
            before.map_or(0.0, |before| before.2 + elapsed)
        };
        let under_way = under_way.into_iter().filter_map(|(name, share, _)| Some((name, share?)));
        *works = under_way.map(|(name, share)| (name, share, still(name, share))).collect();
        if !works.is_empty() {
            ctx.request_repaint_after(Duration::from_secs_f64(BETWEEN));
        }
        let first = self.stalled.first();
        if let Some(import) = &mut self.importing {
            import.is_still = first.is_some_and(|name| name == IMPORT);
        }
        let is_said = self.notice.as_ref().is_some_and(Notice::is_of_stalled_work);
        match first.filter(|name| *name != IMPORT) {
            Some(name) if !is_said => {
                let sentence = format!("{name} has made no progress for {PATIENCE} s. Esc stops it.");
                self.notice = Some(Notice::of_stalled_work(sentence));
            }
            None if is_said => self.notice = None,
            _ => {}
        }
    }

    fn works(&self) -> [LongWork; 7] {
        let Self { session, laboratory, layout, importing, exporting, .. } = self;
        let is_in_sight = |kind| layout.in_sight().contains(&kind);
        let Laboratory { seeds, tuning, sensors, state, .. } = laboratory;
        let map = laboratory.progress().filter(|_| laboratory.is_working() && !state.is_stopped);
        let runs = seeds.progress().filter(|_| seeds.is_working()).map(|[done, _]| done as f64);
        let tuning = tuning.progress().filter(|_| is_in_sight(ViewKind::Tune));
        let sensors = sensors.progress();
        [
            (IMPORT, importing.as_ref().and_then(Import::progress), |app| app.importing = None),
            ("The computation of the plots", session.progress(), |app| _ = app.session.cancel()),
            ("The map", map, |app| _ = app.laboratory.set_stopped(true)),
            ("The runs with many seeds", runs, |app| _ = app.laboratory.seeds.set_stopped(true)),
            ("The tuning", tuning, |app| _ = app.laboratory.tuning.cancel()),
            ("The comparison of sensors", sensors, |app| _ = app.laboratory.sensors.set_stopped(true)),
            ("The export", exporting.as_ref().map(Exporting::progress), |app| app.exporting = None),
        ]
    }

    pub(super) fn stop_stalled(&mut self) {
        let Some(first) = self.stalled.first() else { return };
        for (.., stop) in self.works().into_iter().filter(|(name, ..)| *name == first) {
            stop(self);
        }
        self.stalled.works.clear();
    }
}
