//! Filters of a job that the caller computes on other processors.

use super::Job;
use crate::data::scenario::cost;
use crate::samples::tape::Tape;
use crate::{Record, Study};

impl Job {
    /// Leaves the changed filters that would take longer than `seconds` on an ordinary processor to the caller, and
    /// returns their places. The job goes on with the others. Empty if the job does not keep the whole record.
    pub fn leave_long(&mut self, seconds: f64) -> Vec<usize> {
        let Self { revision, goal, stage, .. } = self;
        let is_whole = *goal == revision.samples && *stage == *goal;
        let scenario = &revision.bank.scenario;
        let time = |place: usize| 1e-9 * *goal as f64 * cost::of_step(&scenario.filters[place], scenario);
        let is_long = |place: &usize| is_whole && revision.done(*place) == 0 && time(*place) > seconds;
        let places: Vec<usize> = revision.order.iter().copied().filter(is_long).collect();
        revision.leave(places.clone());
        places
    }

    /// The whole record, once it is complete. `study` is the study that the job was made for.
    pub fn whole_record<'a>(&'a self, study: &'a Study) -> Option<&'a Record> {
        let revision = &self.revision;
        let is_there = revision.recorded().is_none_or(|recorded| recorded >= revision.samples);
        is_there.then(|| revision.own_record().unwrap_or(study.run.record()))
    }

    /// Takes in the next samples of a filter that was left to the caller. Returns false if they are not its own.
    pub fn take(&mut self, place: usize, tape: &Tape) -> bool {
        self.revision.take(place, tape)
    }

    /// Computes the filters that were left to the caller and are not complete, from their first sample on.
    pub fn take_back(&mut self) {
        self.revision.take_back();
    }
}

#[cfg(test)]
mod tests {
    use crate::{FilterKind, FilterSettings, Job, Pass, Scenario, Source, Study, Tape, Update};

    /// A study of every kind of filter, the adaptive ones too, and one that diverges.
    fn scenario() -> Scenario {
        let mut scenario = Scenario { duration: 6.0, ..Scenario::default() };
        let first = scenario.filters[0].clone();
        scenario.filters.clear();
        for kind in FilterKind::ALL {
            let filter =
                FilterSettings { kind, ensemble_size: 50, id: 0, name: kind.name().to_owned(), ..first.clone() };
            scenario.filters.push(filter);
        }
        let mut learns = FilterSettings { id: 0, kind: FilterKind::EKF, ..first.clone() };
        learns.adaptation.sensor_noise = true;
        let stops = FilterSettings { id: 0, kind: FilterKind::EKF, fading: 1e100, ..first };
        scenario.filters.extend([learns, stops]);
        scenario.number_filters();
        scenario
    }

    fn study() -> Study {
        Study::new(&Scenario { duration: 1.0, ..Scenario::default() }, Source::Simulated, 100_000).unwrap()
    }

    #[test]
    fn filters_that_are_computed_elsewhere_have_the_same_bits() {
        let (scenario, mut near, mut far) = (scenario(), study(), study());
        let mut job = Job::new(&mut near, &scenario, None, 601).unwrap();
        while !job.advance(&near, &mut || true).is_done() {}
        job.finish(&mut near);
        let mut job = Job::new(&mut far, &scenario, None, 601).unwrap();
        let places = job.leave_long(0.0);
        assert_eq!(places.len(), scenario.filters.len());
        assert!(!job.advance(&far, &mut || true).is_done());
        let record = job.whole_record(&far).unwrap().clone();
        for place in places {
            let mut pass = Pass::new(&scenario, place, &record).unwrap();
            for samples in [4, 300, 601] {
                let mut tape = Tape::default();
                pass.follow(&record, samples, &mut tape);
                assert!(job.take(place, &Tape::from_numbers(tape.numbers().to_vec())));
            }
            assert!(!job.take(place, &Tape::from_numbers(vec![1.0, 0.0, 0.0, 7.0])), "no sample of this filter");
        }
        assert!(job.advance(&far, &mut || true).is_done());
        assert_eq!(job.finish(&mut far), Update::Everything);
        for (near, far) in near.run().estimates().iter().zip(far.run().estimates()) {
            assert_eq!(format!("{near:?}"), format!("{far:?}"));
        }
        assert!(near.run().estimates().iter().any(|estimates| estimates.stop().is_some()));
        assert!(near.run().estimates().iter().any(|estimates| !estimates.remarks().is_empty()));
    }

    #[test]
    fn filters_that_are_taken_back_begin_again() {
        let (scenario, mut study) = (scenario(), study());
        let mut job = Job::new(&mut study, &scenario, None, 601).unwrap();
        let places = job.leave_long(0.0);
        job.advance(&study, &mut || true);
        let record = job.whole_record(&study).unwrap().clone();
        let mut tape = Tape::default();
        Pass::new(&scenario, places[0], &record).unwrap().follow(&record, 200, &mut tape);
        assert!(job.take(places[0], &tape));
        job.take_back();
        assert!(job.advance(&study, &mut || true).is_done());
        job.finish(&mut study);
        let mut run = crate::Run::new(&scenario).unwrap();
        run.finish();
        assert_eq!(study.run().checksum(), run.checksum());
    }

    #[test]
    fn a_part_of_a_record_is_computed_here() {
        let (scenario, mut study) = (scenario(), study());
        assert!(Job::new(&mut study, &scenario, None, 300).unwrap().leave_long(0.0).is_empty());
    }
}
