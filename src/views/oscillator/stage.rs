//! Positions on screen.

use egui::{Rect, Vec2, pos2, vec2};

use kalmanscope_core::channel::MAX_MASSES;
use kalmanscope_core::{Channel, Record, Run};

#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Peak {
    /// Displacement of any mass \[m\].
    pub(super) reach: f64,
    /// Stretch of any link \[m\].
    pub(super) drift: f64,
    /// Mean force over mass within [`SPELL`] \[m/s²\].
    pub(super) force: f64,
}

impl Peak {
    pub(super) fn up_to(record: &Record, masses: usize, k: usize) -> Self {
        let to = (k + 1).min(record.len());
        let largest = |values: &mut dyn Iterator<Item = f64>| values.map(f64::abs).fold(0.0, f64::max);
        let mut peak = Self::default();
        let mut before: Option<&[f64]> = None;
        for mass in 0..masses {
            let Some(x) = record.truth(displacement(mass)).and_then(|x| x.get(..to)) else { break };
            peak.reach = peak.reach.max(largest(&mut x.iter().copied()));
            peak.drift = before.map_or(peak.reach, |before| {
                peak.drift.max(largest(&mut x.iter().zip(before).map(|(x, before)| x - before)))
            });
            before = Some(x);
        }
        let window = window(record);
        let inputs = std::iter::once(record.input()).chain(record.forces().map(|(_, values)| values));
        let means = inputs.flat_map(|values| values.get(..to).unwrap_or_default().chunks_exact(window));
        peak.force = largest(&mut means.map(|f| f.iter().sum::<f64>() / window as f64));
        peak
    }
}

pub(super) fn displacement(mass: usize) -> Channel {
    Channel::displacement(mass.min(MAX_MASSES - 1))
}

pub(super) fn masses(run: &Run) -> usize {
    let known = |mass: usize| run.record().truth(displacement(mass)).is_some();
    let there = |mass: &usize| if known(0) { known(*mass) } else { run.channels().contains(&displacement(*mass)) };
    (0..MAX_MASSES).take_while(there).count().max(1)
}

/// Duration over which the arrow averages the force, because an arrow that followed white noise would flicker \[s\].
const SPELL: f64 = 0.1;

fn window(record: &Record) -> usize {
    (SPELL / record.dt()).round().clamp(1.0, 1e5) as usize
}

/// The mean of an input within the [`SPELL`] that ends with sample `k` \[m/s²\].
pub(super) fn recent(values: &[f64], record: &Record, k: usize) -> f64 {
    let first = (k + 1).saturating_sub(window(record));
    let force = values.get(first..=k).unwrap_or_default();
    force.iter().sum::<f64>() / window(record) as f64
}

/// Travel of the last mass of a chain per mass before it, as a multiple of the stretch of a link.
const REACH_PER_LINK: f32 = 0.55;

/// The picture's measures \[points\], for masses in a row on a ground, the first on the right of a wall.
#[derive(Clone, Debug)]
pub(super) struct SceneFrame {
    pub(super) rect: Rect,
    pub(super) unit: f32,
    pub(super) floor: f32,
    pub(super) wall: f32,
    pub(super) body: Vec2,
    pub(super) arrow: f32,
    pub(super) gap: f32,
    pub(super) travel: f32,
    /// Clearance of a damper's piston at the ends of its cylinder, and between the cylinder and the mass.
    clearance: f32,
    pub(super) masses: usize,
    scale: f64,
}

/// The stretch of a link for which all of the motion just fits on the stage, at least `least`, as a power of two \[log₂ m\].
pub(super) fn needed(masses: usize, peak: Peak, least: f64) -> f64 {
    peak.drift.max(peak.reach / f64::from(reach_ratio(masses))).max(least).clamp(1e-4, 1e9).log2()
}

/// The next power of √2, so that the scale is constant most of the time while the motion grows.
pub(super) fn rounded(zoom: f64) -> f64 {
    (zoom * 2.0).ceil() / 2.0
}

fn reach_ratio(masses: usize) -> f32 {
    1.0 + REACH_PER_LINK * (masses - 1) as f32
}

impl SceneFrame {
    pub(super) fn new(rect: Rect, masses: usize, span: f64) -> Self {
        let (width, height) = (rect.width(), rect.height());
        let unit = (height / 110.0).clamp(0.7, 2.0);
        let floor = rect.bottom() - (17.0 * unit).max(14.0);
        let side = 0.41 * height;
        let body = if masses == 1 {
            vec2((1.25 * side).min(0.17 * width), side)
        } else {
            vec2(side.min(0.3 * width / masses as f32), side)
        };
        let wall = rect.left() + 0.02 * width + 8.0 * unit;
        let clearance = if masses == 1 { 6.0 } else { 4.0 } * unit.min(width / 90.0 / masses as f32).min(1.0);
        // A cylinder is as long as the piston's travel in both directions, and the mass never touches it: 0.95 gap = 3
        // travel + 3 clearances. The links and the travel of the last mass share the width beside the masses.
        let ratio = reach_ratio(masses);
        let margin = 10.0 * unit + 0.35 * body.x;
        let room = rect.right() - margin - wall - masses as f32 * body.x;
        let gap = ((room + ratio * clearance) / (masses as f32 + ratio * 0.95 / 3.0)).max(1.0);
        let travel = ((0.95 * gap - 3.0 * clearance) / 3.0).max(1.0);
        let arrow = rect.top() + if height < 80.0 { 0.13 } else { 0.17 } * height;
        Self { rect, unit, floor, wall, body, arrow, gap, travel, clearance, masses, scale: f64::from(travel) / span }
    }

    pub(super) fn rest(&self, mass: usize) -> f32 {
        self.wall + (mass + 1) as f32 * self.gap + (mass as f32 + 0.5) * self.body.x
    }

    pub(super) fn length(&self, metres: f64) -> f32 {
        (metres * self.scale).clamp(-1e5, 1e5) as f32
    }

    pub(super) fn metres(&self, length: f32) -> f64 {
        f64::from(length) / self.scale
    }

    /// The position of a mass's centre at the displacement `x` \[m\], even beyond the stage.
    pub(super) fn place(&self, mass: usize, x: f64) -> f32 {
        self.rest(mass) + self.length(x)
    }

    /// A mass at the displacement `x` \[m\], clamped to the stage.
    pub(super) fn body(&self, mass: usize, x: f64) -> Rect {
        let middle = self.place(mass, x).clamp(self.wall, self.rect.right());
        Rect::from_center_size(pos2(middle, self.floor - 2.0 * self.wheel() - 0.5 * self.body.y), self.body)
    }

    pub(super) fn wheel(&self) -> f32 {
        0.065 * self.body.y
    }

    /// A damper's cylinder from left to right, for a link that begins at `start`.
    pub(super) fn cylinder(&self, start: f32) -> (f32, f32) {
        let start = start + 0.05 * self.gap;
        (start, start + 2.0 * (self.travel + self.clearance))
    }

    pub(super) fn longest_arrow(&self) -> f32 {
        0.85 * self.body.x
    }

    pub(super) fn font(&self) -> egui::FontId {
        egui::FontId::proportional((11.5 * self.unit).clamp(9.5, 16.0))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::{PlantKind, Scenario};

    const SIZES: [Vec2; 6] = [
        vec2(930.0, 104.0),
        vec2(370.0, 62.0),
        vec2(370.0, 111.0),
        vec2(1580.0, 120.0),
        vec2(1260.0, 378.0),
        vec2(540.0, 162.0),
    ];

    fn span(masses: usize, peak: Peak) -> f64 {
        2_f64.powf(rounded(needed(masses, peak, 0.0)))
    }

    #[test]
    fn the_motion_of_every_plant_stays_on_the_stage() {
        for kind in PlantKind::ALL {
            let mut scenario = Scenario { duration: 20.0, ..Scenario::default() };
            scenario.plant.kind = kind.clone();
            scenario.filters.clear();
            let mut run = Run::new(&scenario).unwrap();
            run.finish();
            let (record, masses) = (run.record(), masses(&run));
            let peak = Peak::up_to(record, masses, run.len() - 1);
            for size in SIZES {
                let stage = SceneFrame::new(Rect::from_min_size(egui::Pos2::ZERO, size), masses, span(masses, peak));
                for k in 0..run.len() {
                    let mut start = stage.wall;
                    for mass in 0..masses {
                        let body = stage.body(mass, record.truth(displacement(mass)).unwrap()[k]);
                        assert!(body.left() >= stage.cylinder(start).1, "{kind:?} {size} {k}: {mass} in its damper");
                        start = body.right();
                    }
                    assert!(start < size.x, "{kind:?} {size} {k}: {start}");
                }
            }
        }
    }

    #[test]
    fn a_stage_has_room_for_each_thing_above_the_other() {
        for size in SIZES {
            let stage = SceneFrame::new(Rect::from_min_size(egui::Pos2::ZERO, size), 1, 0.2);
            let body = stage.body(0, 0.0);
            assert!(stage.arrow > 6.0 && stage.arrow < body.top(), "{size}");
            assert!(body.bottom() < stage.floor && stage.floor < size.y);
            assert!(
                stage.body(0, 0.2).center().x + stage.longest_arrow() < size.x,
                "{size}: the arrow leaves the stage"
            );
        }
    }

    #[test]
    fn the_scale_does_not_creep() {
        let of = |drift| span(1, Peak { drift, reach: drift, force: 0.0 });
        assert_eq!(of(0.21), of(0.24));
        assert!(of(0.24) >= 0.24 && of(0.24) < 0.24 * 1.42);
    }
}
