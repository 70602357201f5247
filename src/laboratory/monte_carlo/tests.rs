use super::*;
use crate::laboratory::Laboratory;
use crate::session::{Budget, Session};
use crate::team::Frames;

fn slow(seeds: usize) -> Laboratory {
    let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Pieces(1))));
    laboratory.seeds.choose(SeedChoice { seeds, ..SeedChoice::default() });
    laboratory
}

fn session() -> Session {
    Session::new(Scenario { duration: 2.0, ..Scenario::default() }).unwrap()
}

fn follow(laboratory: &mut Laboratory, session: &Session, frames: usize) {
    let ctx = Context::default();
    let filters: Vec<u32> = session.scenario().filters.iter().map(|filter| filter.id).collect();
    (0..frames).for_each(|_| laboratory.follow_seeds(session, &filters, true, &ctx));
}

fn followed(seeds: usize, frames: usize) -> (Session, Laboratory) {
    let (session, mut laboratory) = (session(), slow(seeds));
    follow(&mut laboratory, &session, frames);
    (session, laboratory)
}

fn with(session: &mut Session, change: impl FnOnce(&mut Scenario)) {
    let mut scenario = session.scenario().clone();
    change(&mut scenario);
    session.set_scenario(scenario);
}

fn done(laboratory: &Laboratory) -> usize {
    laboratory.seeds.shown().unwrap().statistics.done()
}

#[test]
fn the_table_has_one_row_a_filter_and_time() {
    let (_, laboratory) = followed(12, 15);
    assert_eq!((done(&laboratory), laboratory.seeds.progress()), (12, None));
    let shown = laboratory.seeds.shown().unwrap();
    let expected = &shown.statistics;
    let table = shown.to_csv();
    let mut lines = table.lines();
    let header: Vec<&str> = lines.next().unwrap().split(',').collect();
    let column = header.iter().position(|name| *name == "natural_frequency.rmse").unwrap();
    let rows: Vec<Vec<&str>> = lines.map(|line| line.split(',').collect()).collect();
    assert_eq!(rows.len(), 2 * expected.samples().len());
    assert!(rows.iter().all(|row| row.len() == header.len() && row[2] == "12"));
    let at = expected.channels(1).iter().position(|channel| *channel == Channel::NATURAL_FREQUENCY).unwrap();
    let last = expected.rmse(1, at).last().unwrap();
    assert_eq!(rows.last().unwrap()[column].parse(), Ok(last));
}

#[test]
fn another_scenario_begins_and_the_old_picture_stays_until_there_are_enough_seeds() {
    let (mut session, mut laboratory) = followed(15, 15);
    with(&mut session, |scenario| scenario.filters[0].fading = 1.03);
    follow(&mut laboratory, &session, ENOUGH - 1);
    let fading = |laboratory: &Laboratory| laboratory.seeds.shown().unwrap().scenario().filters[0].fading;
    assert_eq!((fading(&laboratory), done(&laboratory), laboratory.seeds.is_shown_old()), (1.005, 15, true));
    follow(&mut laboratory, &session, 1);
    assert_eq!((fading(&laboratory), done(&laboratory), laboratory.seeds.is_shown_old()), (1.03, ENOUGH, false));
}

#[test]
fn the_scenarios_own_seed_and_a_colour_begin_nothing() {
    let (mut session, mut laboratory) = followed(12, 4);
    with(&mut session, |scenario| {
        scenario.seed = 77;
        scenario.filters[0].color = Some(kalmanscope_core::FilterColor::ALL[3]);
    });
    follow(&mut laboratory, &session, 1);
    assert_eq!(done(&laboratory), 5);
}

#[test]
fn more_seeds_go_on_from_those_that_are_done() {
    let (session, mut laboratory) = followed(12, 12);
    laboratory.seeds.choose(SeedChoice { seeds: 20, ..SeedChoice::default() });
    follow(&mut laboratory, &session, 1);
    assert_eq!((done(&laboratory), laboratory.seeds.progress()), (13, Some([13, 20])));
    follow(&mut laboratory, &session, 7);
    assert_eq!(laboratory.seeds.progress(), None);
    laboratory.seeds.choose(SeedChoice { seeds: 11, ..SeedChoice::default() });
    follow(&mut laboratory, &session, 11);
    assert_eq!((done(&laboratory), laboratory.seeds.progress()), (11, None), "fewer begin anew");
}

#[test]
fn a_map_under_way_comes_first() {
    let session = session();
    let mut laboratory = slow(12);
    let ctx = Context::default();
    laboratory.follow(&session, true, true, &ctx);
    follow(&mut laboratory, &session, 3);
    assert!(laboratory.seeds.shown().is_none() && laboratory.is_working());
    laboratory.set_stopped(true);
    follow(&mut laboratory, &session, 3);
    assert_eq!(done(&laboratory), 3);
}

#[test]
fn without_filters_a_sentence_says_so() {
    let mut laboratory = slow(12);
    laboratory.follow_seeds(&session(), &[], true, &Context::default());
    assert_eq!(laboratory.seeds.state.problem.as_deref(), Some("No filter is shown."));
    assert!(laboratory.seeds.shown().is_none());
    follow(&mut laboratory, &session(), 1);
    assert_eq!((laboratory.seeds.state.problem.as_deref(), done(&laboratory)), (None, 1));
}

#[test]
fn impossible_numbers_of_seeds_are_refused() {
    for (seeds, is_possible) in [(9, false), (10, true), (10_000, true), (10_001, false)] {
        assert_eq!(SeedChoice { seeds, ..SeedChoice::default() }.check().is_ok(), is_possible, "{seeds}");
    }
}
