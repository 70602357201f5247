//! Playback, edits and long records.

use kalmanscope_core::{FilterKind, FilterSettings};

use super::*;

fn session() -> Session {
    Session::new(Scenario { duration: 4.0, ..Scenario::default() }).unwrap()
}

#[test]
fn every_way_to_a_sample_shows_the_same() {
    let mut played = session();
    (0..40).for_each(|_| played.advance(0.025));
    let mut sought = session();
    sought.seek(3.0);
    sought.seek(2.0);
    let mut switched = session();
    switched.set_mode(Mode::Whole);
    switched.seek(2.0);
    switched.set_mode(Mode::Live);
    let mut stepped = session();
    (0..200).for_each(|_| stepped.step());
    for other in [sought, switched, stepped] {
        assert_eq!(other.position(), played.position());
        assert_eq!(other.run().checksum(), played.run().checksum());
    }
}

#[test]
fn an_edit_takes_effect_at_once_and_an_impossible_one_does_no_harm() {
    let mut session = session();
    session.set_mode(Mode::Whole);
    let before = session.run().checksum();
    let mut edited = session.scenario().clone();
    edited.filters[0].fading = 1.02;
    session.set_scenario(edited.clone());
    let after = session.run().checksum();
    assert_ne!(before, after);
    edited.dt = -1.0;
    session.set_scenario(edited);
    assert!(session.problem().unwrap().contains("`dt`"));
    assert_eq!(session.run().checksum(), after);
    session.set_scenario(Scenario { duration: 2.0, ..Scenario::default() });
    assert_eq!((session.problem(), session.run().samples()), (None, 201));
}

fn long() -> Session {
    let mut scenario = Scenario { duration: 3000.0, ..Scenario::default() };
    scenario.filters.truncate(1);
    Session::new(scenario).unwrap()
}

fn wait(session: &mut Session) -> usize {
    (0..1000)
        .position(|_| {
            let there = !session.behind();
            session.advance(0.0);
            there
        })
        .unwrap()
}

#[test]
fn far_away_times_are_computed_in_slices_while_playback_waits() {
    let mut session = long();
    session.set_budget(Budget::Pieces(10));
    session.seek(1000.0);
    let first = session.run().done();
    assert!((2..50_000).contains(&first) && session.behind(), "{first}");
    assert_eq!((session.position(), session.time(), session.index()), (100_000, 1000.0, first - 1));
    session.advance(0.1);
    assert!(session.run().done() > first && session.time() == 1000.0);
    wait(&mut session);
    assert_eq!((session.run().done(), session.run().len(), session.index()), (100_001, 25_001, 25_000));
    assert_eq!(session.progress(), None);
    session.advance(0.1);
    assert_eq!((session.position(), session.index()), (100_020, 25_020));
    let before = session.generation();
    session.seek(999.0);
    assert!(session.behind());
    session.toggle_play();
    wait(&mut session);
    assert!(session.generation() > before);
    assert_eq!((session.run().len(), session.run().record().forgotten(), session.time()), (99_901, 0, 999.0));
}

fn heavy() -> Session {
    let mut scenario = Scenario { duration: 40.0, ..Scenario::default() };
    let particles = FilterSettings { kind: FilterKind::PF, ensemble_size: 200, ..scenario.filters[0].clone() };
    scenario.filters.push(FilterSettings { id: 0, name: "PF".to_owned(), ..particles });
    let mut session = whole(scenario);
    session.pause();
    session.set_budget(Budget::Pieces(3));
    session
}

fn whole(scenario: Scenario) -> Session {
    let mut session = Session::new(scenario).unwrap();
    session.set_mode(Mode::Whole);
    session
}

fn with(session: &Session, edit: impl FnOnce(&mut Scenario)) -> Scenario {
    let mut scenario = session.scenario().clone();
    edit(&mut scenario);
    scenario
}

#[test]
fn a_heavy_edit_leaves_the_last_picture_until_the_next_is_complete() {
    let mut session = heavy();
    let (before, generation) = (session.run().checksum(), session.generation());
    let log_likelihood = session.diagnostics()[0].log_likelihood();
    let edited = with(&session, |scenario| scenario.sensors[0].noise_std *= 2.0);
    session.set_scenario(edited.clone());
    let mut shares = Vec::new();
    while let Some(share) = session.progress() {
        assert_eq!((session.run().checksum(), session.generation()), (before, generation));
        assert_eq!(session.diagnostics()[0].log_likelihood(), log_likelihood);
        assert_ne!(session.run().scenario(), session.scenario());
        shares.push(share);
        session.advance(0.1);
    }
    assert!(shares.len() > 20 && shares.is_sorted() && shares[0] < 0.2, "{shares:?}");
    assert_eq!((session.run().scenario(), session.scenario()), (&edited, &edited));
    let at_once = whole(edited);
    assert_eq!(session.run().checksum(), at_once.run().checksum());
    assert_eq!(session.diagnostics()[2].log_likelihood(), at_once.diagnostics()[2].log_likelihood());
}

#[test]
fn a_story_of_another_scenario_waits_for_its_run() {
    let being_computed = "The run of these settings is being computed.";
    let mut session = heavy();
    let story = |session: &Session| crate::story::story_of(session).to_string();
    let own = story(&session);
    session.set_scenario(with(&session, |scenario| scenario.sensors[0].noise_std *= 2.0));
    assert!(session.behind());
    assert_eq!(story(&session), own, "while a number is dragged, the picture and its story stay");
    for _ in 0..2 {
        session.advance(0.1);
        // The same system, so that nothing but its opening says that it is another one.
        session.set_scenario(with(&session, |scenario| scenario.seed += 1));
        session.begin_anew();
        assert!(session.behind());
        assert_eq!(story(&session), being_computed);
    }
    wait(&mut session);
    assert_ne!(story(&session), being_computed);
    session.set_scenario(with(&session, |scenario| scenario.sensors[0].noise_std *= 2.0));
    assert!(session.behind());
    assert_ne!(story(&session), being_computed, "what is dragged afterwards is an edit again");
    session.set_scenario(with(&session, |scenario| scenario.seed += 1));
    session.begin_anew();
    assert!(session.cancel());
    assert_ne!(story(&session), being_computed);
}

#[test]
fn an_edit_that_is_given_up_is_taken_back() {
    let mut session = heavy();
    assert!(!session.cancel(), "nothing is computed");
    let (before, scenario) = (session.run().checksum(), session.scenario().clone());
    session.set_scenario(with(&session, |scenario| scenario.duration = 60.0));
    (0..5).for_each(|_| session.advance(0.1));
    assert!(session.behind() && session.cancel() && !session.behind());
    assert_eq!((session.run().checksum(), session.scenario(), session.mode()), (before, &scenario, Mode::Whole));
    // One that is impossible does not stop what is computed.
    session.set_scenario(with(&session, |scenario| scenario.seed = 9));
    session.set_scenario(with(&session, |scenario| scenario.dt = -1.0));
    assert!(session.behind() && session.problem().is_some());
    wait(&mut session);
    assert_eq!(session.run().scenario().seed, 9);
    // From live to the whole record and back.
    session.set_scenario(with(&session, |scenario| scenario.dt = 0.01));
    wait(&mut session);
    session.set_mode(Mode::Live);
    session.seek(1.0);
    wait(&mut session);
    session.set_mode(Mode::Whole);
    assert!(session.behind() && session.cancel());
    assert_eq!((session.mode(), session.run().done(), session.position()), (Mode::Live, 101, 100));
}

#[test]
fn a_new_edit_begins_again() {
    let mut session = heavy();
    session.set_scenario(with(&session, |scenario| scenario.seed = 5));
    (0..20).for_each(|_| session.advance(0.1));
    let share = session.progress().unwrap();
    session.set_scenario(with(&session, |scenario| scenario.seed = 6));
    assert!(session.progress().unwrap() < share);
    // The next ones come at once: the last counts.
    for seed in 7..10 {
        session.set_scenario(with(&session, |scenario| scenario.seed = seed));
    }
    wait(&mut session);
    assert_eq!((session.run().scenario().seed, session.run().len()), (9, 4001));
    let at_once = whole(session.scenario().clone());
    assert_eq!(session.run().checksum(), at_once.run().checksum());
}

#[test]
fn what_is_kept_follows_from_where_the_run_stands() {
    let mut played = long();
    played.set_speed(1770.0);
    (0..13).for_each(|_| played.advance(0.1));
    played.toggle_play();
    played.seek(2345.67);
    wait(&mut played);
    let mut sought = long();
    sought.seek(2900.0);
    sought.seek(2345.67);
    wait(&mut sought);
    let mut bounded = long();
    bounded.seek(2345.67);
    wait(&mut bounded);
    bounded.want(Wanted { bounds: true, ..Wanted::default() });
    wait(&mut bounded);
    assert_eq!(bounded.bounds()[0].bound.len(), bounded.run().len());
    for session in [&sought, &bounded, &played] {
        assert_eq!((session.run().done(), session.run().record().forgotten()), (234_568, 150_000));
        assert_eq!((session.position(), session.index()), (234_567, 84_567));
        assert_eq!(session.run().checksum(), sought.run().checksum());
        let [one, other] = [session, &sought].map(|session| session.diagnostics()[0].log_likelihood());
        assert_eq!(one.to_bits(), other.to_bits());
        assert_eq!(session.diagnostics()[0].len(), session.run().len());
    }
}

#[test]
fn a_record_that_is_too_long_is_live_until_it_is_shorter() {
    let mut session = session();
    session.set_mode(Mode::Whole);
    let long = Scenario { duration: 3000.0, ..session.scenario().clone() };
    let short = session.scenario().clone();
    session.seek(3.0);
    session.set_scenario(long);
    assert!(!session.can_be_whole());
    assert_eq!((session.mode(), session.position(), session.run().done()), (Mode::Live, 300, 301));
    session.seek(1500.0);
    wait(&mut session);
    assert!(session.run().record().forgotten() > 0);
    session.set_scenario(short);
    assert_eq!((session.mode(), session.run().len(), session.position()), (Mode::Whole, 401, 400));
}
