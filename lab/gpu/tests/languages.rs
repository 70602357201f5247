//! Metal and Direct3D, on which no test runs, get programs in their languages.
#![expect(clippy::panic, reason = "a helper that fails is a test that fails")]

use std::path::Path;

use kalmanscope_core::channel::augment;
use kalmanscope_core::{Channel, FilterKind, Hold, InputKind, PlantKind, Propagation, Quantity, Scenario, simulate};
use kalmanscope_gpu::{LaneRun, program};
use naga::back::{hlsl, msl};
use naga::valid::{Capabilities, ValidationFlags, Validator};

use crate::common::built_in;

fn translate(name: &str, text: &str) {
    let module =
        naga::front::wgsl::parse_str(text).unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(text)));
    let info = Validator::new(ValidationFlags::all(), Capabilities::empty())
        .validate(&module)
        .unwrap_or_else(|error| panic!("{name}: {}", error.emit_to_string(text)));
    let options = msl::Options { lang_version: (2, 0), ..msl::Options::default() };
    let (metal, _) = msl::write_string(&module, &info, &options, &msl::PipelineOptions::default()).unwrap();
    let mut direct = String::new();
    let (options, pipeline) = (hlsl::Options::default(), hlsl::PipelineOptions::default());
    hlsl::Writer::new(&mut direct, &options, &pipeline).write(&module, &info, None).unwrap();
    assert!(metal.contains("kernel void") && direct.contains("[numthreads(64, 1, 1)]"), "{name}");
}

fn translate_all(name: &str, scenario: &Scenario) -> usize {
    let ways = [
        (FilterKind::KF, Propagation::LocalLinearisation),
        (FilterKind::EKF, Propagation::LocalLinearisation),
        (FilterKind::EKF, Propagation::Euler),
        (FilterKind::EKF, Propagation::RungeKutta),
        (FilterKind::UKF, Propagation::LocalLinearisation),
        (FilterKind::CKF, Propagation::LocalLinearisation),
    ];
    // A KF has the program of an EKF.
    let (mut known, mut done) = (Vec::new(), 0);
    for (kind, propagation) in ways {
        let mut scenario = Scenario { duration: scenario.dt * 3.0, ..scenario.clone() };
        scenario.filters.truncate(1);
        (scenario.filters[0].kind, scenario.filters[0].propagation) = (kind, Some(propagation));
        let record = simulate(&scenario);
        if scenario.validate().is_err() {
            // A KF of a plant that is not linear.
            continue;
        }
        let name = format!("{name}, {kind:?}, {propagation:?}");
        let text = program(&LaneRun { scenario: &scenario, place: 0, record: &record });
        let text = text.unwrap_or_else(|| panic!("{name} has no program"));
        if !known.contains(&text) {
            translate(&name, &text);
            known.push(text);
        }
        done += 1;
    }
    done
}

#[test]
fn programs_of_plants_and_equations_can_be_put_into_the_languages_of_all_systems() {
    let mut done = 0;
    for plant in PlantKind::ALL.into_iter().filter(|plant| plant.channels().len() <= 9) {
        let quantities: Vec<Quantity> = plant.quantities().take(4).collect();
        let room = 9 - plant.channels().len();
        for (hold, input) in [(Hold::Zero, InputKind::Force), (Hold::First, InputKind::GroundAcceleration)] {
            let augment: Vec<Channel> = match hold {
                Hold::Zero => Vec::new(),
                Hold::First => augment::OF_INPUT.into_iter().take(room).collect(),
            };
            let scenario = Scenario { input, ..built_in(plant.clone(), &quantities, &augment, hold) };
            done += translate_all(&format!("{plant:?}, {hold:?}"), &scenario);
        }
    }
    assert!(done >= 50, "{done}");
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../assets/equations");
    let (mut files, mut done) = (0, 0);
    for file in std::fs::read_dir(folder).unwrap() {
        let path = file.unwrap().path();
        let scenario = Scenario::from_toml(&std::fs::read_to_string(&path).unwrap()).unwrap();
        done += translate_all(&path.display().to_string(), &scenario);
        files += 1;
    }
    assert!(files == 12 && done >= 5 * files, "{done} programs of {files} equations");
}
