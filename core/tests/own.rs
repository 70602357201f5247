//! Plants and filters from outside of the crate.

#[path = "../examples/own_filter.rs"]
#[expect(dead_code, reason = "an example has a main function")]
mod own_filter;
#[path = "../examples/own_plant.rs"]
#[expect(dead_code, reason = "an example has a main function")]
mod own_plant;

#[test]
fn a_plant_of_ones_own_is_identified() {
    for (estimate, std) in own_plant::identify().expect("the scenario is possible") {
        assert!((estimate - 5.0).abs() < 3.0 * std && std < 0.1, "{estimate} ± {std}");
    }
}

#[test]
fn a_filter_of_ones_own_can_be_stepped_by_hand_and_used_in_a_scenario() {
    let after_an_outlier = own_filter::step_by_hand().expect("the filter goes on");
    assert!(after_an_outlier.abs() < 0.05, "{after_an_outlier}");
    let (estimate, std) = own_filter::identify().expect("the scenario is possible");
    assert!((estimate - 4.8).abs() < 4.0 * std && std < 0.3, "{estimate} ± {std}");
}
