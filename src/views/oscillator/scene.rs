//! Everything in the picture at one moment.

use egui::text::LayoutJob;
use egui::{FontId, Painter, Rect, Stroke, pos2, vec2};
use kalmanscope_core::plant::Spring;
use kalmanscope_core::{Channel, Estimates, ForcedMass, Record};

use super::parts::{Ink, Link, MassBelief, arrow, body, ghosts, ground, link, slice};
use super::stage::{SceneFrame, displacement, recent};
use crate::equation::job;
use crate::view::ViewContext;

/// The distance of captions from the left \[points\].
const CORNER: f32 = 10.0;

/// The least size of a typeset equation; its subscripts are smaller \[points\].
const LEAST_EQUATION: f32 = 12.5;

pub(super) struct Scene<'a> {
    pub(super) stage: &'a SceneFrame,
    pub(super) painter: &'a Painter,
    pub(super) context: &'a ViewContext<'a>,
    pub(super) k: usize,
}

impl<'a> Scene<'a> {
    pub(super) fn masses(&self, largest_force: f64) {
        let Self { stage, painter, context, k } = *self;
        let ViewContext { palette, visible, .. } = *context;
        ground(stage, painter, context.unit("m"), palette);
        let record = self.record();
        let kind = &context.session.run().scenario().plant.kind;
        let spring = kind.info().spring;
        // Filters may have more masses than the truth.
        let is_known = |mass: usize| mass < kind.masses();
        let mut before = (stage.wall, 0.0);
        for mass in 0..stage.masses {
            let beliefs: Vec<MassBelief> = self.filters(mass).filter_map(|filter| filter.belief(k)).collect();
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
            let on_all = (!is_known(mass) || kind.is_driven(mass)).then(|| record.input());
            let on_one = ForcedMass::new(mass).and_then(|mass| record.force_on(mass));
            if on_all.is_some() || on_one.is_some() {
                let force: f64 = on_all.into_iter().chain(on_one).map(|values| recent(values, record, k)).sum();
                let share = force / largest_force.max(force.abs()).max(1e-12);
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

    pub(super) fn beliefs(&self) -> Vec<(MassBelief, &'a Estimates)> {
        self.filters(0).filter_map(|filter| Some((filter.belief(self.k)?, filter.estimates))).collect()
    }

    pub(super) fn reach(&self, last: usize) -> f64 {
        let mean = || self.filters(0).next().map(|filter| filter.estimates.canonical_means(filter.at));
        let values = self.record().truth(displacement(0)).or_else(mean).unwrap_or_default();
        values.iter().take(last + 1).fold(0.0, |reach, value| reach.max(value.abs()))
    }

    pub(super) fn truth_now(&self) -> Option<f64> {
        self.truth(0)?.get(self.k).copied().filter(|x| x.is_finite())
    }

    fn record(&self) -> &'a Record {
        self.context.session.run().record()
    }

    fn truth(&self, mass: usize) -> Option<&'a [f64]> {
        self.record().truth(displacement(mass)).filter(|_| self.context.visible.truth)
    }

    fn filters(&self, mass: usize) -> impl Iterator<Item = SceneFilter<'a>> {
        self.context.filters().filter_map(move |(_, estimates)| {
            let color = self.context.color(estimates);
            Some(SceneFilter { estimates, at: estimates.place(displacement(mass))?, color })
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

    /// Writes the equation and the measured quantities above the spring, where there is room. Returns the place of the equation.
    pub(super) fn captions(&self) -> Option<Rect> {
        let ViewContext { session, palette, visible, .. } = *self.context;
        let room = self.room();
        let equation = self.write(self.equation(), room);
        let sensors = session.run().record().sensors();
        let mut measured = sensors.iter().map(|q| q.symbol()).collect::<Vec<_>>().join(", ");
        // Of the measured quantities, only a displacement has a channel as its rate of change.
        if !sensors.iter().any(|q| q.channel().and_then(Channel::rate).is_some()) {
            measured += ", not x";
        }
        if visible.measured && !sensors.is_empty() {
            let text = format!("measured: {measured}");
            let below = equation.map_or(room, |equation| room.with_min_y(equation.bottom().max(room.top())));
            self.write(LayoutJob::simple_singleline(text, self.stage.font(), palette.weak), below);
        }
        equation
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

struct SceneFilter<'a> {
    estimates: &'a Estimates,
    at: usize,
    color: egui::Color32,
}

impl SceneFilter<'_> {
    fn belief(&self, k: usize) -> Option<MassBelief> {
        let Self { estimates, at, color } = *self;
        let mean = (k < estimates.len()).then(|| estimates.mean(k)[at]).filter(|mean| mean.is_finite())?;
        Some(MassBelief { mean, std: estimates.std(k, at), color })
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
