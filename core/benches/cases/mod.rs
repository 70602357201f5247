//! The cases to time and count: filters alone, on prepared records, without writing a history.

use std::hint::black_box;

use kalmanscope_core::filter::{Adaptation, Rule};
use kalmanscope_core::internals::kernel::BoucWen;
use kalmanscope_core::internals::kernel::Duffing;
use kalmanscope_core::internals::kernel::Sdof;
use kalmanscope_core::internals::kernel::ShearChain;
use kalmanscope_core::internals::kernel::{Belief, Correction, Filter, Linearised, Noise, SigmaPoints};
use kalmanscope_core::internals::kernel::{Gaussian, Matrix, Vector};
use kalmanscope_core::internals::kernel::{Model, Output};
use kalmanscope_core::{FilterSettings, InputKind, PlantKind, Record, Run, Scenario, Values};

/// A filter and its input.
pub(crate) struct Case {
    /// Plant, number of components, kind of filter.
    pub(crate) name: String,
    stepper: Box<dyn FnMut(usize)>,
}

impl Case {
    /// Makes `steps` predictions and updates, over the record in a loop.
    pub(crate) fn run(&mut self, steps: usize) {
        (self.stepper)(steps);
    }
}

/// Every case, with two sensors each.
pub(crate) fn cases() -> Vec<Case> {
    let mut cases = Vec::new();
    plant(&mut cases, PlantKind::SDOF, Sdof { eta: 0.0 });
    plant(&mut cases, PlantKind::DUFFING, Duffing { eta: 0.0 });
    plant(&mut cases, PlantKind::BOUC_WEN, BoucWen { eta: 0.0 });
    plant(&mut cases, PlantKind::SHEAR_2, ShearChain::<2> { eta: 0.0 });
    plant(&mut cases, PlantKind::SHEAR_3, ShearChain::<3> { eta: 0.0 });
    plant(&mut cases, PlantKind::SHEAR_4, ShearChain::<4> { eta: 0.0 });
    plant(&mut cases, PlantKind::SDOF, Sdof { eta: 0.02 });
    plant(&mut cases, PlantKind::SHEAR_3, ShearChain::<3> { eta: 0.02 });
    cases
}

fn plant<P: Model<N>, const N: usize>(cases: &mut Vec<Case>, kind: PlantKind, plant: P) {
    let eta = plant.eta();
    let mut scenario = Scenario { duration: 20.0, filters: vec![], ..Scenario::default() };
    scenario.set_plant(kind);
    let mut run = Run::new(&scenario).expect("the scenario is valid");
    run.finish();
    let record = run.record().clone();
    let values = |per: &Values| Vector::<N>::from(P::CHANNELS.map(|c| per[c]));
    let initial = Gaussian::independent(values(&Values::INITIAL_MEAN), &values(&Values::INITIAL_STD));
    let decay = if eta == 0.0 { String::new() } else { format!(", eta = {eta}") };
    let mut add = |name: &str, stepper| {
        cases.push(Case { name: format!("{}, n = {N}{decay}, {name}", kind.name()), stepper });
    };
    add("EKF", stepper(plant.clone(), kind, Linearised::new(initial.clone(), 1), &record));
    if !P::MOVES_POINTS {
        return;
    }
    add("UKF", stepper(plant.clone(), kind, SigmaPoints::new(initial.clone(), Rule::Unscented), &record));
    add("CKF", stepper(plant, kind, SigmaPoints::new(initial, Rule::Cubature), &record));
}

fn stepper<P: Model<N>, B: Belief<P, N> + Clone + 'static, const N: usize>(
    model: P,
    kind: PlantKind,
    belief: B,
    record: &Record,
) -> Box<dyn FnMut(usize)> {
    let settings = FilterSettings { fading: 1.005, ..FilterSettings::default() };
    let process = Vector::<N>::from(P::CHANNELS.map(|c| settings.process_std[c] * settings.process_std[c]));
    let noise = Noise {
        process: Matrix::from_diagonal(&process),
        sensors: vec![0.01 * 0.01, 0.06 * 0.06],
        fading: settings.fading,
    };
    let book = settings.model(kind, InputKind::default());
    let outputs = record.sensors().iter().map(|&q| book.reading(q).as_ref().and_then(Output::of)).collect();
    let start = Filter::new(model, belief, record.dt(), noise, outputs, Adaptation::default());
    let force: Vec<f64> = (0..record.len()).map(|k| record.force(k)).collect();
    let measured: Vec<[f64; 2]> = (0..record.len()).map(|k| [record.measured(0)[k], record.measured(1)[k]]).collect();
    let mut filter = start.clone();
    let mut k = 0;
    let mut correction = Correction::NOTHING;
    Box::new(move |steps| {
        for _ in 0..steps {
            k += 1;
            if k == force.len() {
                k = 1;
                filter = start.clone();
            }
            filter.predict(force[k - 1]).expect("the filter goes on");
            filter.update(force[k], &measured[k], &mut correction).expect("the filter goes on");
            black_box(&correction);
        }
    })
}
