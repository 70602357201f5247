use kalmanscope_core::{Axis, Scenario};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::{Ensemble, EnsembleError, Plan};

fn ensemble(axes: &[&str]) -> Result<Ensemble, EnsembleError> {
    let axes = axes.iter().map(|text| Axis::parse(text).unwrap()).collect();
    Ensemble::new(
        Scenario::default(),
        Plan { filters: vec![0, 1], measures: vec![Measure::NIS], axes, ..Plan::default() },
    )
}

#[test]
fn cells_run_through_the_axes_the_last_one_fastest() {
    let ensemble = ensemble(&["seed=1:2:2", "filters.EKF.fading=1:1.2:3"]).unwrap();
    assert_eq!((ensemble.cells(), ensemble.width()), (6, 2));
    assert_eq!(ensemble.columns(), ["EKF.nis", "UKF.nis"]);
    assert_eq!(ensemble.values(4), [2.0, 1.1]);
    assert_eq!((ensemble.at(4).seed, ensemble.at(4).filters[0].fading), (2, 1.1));
    assert!((0..6).all(|cell| ensemble.cell(&ensemble.places(cell)) == cell));
}

#[test]
fn a_cell_tells_the_whole_number_that_it_has() {
    let ensemble = ensemble(&["seed=-1:3:4", "filters.EKF.input_delay=0:1:2"]).unwrap();
    for cell in 0..8 {
        let scenario = ensemble.at(cell);
        let told = [scenario.seed as f64, f64::from(scenario.filters[0].input_delay)];
        assert_eq!(ensemble.values(cell), told);
    }
    assert_eq!(ensemble.values(2), [0.0, 0.0]);
}

#[test]
fn without_axes_there_is_one_cell() {
    let ensemble = ensemble(&[]).unwrap();
    assert_eq!((ensemble.cells(), ensemble.at(0)), (1, Scenario::default()));
}

#[test]
fn an_ensemble_is_read_as_it_was_written() {
    let ensemble = ensemble(&["filters.*.process_std=0.01:100:8:log"]).unwrap();
    assert_eq!(Ensemble::from_json(&ensemble.to_json()).unwrap(), ensemble);
}

#[test]
fn impossible_ensembles_are_refused() {
    let errors = |axes: &[&str]| ensemble(axes).unwrap_err().to_string();
    assert_eq!(errors(&["seed=1:2:2", "seed=1:3:3"]), "two axes vary `seed`");
    assert!(errors(&["plant.mass=1:2:2"]).contains("plant.mass"));
    assert!(errors(&["seed=1:2:100000", "filters.EKF.fading=1:2:100000"]).contains("at most"));
    for word in ["remark", "probability"] {
        let plan = Plan { filters: vec![0], measures: vec![word.parse().unwrap()], ..Plan::default() };
        let error = Ensemble::new(Scenario::default(), plan).unwrap_err().to_string();
        assert_eq!(error, format!("a cell has one run of one filter, and `{word}` is not a number of that"));
    }
    let plan = Plan { filters: vec![2], ..Plan::default() };
    assert!(Ensemble::new(Scenario::default(), plan).unwrap_err().to_string().contains("no filter number 3"));
}
