use kalmanscope_core::{Axis, Scenario};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::{Ensemble, EnsembleError, EnsembleRows, Plan};

fn ensemble(axes: &[&str]) -> Result<Ensemble, EnsembleError> {
    of_measures(&[Measure::NIS], axes)
}

fn of_measures(measures: &[Measure], axes: &[&str]) -> Result<Ensemble, EnsembleError> {
    Ensemble::new(Scenario::default(), plan(&[0, 1], measures, axes))
}

pub(crate) fn plan(filters: &[usize], measures: &[Measure], axes: &[&str]) -> Plan {
    let axes = axes.iter().map(|text| Axis::parse(text).unwrap()).collect();
    Plan { filters: filters.to_vec(), measures: measures.to_vec(), axes, ..Plan::default() }
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
fn an_ensemble_is_read_as_it_was_written_and_without_axes_it_is_one_cell() {
    let one = ensemble(&[]).unwrap();
    assert_eq!((one.cells(), one.at(0)), (1, Scenario::default()));
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
        let error = of_measures(&[word.parse().unwrap()], &[]).unwrap_err().to_string();
        assert_eq!(error, format!("a cell has one run of one filter, and `{word}` is not a number of that"));
    }
    assert!(
        Ensemble::new(Scenario::default(), plan(&[2], &[], &[]))
            .unwrap_err()
            .to_string()
            .contains("no filter number 3")
    );
}

fn of_counts(counts: &[usize]) -> Ensemble {
    let axis = |(key, count): (&str, &usize)| format!("filters.EKF.{key}=1:1.2:{count}");
    let axes: Vec<String> = ["fading", "eta", "walk"].into_iter().zip(counts).map(axis).collect();
    ensemble(&axes.iter().map(String::as_str).collect::<Vec<_>>()).unwrap()
}

#[test]
fn a_coarse_picture_is_complete_long_before_the_fine_one() {
    let ensemble = of_counts(&[40, 20]);
    let mut sheet = EnsembleRows::new(&ensemble);
    let order = ensemble.coarse_to_fine();
    assert!(sheet.shown(0).is_none() && !sheet.covers_all());
    let mut covered = None;
    for (at, &cell) in order.iter().enumerate() {
        let [x, y] = ensemble.places(cell)[..] else { panic!("two axes") };
        sheet.fill(&[cell], &[x as f64, y as f64]);
        covered = covered.or(sheet.covers_all().then_some(at + 1));
    }
    assert_eq!(covered, Some(5 * 3));
    assert!(sheet.is_complete() && sheet.missing(&order).next().is_none());
    assert_eq!(sheet.row(ensemble.cell(&[39, 19])), Some(&[39.0, 19.0][..]));
    let mut coarse = EnsembleRows::new(&ensemble);
    coarse.fill(&order[..15], &vec![7.0; 30]);
    assert_eq!(coarse.missing(&order).count(), 785);
    assert!((0..800).all(|cell| coarse.shown(cell) == Some(&[7.0, 7.0][..])));
}

#[test]
fn every_cell_comes_once_and_a_line_of_cells_is_halved_again_and_again() {
    for counts in [&[1][..], &[7], &[128, 128], &[5, 3], &[1, 9], &[4, 3, 2], &[256, 1], &[]] {
        let mut order = of_counts(counts).coarse_to_fine();
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..counts.iter().product()), "{counts:?}");
    }
    assert_eq!(of_counts(&[9]).coarse_to_fine(), [0, 2, 4, 6, 8, 1, 3, 5, 7]);
}
