//! Small pictures in menus: of a scenario what moves, and of a lesson what its first filter makes of a parameter, over time.

use std::sync::{Arc, Mutex, PoisonError};

use egui::{Context, Id};
use kalmanscope_core::{Channel, Run, Scenario};
use kalmanscope_lessons::records::source;
use kalmanscope_lessons::{BuiltIn, Lesson};

use crate::session::Budget;
use crate::spark::{Picture, Spark, range};

const BEGINNING: usize = 20;

const LEAST: f64 = 0.1;

const PIECE: usize = 32;

#[derive(Clone)]
enum Thumbnail {
    Making(Arc<Mutex<Making>>),
    Made(Option<Arc<Picture>>),
}

struct Making {
    run: Run,
    /// The parameter whose estimate is drawn; the motion if there is none.
    parameter: Option<Channel>,
}

/// The picture of a scenario: its first mass, or the first sensor of its measured record. `None` until it is made, or if there is
/// none.
pub(crate) fn of_scenario(ctx: &Context, entry: &BuiltIn) -> Option<Arc<Picture>> {
    in_turn(ctx, entry.file, || Making::motion(&entry.scenario().ok()?))
}

/// The picture of a lesson: the first parameter that it speaks of, as the first filter estimates it, or the motion. `None` until
/// it is made, or if there is none.
pub(crate) fn of_lesson(ctx: &Context, lesson: &Lesson) -> Option<Arc<Picture>> {
    in_turn(ctx, &lesson.title, || Making::of_lesson(lesson))
}

fn in_turn(ctx: &Context, name: &str, begin: impl FnOnce() -> Option<Making>) -> Option<Arc<Picture>> {
    let id = Id::unique(("thumbnail", name));
    let kept = ctx.data(|data| data.get_temp::<Thumbnail>(id));
    if let Some(Thumbnail::Made(made)) = kept {
        return made;
    }
    let (turn, frame) = (Id::unique("thumbnail made"), ctx.cumulative_frame_nr());
    ctx.request_repaint();
    if ctx.data(|data| data.get_temp::<u64>(turn)) == Some(frame) {
        return None;
    }
    let making = match kept {
        Some(Thumbnail::Making(making)) => Some(making),
        _ => begin().map(|making| Arc::new(Mutex::new(making))),
    };
    let next = match making {
        None => Thumbnail::Made(None),
        Some(making) => {
            let mut now = making.lock().unwrap_or_else(PoisonError::into_inner);
            let is_done = now.advance(&mut Budget::FRAME.slice());
            let made = is_done.then(|| now.picture().map(Arc::new));
            drop(now);
            made.map_or(Thumbnail::Making(making), Thumbnail::Made)
        }
    };
    let made = if let Thumbnail::Made(made) = &next { made.clone() } else { None };
    ctx.data_mut(|data| {
        data.insert_temp(turn, frame);
        data.insert_temp(id, next);
    });
    made
}

impl Making {
    fn motion(scenario: &Scenario) -> Option<Self> {
        let scenario = Scenario { filters: Vec::new(), ..scenario.clone() };
        let run = Run::from_source(&scenario, source(&scenario).ok()?).ok()?;
        Some(Self { run, parameter: None })
    }

    fn of_lesson(lesson: &Lesson) -> Option<Self> {
        let scenario = lesson.first_scenario().ok()?;
        let of_step = lesson.steps.iter().flat_map(|step| step.channels.iter().copied());
        let parameters = scenario.plant.kind.channels().iter().copied();
        let mut channels = of_step.chain(parameters).filter(|channel| channel.is_parameter());
        // One that samples takes long.
        let first = scenario.filters.first().filter(|filter| !filter.kind.is_sampled());
        let alone = first.map(|first| Scenario { filters: vec![first.clone()], ..scenario.clone() });
        let run = alone.and_then(|alone| Run::from_source(&alone, source(&alone).ok()?).ok());
        let parameter = run.as_ref().and_then(|run| {
            let estimates = run.estimates().first()?;
            channels.find(|channel| estimates.place(*channel).is_some())
        });
        match (run, parameter) {
            (Some(run), Some(parameter)) => Some(Self { run, parameter: Some(parameter) }),
            _ => Self::motion(&scenario),
        }
    }

    /// Continues until `while_time` returns false. Returns whether the run is at its end.
    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        let Self { run, .. } = self;
        while run.done() < run.samples() {
            let before = run.done();
            run.advance_to(before + PIECE);
            // A truth that overflows ends before.
            if run.done() == before {
                break;
            }
            if !while_time() {
                return false;
            }
        }
        true
    }

    fn picture(&self) -> Option<Picture> {
        let Self { run, parameter } = self;
        let record = run.record();
        let Some(channel) = *parameter else {
            let sensor = || (!record.sensors().is_empty()).then(|| record.measured(0));
            let motion = record.truth(Channel::DISPLACEMENT).or_else(sensor)?;
            return Some(Picture { course: Spark::new(motion), truth: None });
        };
        let estimates = run.estimates().first()?;
        let place = estimates.place(channel)?;
        let course: Vec<f64> = (0..estimates.len()).map(|k| estimates.mean(k)[place]).collect();
        let truth = record.truth(channel);
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
}

#[cfg(test)]
mod tests {
    use kalmanscope_lessons::{BUILT_IN, EQUATIONS, lessons};

    use super::*;

    #[test]
    fn every_lesson_and_every_built_in_scenario_has_a_picture() {
        let lessons: Vec<Lesson> = lessons().into_iter().map(Result::unwrap).collect();
        let of_lessons = lessons.iter().map(|lesson| (lesson.title.as_str(), Making::of_lesson(lesson)));
        let built_in = BUILT_IN.iter().chain(EQUATIONS);
        let of_scenarios = built_in.map(|entry| (entry.title, Making::motion(&entry.scenario().unwrap())));
        for (title, making) in of_lessons.chain(of_scenarios) {
            let mut making = making.unwrap_or_else(|| panic!("{title}"));
            // One piece at a time: no frame waits for a whole run.
            let (mut pieces, mut before) = (0, 0);
            while !making.advance(&mut || false) {
                assert!(making.run.done() <= before + PIECE, "{title}");
                (pieces, before) = (pieces + 1, making.run.done());
            }
            assert!(pieces >= making.run.samples() / PIECE - 1, "{title}: {pieces}");
            assert!(making.picture().is_some(), "{title}");
        }
    }

    #[test]
    fn pictures_come_one_after_the_other() {
        let ctx = Context::default();
        let mut came = [None; 2];
        for frame in 0..10_000 {
            let mut shown = [false; 2];
            ctx.run_ui(egui::RawInput::default(), |ui| {
                shown = [0, 1].map(|at| of_scenario(ui.ctx(), &BUILT_IN[at]).is_some());
            })
            .textures_delta
            .clear();
            for (came, _) in came.iter_mut().zip(shown).filter(|(came, shown)| came.is_none() && *shown) {
                *came = Some(frame);
            }
            if came[1].is_some() {
                break;
            }
        }
        assert!(came[0].is_some() && came[0] < came[1], "{came:?}");
    }
}
