use kalmanscope_core::{Axis, Scenario};
use kalmanscope_diagnosis::Measure;
use kalmanscope_lab::{Ensemble, EnsembleRows, Plan};

fn of_counts(counts: &[usize]) -> Ensemble {
    let axis = |(key, count): (&str, &usize)| Axis::parse(&format!("filters.EKF.{key}=1:1.2:{count}")).unwrap();
    let axes = ["fading", "eta", "walk"].into_iter().zip(counts).map(axis).collect();
    let plan = Plan { filters: vec![0], measures: vec![Measure::NIS, Measure::NEES], axes, ..Plan::default() };
    Ensemble::new(Scenario::default(), plan).unwrap()
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
fn every_cell_comes_once() {
    for counts in [&[1][..], &[7], &[128, 128], &[5, 3], &[1, 9], &[4, 3, 2], &[256, 1], &[]] {
        let mut order = of_counts(counts).coarse_to_fine();
        order.sort_unstable();
        assert!(order.iter().copied().eq(0..counts.iter().product()), "{counts:?}");
    }
}

#[test]
fn a_line_of_cells_is_halved_again_and_again() {
    assert_eq!(of_counts(&[9]).coarse_to_fine(), [0, 2, 4, 6, 8, 1, 3, 5, 7]);
}
