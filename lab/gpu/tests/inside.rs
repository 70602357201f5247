//! Inner parts of the search for a graphics processor and of the writer of programs.

use kalmanscope_gpu::internals::{is_software, unrolled};
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
