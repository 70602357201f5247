//! Letters without interpolation.

use egui::{Context, FullOutput, Plugin, TextureId, TextureOptions};

/// Has letters and dots drawn texel by texel. Letters are as large in their texture as on screen and stand on whole pixels, so
/// that nothing is lost; and where no graphics card draws, interpolation takes as long as all else that is done for a pixel.
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
