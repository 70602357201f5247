//! Probes for tests that drive the app from outside: the positions of controls.

use std::collections::BTreeMap;

use egui::{Context, Id, Rect, Response};

type Places = BTreeMap<String, (u64, Rect)>;

fn id() -> Id {
    Id::unique("places of the controls")
}

pub(crate) fn remember(ctx: &Context, name: &str, rect: Rect) {
    let frame = ctx.cumulative_frame_nr();
    ctx.data_mut(|data| {
        let places: &mut Places = data.get_temp_mut_or_default(id());
        // A name is copied once and not in each frame.
        match places.get_mut(name) {
            Some(place) => *place = (frame, rect),
            None => _ = places.insert(name.to_owned(), (frame, rect)),
        }
    });
}

pub(crate) trait Remembered {
    fn remembered(self, name: &str) -> Self;
}

impl Remembered for Response {
    fn remembered(self, name: &str) -> Self {
        remember(&self.ctx, name, self.rect);
        self
    }
}

pub fn place(ctx: &Context, name: &str) -> Option<Rect> {
    all(ctx).into_iter().find_map(|(other, rect)| (other == name).then_some(rect))
}

pub(crate) fn all(ctx: &Context) -> Vec<(String, Rect)> {
    // Between frames, the number is that of the next frame.
    let last = ctx.cumulative_frame_nr().saturating_sub(1);
    let drawn = |(name, (frame, rect)): (&String, &(u64, Rect))| (*frame >= last).then(|| (name.clone(), *rect));
    ctx.data_mut(|data| data.get_temp_mut_or_default::<Places>(id()).iter().filter_map(drawn).collect())
}
