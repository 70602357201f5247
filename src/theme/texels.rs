//! Glyphs without interpolation.

use egui::{Context, FullOutput, Plugin, TextureId, TextureOptions};

/// Draws glyphs and dots texel by texel. Glyphs have the size of the screen in their texture and are aligned to pixels,
/// so that this changes nothing. Without a graphics card, interpolation would cost as much as everything else together.
pub(super) struct Texels;

impl Plugin for Texels {
    fn debug_name(&self) -> &'static str {
        "texels"
    }

    fn output_hook(&mut self, _ctx: &Context, output: &mut FullOutput) {
        for delta in output.textures_delta.set.get_mut(&TextureId::default()).into_iter().flatten() {
            delta.options = TextureOptions::NEAREST;
        }
    }
}
