//! Small pictures in menus: of a scenario what moves, and of a lesson what its first filter makes of a parameter, over time.

use std::sync::Arc;

use egui::{Context, Id};
use kalmanscope_core::{Channel, Run, Scenario, simulate};
use kalmanscope_lessons::records::source;
use kalmanscope_lessons::{BuiltIn, Lesson};

use crate::spark::{Picture, Spark, range};

/// The share of a record at its beginning in which an estimate may leave the picture.
const BEGINNING: usize = 20;

/// The least height of a picture of a parameter, over its size.
const LEAST: f64 = 0.1;

/// The picture of a scenario: its first mass, or the first sensor of its measured record. `None` until it is made, or if there is
/// none.
pub(crate) fn of_scenario(ctx: &Context, entry: &BuiltIn) -> Option<Arc<Picture>> {
    in_turn(ctx, entry.file, || motion(&entry.scenario().ok()?))
}

/// The picture of a lesson: the first parameter that it speaks of, as the first filter estimates it, or what moves. `None` until
/// it is made, or if there is none.
pub(crate) fn of_lesson(ctx: &Context, lesson: &Lesson) -> Option<Arc<Picture>> {
    in_turn(ctx, &lesson.title, || {
        let scenario = lesson.first_scenario().ok()?;
        let of_step = lesson.steps.iter().flat_map(|step| step.channels.iter().copied());
        let parameters = scenario.plant.kind.channels().iter().copied();
        let mut channels = of_step.chain(parameters).filter(|channel| channel.is_parameter());
        channels.find_map(|channel| estimate(&scenario, channel)).or_else(|| motion(&scenario))
    })
}

/// Makes a picture, at most one in a frame, so that a menu opens at once.
fn in_turn(ctx: &Context, name: &str, make: impl FnOnce() -> Option<Picture>) -> Option<Arc<Picture>> {
    let id = Id::unique(("thumbnail", name));
    if let Some(made) = ctx.data(|data| data.get_temp::<Option<Arc<Picture>>>(id)) {
        return made;
    }
    let (turn, frame) = (Id::unique("thumbnail made"), ctx.cumulative_frame_nr());
    if ctx.data(|data| data.get_temp::<u64>(turn)) == Some(frame) {
        ctx.request_repaint();
        return None;
    }
    let made = make().map(Arc::new);
    ctx.data_mut(|data| {
        data.insert_temp(turn, frame);
        data.insert_temp(id, made.clone());
    });
    made
}

fn motion(scenario: &Scenario) -> Option<Picture> {
    let given = source(scenario).ok()?.record().map(Arc::clone);
    let record = given.unwrap_or_else(|| Arc::new(simulate(scenario)));
    let sensor = || (!record.sensors().is_empty()).then(|| record.measured(0));
    let motion = record.truth(Channel::DISPLACEMENT).or_else(sensor)?;
    Some(Picture { course: Spark::new(motion), truth: None })
}

/// The estimate of a channel by the first filter of a scenario, unless that filter takes long.
fn estimate(scenario: &Scenario, channel: Channel) -> Option<Picture> {
    let first = scenario.filters.first().filter(|filter| !filter.kind.is_sampled())?;
    let scenario = Scenario { filters: vec![first.clone()], ..scenario.clone() };
    let mut run = Run::from_source(&scenario, source(&scenario).ok()?).ok()?;
    run.finish();
    let estimates = run.estimates().first()?;
    let place = estimates.place(channel)?;
    let course: Vec<f64> = (0..estimates.len()).map(|k| estimates.mean(k)[place]).collect();
    let truth = run.record().truth(channel);
    let late = range(course.get(course.len() / BEGINNING..)?);
    let (low, high) = truth.map_or(late, |truth| {
        let (low, high) = range(truth);
        (low.min(late.0), high.max(late.1))
    });
    let middle = 0.5 * (low + high);
    let half = (0.6 * (high - low)).max(LEAST * middle.abs());
    let shape = |values: &[f64]| Spark::between((middle - half, middle + half), values);
    Some(Picture { course: shape(&course), truth: truth.map(shape) })
}

#[cfg(test)]
mod tests {
    use kalmanscope_lessons::{BUILT_IN, EQUATIONS, lessons};

    use super::*;

    #[test]
    fn every_lesson_has_a_picture() {
        for lesson in lessons().into_iter().map(Result::unwrap) {
            assert!(of_lesson(&Context::default(), &lesson).is_some(), "{}", lesson.title);
        }
    }

    #[test]
    fn every_built_in_scenario_has_a_picture_and_a_frame_makes_one() {
        let ctx = Context::default();
        for entry in BUILT_IN.iter().chain(EQUATIONS) {
            assert!(motion(&entry.scenario().unwrap()).is_some(), "{}", entry.title);
        }
        let frame = |check: &dyn Fn(&Context)| {
            ctx.run_ui(egui::RawInput::default(), |ui| check(ui.ctx())).textures_delta.clear();
        };
        frame(&|ctx| {
            assert!(of_scenario(ctx, &BUILT_IN[0]).is_some());
            assert!(of_scenario(ctx, &BUILT_IN[1]).is_none());
        });
        frame(&|ctx| assert!(of_scenario(ctx, &BUILT_IN[1]).is_some()));
    }
}
