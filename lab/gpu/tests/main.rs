//! The tests on a graphics processor, or on one in software: one program, which is linked once. `cargo test -p kalmanscope-gpu --test all
//! languages::` needs neither, nor do the tests here: of what is served, and of inner parts.
#![expect(clippy::unwrap_used, reason = "a helper that fails is a test that fails")]

mod common;
mod languages;

/// Tests that take minutes where the graphics processor is one in software.
mod on_adapter {
    mod maps;
    mod random;
}

use kalmanscope_core::{Scenario, simulate};
use kalmanscope_gpu::internals::{is_software, unrolled};
use kalmanscope_gpu::{LaneRun, serves};
use wgpu::{AdapterInfo, Backend, DeviceType};

#[test]
fn programs_are_known_by_type_and_by_name() {
    let mut info = AdapterInfo::new(DeviceType::DiscreteGpu, Backend::Vulkan);
    info.name = "NVIDIA GeForce RTX 4070".to_owned();
    assert!(!is_software(&info));
    info.device_type = DeviceType::Cpu;
    assert!(is_software(&info));
    for name in ["llvmpipe (LLVM 15.0.6, 256 bits)", "Google SwiftShader", "Microsoft Basic Render Driver"] {
        let mut info = AdapterInfo::new(DeviceType::Other, Backend::Vulkan);
        info.name = name.to_owned();
        assert!(is_software(&info), "{name}");
    }
}

#[test]
fn loops_with_constant_bounds_are_written_out() {
    let text = "for (var i = 0u; i < N; i++) {\n  for (var k = i + 1u; k <= N; k++) {\n    a[i * N + k] += b.i * c[at(k, i)];\n  }\n}\n";
    let expected = "{\n{\n    a[1u] += b.i * c[1u];\n}\n{\n    a[2u] += b.i * c[3u];\n}\n}\n{\n{\n    a[4u] += b.i * c[4u];\n}\n}\n";
    assert_eq!(unrolled(text, &[("N", 2)]), expected);
}

#[test]
fn other_loops_stay() {
    for text in ["for (var i = 0u; i < N; i += 1u) {\n  a += i;\n}\n", "for (; k < settings.end; k++) {\n}\n"] {
        assert_eq!(unrolled(text, &[("N", 2)]), text);
    }
}

#[test]
fn the_table_says_what_is_served() {
    let rows = include_str!("../README.md").lines().filter_map(|line| {
        let (_, rest) = line.strip_prefix("| ")?.split_once(" | `")?;
        rest.strip_suffix(" |")?.split_once("` | ")
    });
    let mut counts = [0; 2];
    for (text, expected) in rows {
        let scenario =
            Scenario::from_toml(&format!("duration = 1.0\n{text}")).unwrap_or_else(|e| panic!("{text}: {e}"));
        let record = simulate(&scenario);
        let is_served = serves(&LaneRun { scenario: &scenario, place: 0, record: &record });
        assert_eq!(if is_served { "yes" } else { "no" }, expected, "{text}");
        counts[usize::from(is_served)] += 1;
    }
    assert!(counts.iter().all(|count| *count >= 9), "{counts:?}");
}
