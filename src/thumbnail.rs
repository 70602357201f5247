//! Small pictures in menus: of a scenario what moves, and of a lesson the plot that its file chooses.

use std::sync::{Arc, Mutex, PoisonError};

use egui::{Color32, Context, Id};
use kalmanscope_core::{Axis, Channel, Estimates, Evidence, ModelClasses, Record, Run, Scenario};
use kalmanscope_lab::{Ensemble, Plan, Runner};
use kalmanscope_lessons::records::source;
use kalmanscope_lessons::{self as lessons, BuiltIn, Lesson, PictureCourse};

use crate::session::Budget;
use crate::spark::{Spark, SparkInk, SparkMark, SparkPicture, range};
use crate::theme;

/// The room above and below the courses, as a share of their range.
const MARGIN: f64 = 0.08;

/// A picture takes its range from the time after this share of it, because a first guess may be far off.
const BEGINNING: usize = 20;

const PIECE: usize = 32;

const PORTION: usize = 8;

const CELLS: [usize; 2] = [24, 12];

#[derive(Clone)]
enum Thumbnail {
    Making(Arc<Mutex<Making>>),
    Made(Option<Arc<SparkPicture>>),
}

struct Making {
    work: Work,
    picture: Option<lessons::LessonPicture>,
}

enum Work {
    Run(Box<Run>),
    Map(Box<Runner>, Vec<f64>),
}

pub(crate) fn of_scenario(ctx: &Context, entry: &BuiltIn) -> Option<Arc<SparkPicture>> {
    in_turn(ctx, entry.file, || Making::motion(&entry.scenario().ok()?))
}

pub(crate) fn of_lesson(ctx: &Context, lesson: &Lesson) -> Option<Arc<SparkPicture>> {
    in_turn(ctx, &lesson.title, || Making::of_lesson(lesson))
}

fn in_turn(ctx: &Context, name: &str, begin: impl FnOnce() -> Option<Making>) -> Option<Arc<SparkPicture>> {
    let id = Id::unique(("thumbnail", name));
    let kept = ctx.data(|data| data.get_temp::<Thumbnail>(id));
    if let Some(Thumbnail::Made(made)) = kept {
        return made;
    }
    let (turn, frame) = (Id::unique("thumbnail made"), ctx.cumulative_frame_nr());
    ctx.request_repaint();
    // One picture a frame, so that a menu of many opens at once.
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
        Some(Self { work: run(&scenario)?, picture: None })
    }

    fn of_lesson(lesson: &Lesson) -> Option<Self> {
        let picture = lesson.picture.clone()?;
        let number = picture.step.checked_sub(1)?;
        let mut scenario = lesson.scenario_at(number).ok()?;
        let work = if picture.show == PictureCourse::Map {
            let map = lesson.steps.get(number)?.map.as_ref()?;
            scenario.filters.retain(|filter| filter.name == map.filter);
            let axis = |text: &str, count: usize| Some(Axis { count, ..Axis::parse(text).ok()? });
            let axes = vec![axis(&map.x, CELLS[0])?, axis(&map.y, CELLS[1])?];
            let plan = Plan { filters: vec![0], measures: vec![map.measure], axes, times: 0 };
            let source = source(&scenario).ok()?;
            Work::Map(Box::new(Runner::new(Ensemble::new(scenario, plan).ok()?, source).ok()?), Vec::new())
        } else {
            scenario.filters.retain(|filter| picture.filters.is_empty() || picture.filters.contains(&filter.name));
            run(&scenario)?
        };
        Some(Self { work, picture: Some(picture) })
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        loop {
            let is_done = match &mut self.work {
                Work::Run(run) => {
                    let before = run.done();
                    run.advance_to(before + PIECE);
                    // A truth that overflows ends before.
                    run.done() == before || run.done() == run.samples()
                }
                Work::Map(runner, scores) => {
                    let end = runner.ensemble().cells().min(scores.len() + PORTION);
                    scores.extend(runner.rows(&(scores.len()..end).collect::<Vec<_>>()));
                    scores.len() == runner.ensemble().cells()
                }
            };
            if is_done || !while_time() {
                return is_done;
            }
        }
    }

    fn picture(&self) -> Option<SparkPicture> {
        match (&self.work, &self.picture) {
            (Work::Map(_, scores), _) => Some(SparkPicture { cells: (CELLS[1], colors(scores)), ..Default::default() }),
            (Work::Run(run), Some(picture)) => Some(sketch(run, picture)),
            (Work::Run(run), None) => {
                let record = run.record();
                let sensor = || (!record.sensors().is_empty()).then(|| record.measured(0));
                let motion = record.truth(Channel::DISPLACEMENT).or_else(sensor)?;
                let courses = vec![(SparkMark::Line, SparkInk::Text, Spark::new(motion))];
                Some(SparkPicture { courses, ..SparkPicture::default() })
            }
        }
    }
}

fn run(scenario: &Scenario) -> Option<Work> {
    Run::from_source(scenario, source(scenario).ok()?).ok().map(Box::new).map(Work::Run)
}

fn colors(scores: &[f64]) -> Vec<Color32> {
    let decades: Vec<f64> = scores.iter().map(|score| score.abs().max(f64::MIN_POSITIVE).log10()).collect();
    let mut sorted: Vec<f64> = decades.iter().copied().filter(|score| score.is_finite()).collect();
    sorted.sort_by(f64::total_cmp);
    // Without the outermost cells: a filter that is lost in one would take the whole range of colours.
    let few = sorted.len() / 20;
    let [low, high] = [few, sorted.len().saturating_sub(few + 1)].map(|at| sorted.get(at).copied().unwrap_or(0.0));
    let share = |score: &f64| if score.is_finite() { (score - low) / (high - low).max(1e-9) } else { 1.0 };
    decades.iter().map(|score| theme::sequential(share(score) as f32)).collect()
}

type SparkValues<'a> = Box<dyn Fn(usize) -> [f64; 2] + 'a>;

fn sketch(run: &Run, picture: &lessons::LessonPicture) -> SparkPicture {
    let (record, show) = (run.record(), picture.show);
    let first = || run.channels().into_iter().find(|channel| channel.is_parameter());
    let channel = picture.channel.or_else(first).unwrap_or(Channel::DISPLACEMENT);
    let sensor = picture.sensor.and_then(|sensor| sensor.place_in(record.sensors())).unwrap_or(0);
    let reading = |place: usize| -> SparkValues<'_> { Box::new(move |k| [record.measured(place)[k]; 2]) };
    let smoothed = run.smoothed();
    let evidence: &[Evidence] = &run.estimates().iter().map(Evidence::new).collect::<Vec<_>>();
    let mut drawn: Vec<(SparkMark, SparkInk, SparkValues<'_>)> = Vec::new();
    match show {
        PictureCourse::Measured => drawn.push((SparkMark::Line, SparkInk::Text, reading(sensor))),
        PictureCourse::Estimate => {
            let reads = record.sensors().iter().position(|sensor| sensor.channel() == Some(channel));
            drawn.extend(reads.map(|place| (SparkMark::Dots, SparkInk::Truth, reading(place))));
            if let Some(truth) = record.truth(channel) {
                drawn.push((SparkMark::Line, SparkInk::Truth, Box::new(|k| [truth[k]; 2])));
            }
        }
        PictureCourse::LearntNoise => {
            let std = run.scenario().sensors.get(sensor).map_or(f64::NAN, |sensor| sensor.noise_std);
            drawn.push((SparkMark::Line, SparkInk::Truth, Box::new(move |_| [std; 2])));
        }
        _ => {}
    }
    let probability = |place: usize, k: usize| {
        let all = ModelClasses::new(evidence.iter().map(|one| one.at(k).unwrap_or(f64::NEG_INFINITY)));
        [place, place + 1].map(|count| all.probabilities.iter().take(count).sum())
    };
    for (place, estimates) in run.estimates().iter().chain(&smoothed).enumerate() {
        let ink = SparkInk::Filter(estimates.color());
        if show == PictureCourse::Probability {
            drawn.push((SparkMark::Band, ink, Box::new(move |k| probability(place, k))));
            continue;
        }
        let belief = move |k: usize| belief(estimates, record, (show, channel, sensor), k).unwrap_or([f64::NAN; 2]);
        let is_centred = matches!(show, PictureCourse::Error | PictureCourse::Innovation);
        let band = move |k: usize| {
            let [mean, std] = belief(k);
            [-2.0, 2.0].map(|sigmas| sigmas * std + if is_centred { 0.0 } else { mean })
        };
        let mark = if show == PictureCourse::Innovation { SparkMark::Dots } else { SparkMark::Line };
        drawn.push((SparkMark::Band, ink, Box::new(band)));
        drawn.push((mark, ink, Box::new(move |k| [belief(k)[0]; 2])));
    }
    let sample = |time: f64| ((time / record.dt()).round() as usize).min(run.len());
    let (begin, end) = (picture.from.map_or(0, sample), picture.to.map_or(run.len(), sample));
    let len = end.saturating_sub(begin);
    // A band may begin far wider than it ends.
    let is_narrow = |mark: SparkMark| mark != SparkMark::Band || show == PictureCourse::Probability;
    let narrow = drawn.iter().filter(|(mark, ..)| is_narrow(*mark));
    let late = narrow.flat_map(|(_, _, of)| (begin + len / BEGINNING..end).flat_map(of)).collect::<Vec<f64>>();
    let (low, high) = picture.range.map_or_else(|| range(&late), |[low, high]| (low, high));
    let margin = if show == PictureCourse::Probability { 0.0 } else { MARGIN * (high - low) };
    let bounds = if low < high { (low - margin, high + margin) } else { (low - 1.0, low + 1.0) };
    let spark = |of: &SparkValues<'_>| Spark::over(bounds, len, |k| of(begin + k));
    let courses = drawn.iter().map(|(mark, ink, of)| (*mark, *ink, spark(of))).collect();
    SparkPicture { courses, ..SparkPicture::default() }
}

fn belief(
    estimates: &Estimates,
    record: &Record,
    (show, channel, sensor): (PictureCourse, Channel, usize),
    k: usize,
) -> Option<[f64; 2]> {
    if k >= estimates.len() {
        return None;
    }
    let of_channel = || {
        let place = estimates.place(channel)?;
        Some([estimates.canonical_mean(k, place), estimates.std(k, place)])
    };
    match show {
        PictureCourse::Estimate => of_channel(),
        PictureCourse::Error => of_channel().and_then(|[mean, std]| Some([mean - record.truth(channel)?.get(k)?, std])),
        PictureCourse::Innovation => {
            let sensors = estimates.sensors().len();
            let variance = estimates.innovation_cov(k).get(sensor * (sensors + 1))?;
            Some([*estimates.innovation(k).get(sensor)?, variance.sqrt()])
        }
        PictureCourse::LearntNoise => estimates.sensor_noise(k, sensor),
        PictureCourse::ProcessScale => estimates.process_scale(k),
        PictureCourse::Measured | PictureCourse::Probability | PictureCourse::Map => None,
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
            let done = |making: &Making| match &making.work {
                Work::Run(run) => (run.done(), PIECE),
                Work::Map(_, scores) => (scores.len(), PORTION),
            };
            // One piece at a time: no frame waits for a whole run.
            let mut before = 0;
            while !making.advance(&mut || false) {
                let (now, piece) = done(&making);
                assert!((before + 1..=before + piece).contains(&now), "{title}");
                before = now;
            }
            let SparkPicture { courses, cells } = making.picture().unwrap_or_else(|| panic!("{title}"));
            // A scenario may have nothing that moves.
            let is_flat = courses.iter().all(|(_, _, spark)| spark.is_flat()) && cells.1.is_empty();
            assert!(!is_flat || making.picture.is_none(), "{title}");
        }
    }
}
