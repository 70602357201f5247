//! The adapter of the tests.
#![expect(clippy::panic, reason = "without an adapter there is no test, and that is a failure")]

use std::sync::LazyLock;

use kalmanscope_gpu::{Gpu, Software};

static GPU: LazyLock<Gpu> = LazyLock::new(|| match pollster::block_on(Gpu::find(Software::Allowed)) {
    Ok(gpu) => gpu,
    Err(error) => panic!("these tests need a Vulkan driver, such as Mesa's lavapipe: {error}"),
});

/// An adapter: a program where there is no graphics processor.
pub(crate) fn gpu() -> &'static Gpu {
    &GPU
}

/// Limits the relative difference of scores where both filters have converged.
pub(crate) const CLOSE: f64 = 0.02;
