//! Scores equal the numbers of the diagnostics, in constant memory.

use kalmanscope_core::{
    Diagnosis, Diagnostics, FilterKind, FilterSettings, Pass, PlantKind, Run, Scenario, Scores, VerdictKind,
};

/// Filters of several kinds, one of which loses the truth.
fn scenario() -> Scenario {
    let mut scenario = Scenario { duration: 30.0, ..Scenario::default() };
    let good = scenario.filters[0].clone();
    let of = |name: &str, kind| FilterSettings { name: name.to_owned(), kind, ensemble_size: 80, ..good.clone() };
    let mut sure = of("sure", FilterKind::EKF);
    sure.fading = 1.0;
    for &channel in PlantKind::SDOF.channels().iter().skip(2) {
        sure.initial_std[channel] = 1e-6;
        sure.initial_mean[channel] *= 3.0;
    }
    scenario.filters.extend([of("PF", FilterKind::PF), of("KF", FilterKind::KF), sure]);
    scenario
}

#[test]
fn scores_are_the_diagnostics_to_the_last_bit() {
    let scenario = scenario();
    let mut run = Run::new(&scenario).unwrap();
    run.finish();
    let record = run.record();
    for (place, estimates) in run.estimates().iter().enumerate() {
        let mut scores = Scores::new(&Pass::history(&scenario, place).unwrap(), record);
        let mut pass = Pass::new(&scenario, place, record).unwrap();
        for samples in [1, 2, 500, usize::MAX] {
            pass.follow(record, samples, &mut scores.against(record));
        }
        let diagnostics = Diagnostics::new(estimates, record);
        assert_eq!(scores.len(), estimates.len());
        assert_eq!(scores.nees(), diagnostics.nees_within(0..estimates.len()));
        assert_eq!(scores.nis(), diagnostics.nis_within(0..estimates.len()));
        assert_eq!(scores.log_likelihood().to_bits(), diagnostics.log_likelihood().to_bits());
        for channel in diagnostics.known() {
            let score = scores.channel(channel).unwrap();
            let tally = diagnostics.tally(channel, 0..estimates.len()).unwrap();
            assert_eq!((score.rmse, score.coverage), (tally.rmse(), tally.coverage()));
            assert_eq!((Some(score.error), score.settled), (diagnostics.error(channel), diagnostics.settled(channel)));
            let last = estimates.std(estimates.len() - 1, estimates.place(channel).unwrap());
            assert_eq!(score.std, last);
        }
        let diagnosis = Diagnosis::new(&diagnostics, estimates, record, None).unwrap();
        let diverged = diagnosis.verdict.unwrap().kind == VerdictKind::Diverged;
        assert_eq!(scores.diverged(), diverged, "{}", estimates.name());
    }
}
