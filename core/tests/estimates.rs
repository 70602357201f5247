//! Histories of estimates: whole columns, matrices that are dropped, changes of names; and averages over model classes.

use kalmanscope_core::scenario::Law;
use kalmanscope_core::{FilterColor, FilterKind, ModelClasses, Pass, Run, Scenario, Update};

use crate::run::finished;

#[test]
fn matrices_that_are_dropped_are_empty_and_later_ones_are_right() {
    let mut scenario = Scenario { duration: 2.0, ..Scenario::default() };
    (scenario.filters[1].kind, scenario.filters[1].ensemble_size) = (FilterKind::PF, 50);
    let run = finished(&scenario);
    for (place, whole) in run.estimates().iter().enumerate() {
        let mut pass = Pass::new(&scenario, place, run.record()).unwrap();
        let mut history = Pass::history(&scenario, place).unwrap();
        pass.follow(run.record(), 100, &mut history);
        history.drop_matrices();
        pass.follow(run.record(), 201, &mut history);
        for forgotten in [0, 40, 100] {
            history.forget(forgotten - history.forgotten());
            let gains: Vec<f64> = history.gains(0, 1).collect();
            for k in forgotten..201 {
                let (cov, gain) = (history.cov(k - forgotten), history.gain(k - forgotten));
                let keeps_gain = k >= 99 || whole.kind == FilterKind::PF;
                assert_eq!(cov, if k < 99 { &[][..] } else { whole.cov(k) }, "{forgotten} {k}");
                assert_eq!(gain, if keeps_gain { whole.gain(k) } else { &[][..] }, "{forgotten} {k}");
                assert_eq!(gains[k - forgotten].is_nan(), !keeps_gain, "{forgotten} {k}");
                assert_eq!(history.mean(k - forgotten), whole.mean(k));
                assert_eq!(history.std(k - forgotten, 2), whole.std(k, 2));
            }
        }
    }
}

#[test]
fn columns_have_the_numbers_of_each_sample() {
    let mut run = Run::new(&Scenario { duration: 1.0, ..Scenario::default() }).unwrap();
    run.advance_to(80);
    run.forget(30);
    let estimates = &run.estimates()[1];
    let (n, m) = (estimates.channels().len(), estimates.sensors().len());
    assert_eq!((n, m, estimates.len(), estimates.forgotten()), (4, 2, 50, 30));
    let same = |column: &mut dyn Iterator<Item = f64>, of: &dyn Fn(usize) -> f64| {
        let column: Vec<u64> = column.map(f64::to_bits).collect();
        assert_eq!(column, (0..50).map(|k| of(k).to_bits()).collect::<Vec<_>>());
    };
    for i in 0..n {
        same(&mut estimates.means(i), &|k| estimates.mean(k)[i]);
        same(&mut estimates.stds(i), &|k| estimates.std(k, i));
        for j in 0..m {
            same(&mut estimates.gains(i, j), &|k| estimates.gain(k)[j * n + i]);
        }
    }
    for j in 0..m {
        same(&mut estimates.innovations(j), &|k| estimates.innovation(k)[j]);
        same(&mut estimates.innovation_stds(j), &|k| estimates.innovation_cov(k)[j * m + j].sqrt());
    }
    same(&mut estimates.log_likelihoods(), &|k| estimates.log_likelihood(k));
}

#[test]
fn a_name_a_colour_and_laws_compute_nothing() {
    let mut scenario = Scenario { duration: 2.0, ..Scenario::default() };
    let mut run = finished(&scenario);
    let before = run.checksum();
    (scenario.filters[0].name, scenario.filters[0].color) = ("other".to_owned(), Some(FilterColor::Sky));
    scenario.draw.insert("seed".to_owned(), Law::Uniform([1.0, 2.0]));
    assert!(matches!(run.update(&scenario), Ok(Update::Filters(changed)) if changed.is_empty()));
    let estimates = &run.estimates()[0];
    assert_eq!((estimates.name(), estimates.color()), ("other", FilterColor::Sky));
    assert_eq!((run.scenario(), run.checksum()), (&scenario, before));
}

#[test]
fn probabilities_are_shares_of_the_evidence() {
    let of = |evidence: &[f64]| ModelClasses::new(evidence.iter().copied());
    let close = |a: f64, b: f64| assert!((a - b).abs() < 1e-14, "{a} {b}");
    let three = of(&[-64.0, -64.0 + 2.0_f64.ln(), -864.0]);
    close(three.probabilities[0], 1.0 / 3.0);
    close(three.probabilities[1], 2.0 / 3.0);
    assert_eq!((three.probabilities[2], three.likeliest()), (0.0, Some(1)));
    let stopped = of(&[f64::NEG_INFINITY, 5.0, f64::NAN]);
    assert_eq!(stopped.probabilities, [0.0, 1.0, 0.0]);
    for none in [of(&[]), of(&[f64::NEG_INFINITY; 2])] {
        assert!(none.likeliest().is_none() && none.probabilities.iter().all(|p| *p == 0.0));
        assert!(none.average(|_| Some((1.0, 1.0))).is_none());
    }
}

#[test]
fn an_average_has_the_spread_of_the_classes_too() {
    let classes = ModelClasses::new([0.0, 3.0_f64.ln(), f64::NEG_INFINITY]);
    let (mean, variance) = classes.average(|class| Some(([1.0, 5.0, f64::NAN][class], 0.5))).unwrap();
    assert!((mean - 4.0).abs() < 1e-15 && (variance - (0.5 + 0.25 * 9.0 + 0.75)).abs() < 1e-14);
    let (alone, own) = classes.average(|class| (class == 0).then_some((1.0, 0.5))).unwrap();
    assert!((alone - 1.0).abs() < 1e-15 && (own - 0.5).abs() < 1e-15);
    assert!(classes.average(|class| (class == 2).then_some((1.0, 0.5))).is_none());
}
