//! The programs in WGSL, put together from their parts.

use kalmanscope_core::kernel::abreast::Method;

const BEGINNING: [&str; 4] = [
    include_str!("shader/layout.wgsl"),
    include_str!("shader/numbers.wgsl"),
    include_str!("shader/belief.wgsl"),
    include_str!("shader/oscillator.wgsl"),
];

const END: [&str; 3] =
    [include_str!("shader/update.wgsl"), include_str!("shader/scores.wgsl"), include_str!("shader/main.wgsl")];

/// The number of threads in a group, as `main.wgsl` has it.
pub(crate) const GROUP: u32 = 64;

/// The program of a method.
pub(crate) fn source(method: Method) -> String {
    let own = match method {
        Method::Linearised => include_str!("shader/linearised.wgsl"),
        Method::SigmaPoints => include_str!("shader/sigma_points.wgsl"),
    };
    let parts = BEGINNING.into_iter().chain([own]).chain(END);
    parts.collect::<Vec<_>>().join("\n")
}
