//! Events of the record: changes of the truth, bad parts of filters, missing readings and the marks A and B, over a time slider.

use std::ops::RangeInclusive;

use egui::{Align2, Color32, FontId, Rangef, Rect, Response, Shape, Slider, Stroke, Ui, lerp, pos2, vec2};
use kalmanscope_core::{Scenario, Signal};

use crate::probe::Remembered as _;
use crate::request::Request;
use crate::ruler::{Ruler, RulerEnd};
use crate::session::Session;
use crate::text::significant;
use crate::theme::Palette;
use crate::trouble::Gap;
use crate::widgets::{hover_text, named};

const HEIGHT: f32 = 28.0;

const STRIP: f32 = 3.0;

const STRIPS: usize = 4;

const NEAR: f32 = 5.0;

struct Event {
    times: (f64, f64),
    shape: EventShape,
    color: Color32,
    words: String,
}

#[derive(Clone, Copy, Debug, PartialEq)]
enum EventShape {
    Bad(usize),
    Gap,
    Change,
    Mark(RulerEnd),
}

pub(crate) fn track_ui(
    ui: &mut Ui,
    session: &Session,
    ruler: &Ruler,
    palette: &Palette,
    width: f32,
    requests: &mut Vec<Request>,
) {
    let start = session.run().record().time_of(0);
    let mut time = session.time() - start;
    ui.spacing_mut().slider_width = width;
    ui.spacing_mut().interact_size.y = HEIGHT;
    let events = events(session, ruler, palette);
    // Events lie below the slider's handle, but their places follow from the slider.
    let ground = ui.painter().add(Shape::Noop);
    let slider =
        named(ui.add(Slider::new(&mut time, 0.0..=session.end()).show_value(false)), "Time").remembered("Time");
    let track = TimelineTrack::new(&slider, start..=start + session.end());
    let shapes = events.iter().flat_map(|event| track.shapes(ui, event)).collect();
    ui.painter().set(ground, Shape::Vec(shapes));
    if slider.changed() {
        requests.push(Request::Seek(time));
    }
    let pointer = slider.hover_pos();
    hover_text(slider, &|| {
        let near = |event: &&Event| pointer.is_some_and(|at| track.is_near(event, at.x));
        let told: Vec<&str> = events.iter().filter(near).map(|event| event.words.as_str()).collect();
        if told.is_empty() { "Drag to go to a time".to_owned() } else { told.join("\n") }
    });
}

struct TimelineTrack {
    rect: Rect,
    rail: Rangef,
    times: RangeInclusive<f64>,
}

impl TimelineTrack {
    fn new(slider: &Response, times: RangeInclusive<f64>) -> Self {
        // The slider keeps the room of its handle at both ends.
        let rail = slider.rect.x_range().shrink(slider.rect.height() / 2.5);
        Self { rect: slider.rect, rail, times }
    }

    fn x(&self, time: f64) -> f32 {
        let length = self.times.end() - self.times.start();
        let share = if length > 0.0 { (time - self.times.start()) / length } else { 0.0 };
        lerp(self.rail.min..=self.rail.max, share.clamp(0.0, 1.0) as f32)
    }

    fn is_near(&self, event: &Event, x: f32) -> bool {
        let (from, to) = event.times;
        (self.x(from) - NEAR..=self.x(to) + NEAR).contains(&x)
    }

    fn shapes(&self, ui: &Ui, event: &Event) -> Vec<Shape> {
        let Self { rect, .. } = self;
        let [left, right] = [event.times.0, event.times.1].map(|time| self.x(time));
        let block = |top: f32, height: f32| {
            let rect = Rect::from_min_max(pos2(left, top), pos2(right.max(left + 2.0), top + height));
            Shape::rect_filled(rect, 1.0, event.color)
        };
        match event.shape {
            EventShape::Bad(row) => vec![block(rect.center().y + 6.0 + STRIP * row as f32, STRIP - 0.5)],
            EventShape::Gap => vec![block(rect.center().y - 9.0, 4.0)],
            EventShape::Change => {
                let y = rect.top() + 1.0;
                let corners = vec![pos2(left - 4.0, y), pos2(left + 4.0, y), pos2(left, y + 7.0)];
                vec![Shape::convex_polygon(corners, event.color, Stroke::NONE)]
            }
            EventShape::Mark(end) => {
                let line = Shape::vline(left, rect.y_range(), Stroke::new(1.0, event.color));
                let font = FontId::proportional(9.0);
                let at = pos2(left, rect.top()) + vec2(2.0, 0.0);
                let letter =
                    ui.fonts_mut(|fonts| Shape::text(fonts, at, Align2::LEFT_TOP, end.name(), font, event.color));
                vec![line, letter]
            }
        }
    }
}

fn events(session: &Session, ruler: &Ruler, palette: &Palette) -> Vec<Event> {
    let run = session.run();
    let record = run.record();
    let mut events: Vec<Event> = changes(run.scenario())
        .map(|(time, words)| Event { times: (time, time), shape: EventShape::Change, color: palette.truth, words })
        .collect();
    for gap in Gap::all(session) {
        events.push(Event { times: gap.times, shape: EventShape::Gap, color: palette.weak, words: gap.words() });
    }
    for (place, estimates) in run.estimates().iter().enumerate().take(STRIPS) {
        let Some(diagnosis) = session.diagnosis(place) else { continue };
        for part in &diagnosis.bad_parts {
            let last = part.end.min(record.len()).saturating_sub(1);
            let times = (record.time(part.start.min(last)), record.time(last));
            let [from, to] = [times.0, times.1].map(|time| significant(time, 3));
            let words = format!("{}: its band is wrong from {from} to {to} s", estimates.name());
            events.push(Event { times, shape: EventShape::Bad(place), color: palette.shade(estimates.color()), words });
        }
    }
    for end in RulerEnd::BOTH {
        if let Some(time) = ruler.time(end) {
            let words = format!("{} at {} s", end.name(), significant(time, 4));
            events.push(Event { times: (time, time), shape: EventShape::Mark(end), color: palette.text, words });
        }
    }
    events
}

fn changes(scenario: &Scenario) -> impl Iterator<Item = (f64, String)> {
    let of_channel = |channel: kalmanscope_core::Channel| {
        let name = channel.name();
        match scenario.plant.parameter(channel) {
            Some(Signal::Step(step)) if step.from != step.to => {
                vec![(step.at, format!("{name} changes at {} s", significant(step.at, 4)))]
            }
            Some(Signal::Ramp(ramp)) if ramp.from != ramp.to => vec![
                (ramp.start, format!("{name} begins to change at {} s", significant(ramp.start, 4))),
                (ramp.end, format!("{name} has changed at {} s", significant(ramp.end, 4))),
            ],
            _ => Vec::new(),
        }
    };
    let is_simulated = scenario.record.is_none();
    scenario.plant.parameters().flat_map(of_channel).filter(move |_| is_simulated)
}
