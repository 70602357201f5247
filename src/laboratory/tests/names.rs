//! Filters that get other names.

use super::*;

#[test]
fn a_map_of_a_filter_by_its_name_stays_when_that_changes() {
    let mut session = session();
    let mut laboratory = Laboratory::new(Rc::new(Frames(Budget::Unlimited)));
    let axes = ["filters.UKF.fading=1:1.1:3", "filters.*.process_std=0.1:10:3:log"];
    let axes = axes.map(|text| Axis::parse(text).unwrap());
    let chosen = Choice { axes, second: Some(1), filter: 2, ..choice() };
    chosen.check(session.scenario()).unwrap();
    laboratory.choose(Some(chosen));
    follow(&mut laboratory, &session, 2);
    let edition = laboratory.edition();
    assert_eq!((laboratory.state().problem(), done(&laboratory)), (None, 9));
    let heading = |laboratory: &Laboratory| laboratory.shown().unwrap().to_csv().lines().next().unwrap().to_owned();
    assert!(
        heading(&laboratory).starts_with("filters.UKF.fading,filters.*.process_std,UKF."),
        "{}",
        heading(&laboratory)
    );
    with(&mut session, |scenario| scenario.filters[1].name = "Mine".to_owned());
    session.advance(0.0);
    follow(&mut laboratory, &session, 2);
    assert_eq!((laboratory.edition(), laboratory.is_working()), (edition, false), "nothing begins again");
    assert_eq!(laboratory.choice().unwrap().axes[0].key, "filters#2.fading");
    assert!(
        heading(&laboratory).starts_with("filters.Mine.fading,filters.*.process_std,Mine."),
        "{}",
        heading(&laboratory)
    );
    let both = ["filters.UKF.fading=1:1.1:3", "filters#2.fading=1:1.2:3"].map(|text| Axis::parse(text).unwrap());
    let chosen = Choice { axes: both, filter: 2, ..choice() };
    let problem = chosen.check(super::session().scenario()).unwrap_err();
    assert!(problem.contains("both axes of the map set `filters.UKF.fading`"), "{problem}");
}
