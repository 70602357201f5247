//! The filters with counted steps.

use std::hint::black_box;

use kalmanscope_core::{
    Channel, FilterKind, Hold, Pass, PlantKind, Propagation, Record, Sample, Scenario, Sink, Stop, simulate,
};
use kalmanscope_lanes::{InstructionSet, LANES, LaneRun, outcomes};

pub(crate) struct Case {
    pub(crate) name: String,
    scenario: Scenario,
    /// The instruction set of the lanes. `None` for a single filter.
    pub(crate) level: Option<InstructionSet>,
}

pub(crate) fn chosen(words: &[String]) -> Vec<Case> {
    let mut cases = all();
    cases.retain(|case| words.iter().all(|word| case.name.split([' ', ',']).any(|other| other == word)));
    cases
}

fn all() -> Vec<Case> {
    const EKF: FilterKind = FilterKind::EKF;
    const UKF: FilterKind = FilterKind::UKF;
    let sdof = || built_in(PlantKind::SDOF);
    let duffing = || built_in(PlantKind::DUFFING);
    let mut cases = Vec::new();
    let mut add = |name: &str, kinds: &[FilterKind], scenario: Scenario, levels: &[Option<InstructionSet>]| {
        for &kind in kinds {
            for &level in levels {
                let place = level.map_or(String::new(), |level| format!(", lanes {level:?}"));
                let mut scenario = scenario.clone();
                scenario.filters[0].kind = kind;
                cases.push(Case { name: format!("{name} {}{place}", kind.name()), scenario, level });
            }
        }
    };
    let alone = [None];
    let lanes = [Some(InstructionSet::Baseline), Some(InstructionSet::Avx2)];
    let both = [EKF, UKF];
    add("SDOF", &[EKF, UKF, FilterKind::CKF, FilterKind::SR_UKF], sdof(), &alone);
    add("SDOF", &both, sdof(), &lanes);
    for levels in [&alone[..], &lanes] {
        add("SDOF gain first-order", &both, with_gain(sdof()), levels);
        add("Duffing", &both, duffing(), levels);
        add("Bouc-Wen", &both, built_in(PlantKind::BOUC_WEN), levels);
    }
    add("Duffing gain first-order", &both, with_gain(duffing()), &lanes);
    add("typed Duffing", &both, typed_duffing(), &lanes);
    add("typed Duffing gain first-order", &both, with_gain(typed_duffing()), &lanes);
    for kind in [PlantKind::SHEAR_2, PlantKind::SHEAR_3, PlantKind::SHEAR_4, PlantKind::SHEAR_5, PlantKind::SHEAR_10] {
        add(kind.key(), &[EKF], built_in(kind.clone()), &alone);
    }
    for kind in [PlantKind::SHEAR_2, PlantKind::SHEAR_3, PlantKind::SHEAR_4] {
        add(kind.key(), &[EKF], built_in(kind.clone()), &lanes[1..]);
    }
    cases
}

fn built_in(kind: PlantKind) -> Scenario {
    let mut scenario = Scenario::default();
    scenario.filters.truncate(1);
    scenario.set_plant(kind);
    // One step of the book a sample, whatever the plant asks for.
    (scenario.filters[0].propagation, scenario.filters[0].substeps) = (Some(Propagation::LocalLinearisation), 1);
    scenario
}

fn with_gain(mut scenario: Scenario) -> Scenario {
    scenario.hold = Hold::First;
    scenario.filters[0].augment = vec![Channel::INPUT_GAIN];
    let kind = scenario.plant.kind.clone();
    scenario.set_plant(kind);
    scenario
}

fn typed_duffing() -> Scenario {
    let text = "[plant]\nequation = \"x'' + 2 ζ ωₙ x' + ωₙ² x + μ x³ = f\"\n";
    let typed = Scenario::from_toml(text).expect("the equation is valid").plant.kind;
    let mut scenario = built_in(PlantKind::DUFFING);
    let [cubic, mu] = [PlantKind::DUFFING, typed.clone()].map(|kind| kind.channels()[4]);
    let truth = scenario.plant.parameter(cubic).expect("the plant has a signal");
    let filter = &mut scenario.filters[0];
    for values in [&mut filter.initial_mean, &mut filter.initial_std, &mut filter.process_std] {
        values[mu] = values[cubic];
    }
    scenario.set_plant(typed);
    scenario.plant = scenario.plant.with(mu, truth);
    scenario
}

impl Case {
    pub(crate) fn record(&self, steps: usize) -> Record {
        let duration = steps as f64 * self.scenario.dt;
        let record = simulate(&Scenario { duration, ..self.scenario.clone() });
        assert_eq!(record.len(), steps + 1);
        record
    }

    pub(crate) fn run(&self, record: &Record) {
        let scenario = &self.scenario;
        let Some(level) = self.level else {
            let mut sum = Sum(0.0);
            let mut pass = Pass::new(scenario, 0, record).expect("the filter is possible");
            pass.follow(record, record.len(), &mut sum);
            assert!(pass.stop.is_none() && sum.0 > 0.0, "{:?}", pass.stop);
            return;
        };
        let guess = |i: usize| {
            let mut scenario = scenario.clone();
            scenario.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] *= 0.9 + 0.02 * i as f64;
            scenario
        };
        let scenarios: Vec<Scenario> = (0..LANES).map(guess).collect();
        let runs: Vec<LaneRun<'_>> = scenarios.iter().map(|scenario| LaneRun { scenario, place: 0, record }).collect();
        let outcomes = outcomes(level, &runs, &[]).expect("the filters are possible");
        assert!(outcomes.iter().all(|outcome| outcome.stop.is_none()));
        black_box(outcomes);
    }
}

struct Sum(f64);

impl Sink for Sum {
    fn push(&mut self, sample: &Sample<'_>) {
        self.0 += if sample.nis.is_finite() { sample.nis } else { 0.0 };
    }

    fn stop_at(&mut self, _: Stop) {}
}
