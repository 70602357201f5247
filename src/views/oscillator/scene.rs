//! Everything in the picture at one moment.

use egui::text::LayoutJob;
use egui::{Align2, Color32, FontId, Painter, Pos2, Rect, Shape, Stroke, pos2, vec2};
use kalmanscope_core::plant::Spring;
use kalmanscope_core::{Aspect, Channel, Estimates, Quantity, Record};

use super::parts::{Belief, Ink, Link, arrow, body, cloud, ghosts, ground, link, name, slice};
use super::peaks::{displacement, recent};
use super::stage::Stage;
use crate::equation::job;
use crate::plot::strokes::Strokes;
use crate::theme::Palette;
use crate::view::ViewContext;

/// The distance of captions from the left \[points\].
const CORNER: f32 = 10.0;

/// Limits the share of the picture that an equation above it takes.
const STRIP: f32 = 0.4;

/// The least size of a typeset equation; its subscripts are smaller \[points\].
const LEAST_EQUATION: f32 = 12.5;

pub(super) struct Scene<'a> {
    pub(super) stage: &'a Stage,
    pub(super) painter: &'a Painter,
    pub(super) context: &'a ViewContext<'a>,
    pub(super) k: usize,
}

impl<'a> Scene<'a> {
    /// Draws ground and masses; the largest force so far has the longest arrow \[m/s²\].
    pub(super) fn masses(&self, largest_force: f64) {
        let Self { stage, painter, context, k } = *self;
        let ViewContext { palette, visible, .. } = *context;
        ground(stage, painter, context.unit("m"), palette);
        let record = self.record();
        let kind = &context.session.run().scenario().plant.kind;
        let spring = kind.info().spring;
        // Filters may have more masses than the truth.
        let is_known = |mass: usize| mass < kind.masses();
        let force = recent(record, k);
        let share = force / largest_force.max(force.abs()).max(1e-12);
        let mut before = (stage.wall, 0.0);
        for mass in 0..stage.masses {
            let beliefs: Vec<Belief> = self.filters(mass).filter_map(|filter| filter.belief(k)).collect();
            let truth = self.truth(mass);
            let known = truth.and_then(|x| x.get(k)).copied().filter(|x| x.is_finite());
            // Without a truth the springs show the estimate of the first filter.
            if let Some(x) = known.or(beliefs.first().map(|belief| belief.mean)) {
                let line = if known.is_some() { palette.truth } else { palette.weak };
                let mixed = |share| palette.ground.lerp_to_gamma(line, share);
                let at = stage.body(mass, x);
                let ink = Ink { line, back: mixed(0.45), fill: mixed(0.08) };
                if !is_known(mass) || kind.is_held(mass) {
                    link(stage, painter, link_kind(spring, record, x, k), before.0, at, x - before.1, ink);
                }
                let mast = [at.center_top(), pos2(at.center().x, stage.arrow)];
                painter.line_segment(mast, Stroke::new(1.2 * stage.unit, line));
                if known.is_some() {
                    body(stage, painter, at, palette);
                }
                before = (at.right(), x);
            }
            ghosts(stage, painter, mass, &beliefs, visible.bands);
            if known.is_some() && stage.masses == 1 {
                name(painter, stage.body(mass, before.1), beliefs.len(), palette);
            }
            if let Some(readings) = self.readings(mass) {
                cloud(stage, painter, mass, readings, truth, k, palette.measured);
            }
            if !is_known(mass) || kind.is_driven(mass) {
                arrow(stage, painter, stage.body(mass, before.1).center().x, share, palette.force);
            }
        }
    }

    pub(super) fn slices(&self) -> Vec<(Rect, u32, &'a str)> {
        let of_mass = |mass: usize| {
            let believed = self.filters(mass).filter_map(|filter| Some((filter.belief(self.k)?, filter.estimates)));
            let believed: Vec<_> = believed.collect();
            let count = believed.len();
            let slices = believed.into_iter().enumerate().map(move |(place, (belief, estimates))| {
                (slice(self.stage, mass, (place, count), belief.mean), estimates.id(), estimates.name())
            });
            slices.collect::<Vec<_>>()
        };
        (0..self.stage.masses).flat_map(of_mass).collect()
    }

    pub(super) fn trail(&self, paper: Rect) {
        let Self { stage, painter, context, k } = *self;
        let ViewContext { palette, visible, .. } = *context;
        let lines = stage.masses * (1 + self.filters(0).count());
        let trail = Trail::new(stage, painter, paper, self.record(), k, lines);
        trail.paper(palette);
        for mass in 0..stage.masses {
            if let Some(readings) = self.readings(mass) {
                trail.dots(mass, readings, palette.measured);
            }
            if let Some(truth) = self.truth(mass) {
                trail.line(mass, 3.0, palette.truth, |k| truth.get(k).copied());
            }
            for filter in self.filters(mass) {
                if visible.bands {
                    let band = |k| filter.belief(k).map(|belief| (belief.mean, 2.0 * belief.std));
                    trail.band(mass, filter.color.gamma_multiply(0.22), band);
                }
                trail.line(mass, 1.4, filter.color, |k| filter.belief(k).map(|belief| belief.mean));
            }
        }
    }

    fn record(&self) -> &'a Record {
        self.context.session.run().record()
    }

    fn truth(&self, mass: usize) -> Option<&'a [f64]> {
        self.record().truth(displacement(mass)).filter(|_| self.context.visible.truth)
    }

    fn readings(&self, mass: usize) -> Option<&'a [f64]> {
        let sensor = Quantity::new(Aspect::DISPLACEMENT, mass);
        self.record().measured_quantity(sensor).filter(|_| self.context.visible.measured)
    }

    fn filters(&self, mass: usize) -> impl Iterator<Item = Filter<'a>> {
        self.context.filters().filter_map(move |(_, estimates)| {
            let color = self.context.color(estimates);
            Some(Filter { estimates, at: estimates.place(displacement(mass))?, color })
        })
    }

    fn room(&self) -> Rect {
        let stage = self.stage;
        let corner = stage.rect.left_top() + vec2(CORNER, 4.0 * stage.unit);
        Rect::from_min_max(corner, pos2(stage.rest(0) - stage.travel - stage.body.x, stage.body(0, 0.0).top()))
    }

    fn equation(&self) -> LayoutJob {
        let kind = &self.context.session.run().scenario().plant.kind;
        let (font, color) = (self.stage.font(), self.context.palette.weak);
        match kind.own_equation() {
            Some(own) => {
                let font = FontId { size: font.size.max(LEAST_EQUATION), ..font };
                job(&own.settings().equation, &font, color)
            }
            None => LayoutJob::simple_singleline(kind.equation().to_owned(), font, color),
        }
    }

    /// The height of a strip above the picture \[points\], for a typed equation that is too long for the room above the
    /// spring. `None` if no strip is needed, or the picture under it would be too low.
    pub(super) fn strip(&self) -> Option<f32> {
        let (room, rect) = (self.room().size(), self.stage.rect);
        self.context.session.run().scenario().plant.kind.own_equation()?;
        let mut whole = self.equation();
        let size = self.painter.layout_job(whole.clone()).size();
        whole.wrap.max_width = rect.width() - 2.0 * CORNER;
        let height = self.painter.layout_job(whole).size().y + 2.0;
        ((size.x > room.x || size.y > room.y) && height < STRIP * rect.height()).then_some(height)
    }

    /// Writes the equation and the measured quantities above the spring, where there is room, or the equation in a strip above
    /// the picture. Returns the place of the equation.
    pub(super) fn captions(&self, strip: Option<Rect>) -> Option<Rect> {
        let ViewContext { session, palette, visible, .. } = *self.context;
        let room = self.room();
        let told = match strip {
            None => self.write(self.equation(), room),
            Some(strip) => {
                let mut whole = self.equation();
                let strip = strip.shrink2(vec2(CORNER, 0.0));
                whole.wrap.max_width = strip.width();
                self.write(whole, strip)
            }
        };
        let sensors = session.run().record().sensors();
        let mut measured = sensors.iter().map(|q| q.symbol()).collect::<Vec<_>>().join(", ");
        // Of the measured quantities, only a displacement has a channel as its rate of change.
        if !sensors.iter().any(|q| q.channel().and_then(Channel::rate).is_some()) {
            measured += ", not x";
        }
        if visible.measured && !sensors.is_empty() {
            let text = format!("measured: {measured}");
            let below = told.map_or(room, |told| room.with_min_y(told.bottom().max(room.top())));
            self.write(LayoutJob::simple_singleline(text, self.stage.font(), palette.weak), below);
        }
        told
    }

    fn write(&self, text: LayoutJob, room: Rect) -> Option<Rect> {
        let galley = self.painter.layout_job(text);
        let place = Rect::from_min_size(room.min, galley.size());
        let fits = place.width() <= room.width() + 0.5 && place.bottom() <= room.bottom() + 0.5;
        fits.then(|| {
            self.painter.galley(room.min, galley, self.context.palette.weak);
            place
        })
    }
}

struct Filter<'a> {
    estimates: &'a Estimates,
    at: usize,
    color: egui::Color32,
}

impl Filter<'_> {
    fn belief(&self, k: usize) -> Option<Belief> {
        let Self { estimates, at, color } = *self;
        let mean = (k < estimates.len()).then(|| estimates.mean(k)[at]).filter(|mean| mean.is_finite())?;
        Some(Belief { mean, std: estimates.std(k, at), color })
    }
}

fn link_kind(spring: Spring, record: &Record, x: f64, k: usize) -> Link {
    let known = |channel: Channel| record.truth(channel)?.get(k).copied().filter(|z| z.is_finite());
    match spring {
        Spring::Slipping(channel) => known(channel).map_or(Link::Linear, |z| Link::Slipping(x - z)),
        Spring::Cubic(_) => Link::Hardening,
        Spring::Linear => Link::Linear,
    }
}

/// Speed of the paper \[points/s\].
const SPEED: f32 = 64.0;

const POINTS: usize = 160;
const ALL_POINTS: usize = 2000;

pub(super) struct Trail<'a> {
    stage: &'a Stage,
    painter: Painter,
    paper: Rect,
    record: &'a Record,
    now: usize,
    first: usize,
    stride: usize,
}

impl<'a> Trail<'a> {
    pub(super) fn new(
        stage: &'a Stage,
        painter: &Painter,
        paper: Rect,
        record: &'a Record,
        now: usize,
        lines: usize,
    ) -> Self {
        let samples = (f64::from(paper.height() / SPEED) / record.dt()).min(1e7) as usize;
        let first = now.saturating_sub(samples);
        let points = (ALL_POINTS / lines.max(1)).clamp(POINTS / 2, POINTS);
        let stride = samples.div_ceil(points).max(1);
        Self { stage, painter: painter.with_clip_rect(paper), paper, record, now, first, stride }
    }

    /// The samples that are drawn, the newest first. The choice of samples does not change with time, so that
    /// lines do not shimmer.
    fn samples(&self) -> impl Iterator<Item = usize> {
        let Self { now, first, stride, .. } = *self;
        let older = (first / stride..now.div_ceil(stride)).rev().map(move |i| i * stride);
        std::iter::once(now).chain(older)
    }

    fn at(&self, mass: usize, x: f64, k: usize) -> Pos2 {
        let age = (self.record.time(self.now) - self.record.time(k)) as f32;
        pos2(self.stage.place(mass, x), self.paper.top() + SPEED * age)
    }

    pub(super) fn paper(&self, palette: &Palette) {
        let now = self.record.time(self.now);
        let Self { painter, paper, stage, .. } = self;
        let grid = Stroke::new(1.0, palette.grid.gamma_multiply(0.35));
        for mass in 0..stage.masses {
            painter.vline(stage.rest(mass), paper.y_range(), grid);
        }
        // Multiplies instead of subtracting one by one: far from zero, subtracting a second changes nothing.
        let seconds = (0..=(paper.height() / SPEED).max(0.0) as usize).map(|age| now.floor() - age as f64);
        for second in seconds.take_while(|second| *second >= self.record.time(0)) {
            let y = paper.top() + SPEED * (now - second) as f32;
            painter.hline((stage.wall)..=(paper.right() - 8.0), y, grid);
            let at = pos2(stage.wall, y) + vec2(2.0, -1.0);
            let label = if second.abs() < 1e9 { format!("{second} s") } else { format!("{second:e} s") };
            painter.text(at, Align2::LEFT_BOTTOM, label, stage.font(), palette.weak);
        }
    }

    /// Draws the path of a mass with the displacement `x(k)` \[m\] at sample k.
    pub(super) fn line(&self, mass: usize, width: f32, color: Color32, x: impl Fn(usize) -> Option<f64>) {
        let at = |k| Some(self.at(mass, x(k).filter(|x| x.is_finite())?, k));
        let points: Vec<Pos2> = self.samples().filter_map(at).collect();
        let mut strokes = Strokes::new(self.painter.ctx());
        strokes.line(&points, Stroke::new(width * self.stage.unit.min(1.5), color));
        self.painter.add(strokes.into_shape());
    }

    /// Draws a band around a path; its middle and half width at sample k are `x(k)` \[m\].
    pub(super) fn band(&self, mass: usize, color: Color32, x: impl Fn(usize) -> Option<(f64, f64)>) {
        let at = |k| {
            let (middle, half) = x(k)?;
            Some([self.at(mass, middle - half, k), self.at(mass, middle + half, k)])
        };
        let edges: Vec<[Pos2; 2]> = self.samples().filter_map(at).collect();
        let mut strokes = Strokes::new(self.painter.ctx());
        strokes.area(&edges, color);
        self.painter.add(strokes.into_shape());
    }

    pub(super) fn dots(&self, mass: usize, readings: &[f64], color: Color32) {
        let dot = |k: usize| {
            let x = readings.get(k).filter(|x| x.is_finite())?;
            Some(Shape::circle_filled(self.at(mass, *x, k), 1.5, color))
        };
        self.painter.extend(self.samples().filter_map(dot));
    }
}
