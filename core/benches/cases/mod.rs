//! The cases that are timed and counted: filters alone, without a record to write, on records made beforehand.

use std::hint::black_box;

use kalmanscope_core::filter::{
    Adaptation, Belief, Correction, Filter, Linearised, Noise, Propagation, Rule, SigmaPoints, SquareRoot,
};
use kalmanscope_core::gaussian::{Gaussian, Matrix, Vector};
use kalmanscope_core::model::Model;
use kalmanscope_core::models::bouc_wen::BoucWen;
use kalmanscope_core::models::duffing::Duffing;
use kalmanscope_core::models::log_parameters::LogParameters;
use kalmanscope_core::models::sdof::Sdof;
use kalmanscope_core::models::shear_chain::ShearChain;
use kalmanscope_core::{FilterSettings, PlantKind, Record, Run, Scenario, Values};

/// A filter and what it is fed.
pub(crate) struct Case {
    /// Plant, number of components, kind of filter.
    pub(crate) name: String,
    stepper: Box<dyn FnMut(usize)>,
}

impl Case {
    /// Makes `steps` predictions and updates, over the record again and again.
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
    cases
}

fn plant<P: Model<N>, const N: usize>(cases: &mut Vec<Case>, kind: PlantKind, plant: P) {
    // As a run has it, which may want logarithms.
    let model = LogParameters { plant, on: false };
    let mut scenario = Scenario { duration: 20.0, filters: vec![], ..Scenario::default() };
    scenario.set_plant(kind);
    let mut run = Run::new(&scenario).expect("the scenario is valid");
    run.finish();
    let record = run.record().clone();
    let values = |per: &Values| Vector::<N>::from(P::CHANNELS.map(|c| per[c]));
    let initial = Gaussian::independent(values(&Values::INITIAL_MEAN), &values(&Values::INITIAL_STD));
    let mut add = |name: &str, stepper| cases.push(Case { name: format!("{}, n = {N}, {name}", kind.name()), stepper });
    let local = Propagation::LocalLinearisation;
    add("EKF", stepper(model.clone(), Linearised::new(initial.clone(), local, 1), &record));
    add("UKF", stepper(model.clone(), SigmaPoints::new(initial.clone(), Rule::Unscented), &record));
    add("CKF", stepper(model.clone(), SigmaPoints::new(initial.clone(), Rule::Cubature), &record));
    let root = SquareRoot::new(&initial).expect("the covariance is diagonal");
    add("SR-UKF", stepper(model, root, &record));
}

fn stepper<P: Model<N>, B: Belief<P, N> + Clone + 'static, const N: usize>(
    model: P,
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
    let outputs = record.sensors().iter().map(|&q| model.output(q)).collect();
    let start = Filter::new(model, belief, record.dt(), noise, outputs, Adaptation::default());
    let force = record.force().to_vec();
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
