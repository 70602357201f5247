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

#[cfg(test)]
mod tests {
    use naga::back::{hlsl, msl};
    use naga::valid::{Capabilities, ValidationFlags, Validator};

    use super::*;

    /// Metal and Direct3D, on which no test runs, get programs in their languages.
    #[test]
    fn programs_can_be_put_into_the_languages_of_all_systems() {
        for method in [Method::Linearised, Method::SigmaPoints] {
            let module = naga::front::wgsl::parse_str(&source(method)).unwrap();
            let info = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module).unwrap();
            let options = msl::Options { lang_version: (2, 0), ..msl::Options::default() };
            let (metal, _) = msl::write_string(&module, &info, &options, &msl::PipelineOptions::default()).unwrap();
            let mut direct = String::new();
            let (options, pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions::default());
            hlsl::Writer::new(&mut direct, &options, &pipeline).write(&module, &info, None).unwrap();
            assert!(metal.contains("kernel void") && direct.contains("[numthreads(64, 1, 1)]"));
        }
    }
}
