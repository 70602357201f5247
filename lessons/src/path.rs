//! Settings of a scenario by their path, as in `filters.EKF.process_std.natural_frequency`.

use kalmanscope_core::Channel;
use toml::{Table, Value};

/// Whether a scenario's table leaves out the setting at a path where it is unset.
fn is_optional(keys: &[&str]) -> bool {
    match keys {
        ["hold" | "input"] => true,
        ["filters", _, key] => ["augment", "color", "input_delay", "plant", "substeps"].contains(key),
        ["record", key] => ["band", "every", "from", "interpolate", "to"].contains(key),
        ["record", "input", key] | ["record", "sensors", _, key] => ["delay", "gain", "offset", "unit"].contains(key),
        _ => false,
    }
}

/// Replaces the value at a path. Returns whether the path exists.
///
/// Keys are separated by dots. A filter is found by its name, a sensor by its quantity, a number of a list by its place
/// from 0 on or, in a filter's `sensor_std`, by the sensor's quantity; `*` stands for all of them.
pub(crate) fn set(file: &mut Table, path: &str, value: &Value) -> bool {
    let place;
    let mut keys: Vec<&str> = path.split('.').collect();
    if let ["filters", _, "sensor_std", sensor] = keys[..]
        && let Some(number) = sensor_place(file, sensor)
    {
        place = number.to_string();
        keys[3] = &place;
    }
    set_in_table(file, &keys, value, is_optional(&keys))
}

/// The place of the sensor of a quantity.
fn sensor_place(file: &Table, quantity: &str) -> Option<usize> {
    file.get("sensors")?
        .as_array()?
        .iter()
        .position(|sensor| sensor.as_table().is_some_and(|sensor| is_called(sensor, quantity)))
}

fn set_in_table(table: &mut Table, keys: &[&str], value: &Value, optional: bool) -> bool {
    match keys {
        [] => false,
        [last] if optional || table.contains_key(*last) || Channel::from_key(last).is_some() => {
            table.insert((*last).to_owned(), value.clone());
            true
        }
        [_] => false,
        [first, rest @ ..] => match table.get_mut(*first) {
            Some(Value::Table(inner)) => set_in_table(inner, rest, value, optional),
            Some(Value::Array(items)) => set_in_list(items, rest, value, optional),
            _ => false,
        },
    }
}

fn set_in_list(items: &mut [Value], keys: &[&str], value: &Value, optional: bool) -> bool {
    let [first, rest @ ..] = keys else { return false };
    let mut found = false;
    for (place, item) in items.iter_mut().enumerate() {
        let all = *first == "*";
        match item {
            Value::Table(table) if all || is_called(table, first) => {
                if !set_in_table(table, rest, value, optional) {
                    return false;
                }
                found = true;
            }
            Value::Float(_) | Value::Integer(_) if rest.is_empty() && (all || first.parse() == Ok(place)) => {
                item.clone_from(value);
                found = true;
            }
            _ => {}
        }
    }
    found
}

fn is_called(item: &Table, name: &str) -> bool {
    ["name", "measures"].iter().any(|key| item.get(*key).and_then(Value::as_str) == Some(name))
}

/// Merges a table into another: subtables are merged, other values are replaced.
pub(crate) fn lay_over(below: &mut Table, above: &Table) {
    for (key, value) in above {
        match (below.get_mut(key), value) {
            (Some(Value::Table(below)), Value::Table(above)) => lay_over(below, above),
            _ => {
                below.insert(key.clone(), value.clone());
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file() -> Table {
        "[plant]\nnatural_frequency = 6.0\n[[sensors]]\nmeasures = \"velocity\"\nnoise_std = 0.1\n\
         [[filters]]\nname = \"A, b\"\nfading = 1.0\nsensor_std = [1.0, 2.0]\n[[filters]]\nname = \"C\"\nfading = 1.0"
            .parse()
            .unwrap()
    }

    #[test]
    fn every_kind_of_place_can_be_set() {
        let mut file = file();
        let step: Value = Value::Table("step = { from = 1.0, to = 2.0, at = 3.0 }".parse().unwrap());
        for (path, value) in [
            ("plant.natural_frequency", step.clone()),
            ("sensors.velocity.noise_std", Value::Float(0.2)),
            ("filters.A, b.fading", Value::Float(1.5)),
            ("filters.A, b.sensor_std.1", Value::Float(7.0)),
            ("filters.C.plant", Value::String("sdof".into())),
        ] {
            assert!(set(&mut file, path, &value), "{path}");
        }
        assert_eq!(file["plant"]["natural_frequency"], step);
        assert_eq!(file["sensors"][0]["noise_std"].as_float(), Some(0.2));
        assert_eq!(file["filters"][0]["fading"].as_float(), Some(1.5));
        assert_eq!(file["filters"][0]["sensor_std"][1].as_float(), Some(7.0));
        assert_eq!(file["filters"][1]["plant"].as_str(), Some("sdof"));
        assert_eq!(file["filters"][1]["fading"].as_float(), Some(1.0));
        assert!(set(&mut file, "filters.A, b.sensor_std.velocity", &Value::Float(8.0)));
        assert_eq!(file["filters"][0]["sensor_std"][0].as_float(), Some(8.0));
        assert!(set(&mut file, "filters.*.fading", &Value::Float(3.0)));
        assert!(file["filters"].as_array().unwrap().iter().all(|f| f["fading"].as_float() == Some(3.0)));
    }

    #[test]
    fn unknown_settings_cannot_be_set() {
        for path in [
            "",
            "plnt.natural_frequency",
            "plant.frequency",
            "plant.natural_frequency.step",
            "filters",
            "filters.C",
            "filters.D.fading",
            "filters.*.fadng",
            "filters.*.sensor_std",
            "filters.A, b.sensor_std.2",
            "filters.A, b.sensor_std.displacement",
            "sensors.acceleration.noise_std",
        ] {
            assert!(path == "filters" || !set(&mut file(), path, &Value::Float(1.0)), "{path}");
        }
    }

    #[test]
    fn tables_are_merged_and_values_replaced() {
        let mut below: Table = "a = 1\n[t]\nb = 2\nc = 3".parse().unwrap();
        lay_over(&mut below, &"a = 9\nd = 5\n[t]\nb = 7".parse().unwrap());
        assert_eq!(below, "a = 9\nd = 5\n[t]\nb = 7\nc = 3".parse().unwrap());
    }
}
