use kalmanscope_core::{Channel, FilterKind, Scenario};
use kalmanscope_lessons::{Adjustment, LessonError};

fn change(text: &str) -> Adjustment {
    toml::from_str(text).unwrap()
}

fn apply(text: &str) -> Result<Scenario, LessonError> {
    change(text).apply(&Scenario::default())
}

#[test]
fn filters_and_sensors_come_and_go() {
    let scenario = apply(
        "remove_filters = [\"UKF\"]\nremove_sensors = [\"velocity\"]\n\
         add_sensors = [{ measures = \"acceleration\", noise_std = 0.5 }]\n\
         [[add_filters]]\nlike = \"EKF\"\nname = \"P\"\nkind = \"pf\"\ninitial_std = { velocity = 7.0 }",
    )
    .unwrap();
    let [ekf, pf] = &scenario.filters[..] else { panic!("{:?}", scenario.filters) };
    assert_eq!((ekf.name.as_str(), pf.name.as_str(), pf.kind), ("EKF", "P", FilterKind::PF));
    assert_eq!(
        (pf.fading, pf.initial_std[Channel::VELOCITY], pf.initial_std[Channel::NATURAL_FREQUENCY]),
        (1.005, 7.0, 2.0)
    );
    assert!(scenario.filters.iter().all(|f| f.sensor_std == [0.01, 0.5]));
}

#[test]
fn paths_name_all_that_is_set_or_added() {
    let change = change(
        "set = { \"filters.EKF.fading\" = 1.01, dt = 0.1 }\nadd_filters = [{ like = \"EKF\", name = \"P\" }]\n\
         add_sensors = [{ measures = \"acceleration\", noise_std = 0.5 }]\nremove_filters = [\"UKF\"]",
    );
    let mut paths = change.paths();
    paths.sort();
    assert_eq!(paths, ["dt", "filters.EKF.fading", "filters.P.name", "sensors.acceleration.noise_std"]);
}

#[test]
fn errors_have_the_name_of_what_is_missing() {
    for (text, message) in [
        (
            "set = { \"filters.KF.fading\" = 1 }",
            "the scenario has no setting `filters.KF.fading`; its filters are `EKF` and `UKF`",
        ),
        ("remove_filters = [\"KF\"]", "the scenario has no filter `KF`"),
        ("remove_sensors = [\"acceleration\"]", "the scenario has no sensor for acceleration"),
        ("add_filters = [{ like = \"KF\", name = \"A\" }]", "the scenario has no filter `KF`"),
        (
            "add_filters = [{ like = \"EKF\", name = \"UKF\" }]",
            "a filter is added as `UKF`, but must have a name that no other has",
        ),
    ] {
        assert_eq!(apply(text).unwrap_err().to_string(), message);
    }
    let unknown = apply("set = { \"filters.EKF.fadng\" = 1 }").unwrap_err().to_string();
    assert!(unknown.contains("unknown field `fadng`"), "{unknown}");
    let impossible = apply("set = { \"filters.EKF.fading\" = 0.5 }").unwrap_err().to_string();
    assert!(impossible.contains("filters[0].fading"), "{impossible}");
    let unknown = toml::from_str::<Adjustment>("sett = {}").unwrap_err().to_string();
    assert!(unknown.contains("sett"), "{unknown}");
}
