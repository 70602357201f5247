//! Small pictures of built-in scenarios in menus: what moves, over time.

use std::sync::Arc;

use egui::{Context, Id};
use kalmanscope_core::{Channel, simulate};
use kalmanscope_lessons::BuiltIn;
use kalmanscope_lessons::records::source;

use crate::spark::Spark;

/// The picture of a scenario: its first mass, or the first sensor of its measured record. At most one is made in a frame, so that a
/// menu opens at once; `None` until it is made, or if there is none.
pub(crate) fn thumbnail(ctx: &Context, entry: &BuiltIn) -> Option<Arc<Spark>> {
    let id = Id::unique(("thumbnail", entry.file));
    if let Some(made) = ctx.data(|data| data.get_temp::<Option<Arc<Spark>>>(id)) {
        return made;
    }
    let (turn, frame) = (Id::unique("thumbnail made"), ctx.cumulative_frame_nr());
    if ctx.data(|data| data.get_temp::<u64>(turn)) == Some(frame) {
        ctx.request_repaint();
        return None;
    }
    let made = make(entry).map(Arc::new);
    ctx.data_mut(|data| {
        data.insert_temp(turn, frame);
        data.insert_temp(id, made.clone());
    });
    made
}

fn make(entry: &BuiltIn) -> Option<Spark> {
    let scenario = entry.scenario().ok()?;
    let given = source(&scenario).ok()?.record().map(Arc::clone);
    let record = given.unwrap_or_else(|| Arc::new(simulate(&scenario)));
    let sensor = || (!record.sensors().is_empty()).then(|| record.measured(0));
    let motion = record.truth(Channel::DISPLACEMENT).or_else(sensor)?;
    Some(Spark::new(motion))
}

#[cfg(test)]
mod tests {
    use kalmanscope_lessons::{BUILT_IN, EQUATIONS};

    use super::*;

    #[test]
    fn every_built_in_scenario_has_a_picture_and_a_frame_makes_one() {
        let ctx = Context::default();
        for entry in BUILT_IN.iter().chain(EQUATIONS) {
            assert!(make(entry).is_some(), "{}", entry.title);
        }
        let frame = |check: &dyn Fn(&Context)| {
            ctx.run_ui(egui::RawInput::default(), |ui| check(ui.ctx())).textures_delta.clear();
        };
        frame(&|ctx| {
            assert!(thumbnail(ctx, &BUILT_IN[0]).is_some());
            assert!(thumbnail(ctx, &BUILT_IN[1]).is_none());
        });
        frame(&|ctx| assert!(thumbnail(ctx, &BUILT_IN[1]).is_some()));
    }
}
