//! A guess at the meaning of a file's columns.

use super::unit::{Dimension, unit};
use super::{Column, MappedColumn, Mapping, Table, Time};
use crate::{InputKind, Quantity};

/// The meaning of a column, as far as its header tells.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Role {
    Time,
    Input(InputKind),
    Sensor(Quantity),
}

/// Words in names, in the order in which they are looked for. Those of one or two letters must be the whole name.
const WORDS: [(&[&str], Role); 7] = [
    (&["ground_acceleration", "ground", "base", "boden"], Role::Input(InputKind::GroundAcceleration)),
    (&["total_acceleration"], Role::Sensor(Quantity::TOTAL_ACCELERATION)),
    (&["force", "input", "load", "kraft", "excitation", "drive", "f", "u", "in", "v1"], Role::Input(InputKind::Force)),
    (&["time", "zeit", "seconds", "stamp", "temps", "t", "s"], Role::Time),
    (&["acceleration", "accel", "acc", "beschl", "a", "ax", "az"], Role::Sensor(Quantity::ACCELERATION)),
    (&["velocity", "speed", "geschw", "vel", "v"], Role::Sensor(Quantity::VELOCITY)),
    (
        &["displacement", "disp", "position", "pos", "angle", "deflection", "weg", "output", "winkel", "x", "y", "v2"],
        Role::Sensor(Quantity::DISPLACEMENT),
    ),
];

fn role_of(column: &Column) -> Option<Role> {
    if let Some(quantity) = Quantity::from_key(&column.name) {
        return Some(Role::Sensor(quantity));
    }
    let name = column.name.to_lowercase();
    let words: Vec<&str> = name.split(|c: char| !c.is_alphanumeric()).collect();
    let fits = |word: &&str| match word.len() {
        ..=2 => words.contains(word),
        _ => name.contains(*word),
    };
    let named = WORDS.iter().find(|(words, _)| words.iter().any(&fits)).map(|(_, role)| *role);
    let of_unit = || match unit(column.unit.as_deref()?)?.0 {
        Dimension::Time => Some(Role::Time),
        Dimension::Length | Dimension::Angle => Some(Role::Sensor(Quantity::DISPLACEMENT)),
        Dimension::Velocity => Some(Role::Sensor(Quantity::VELOCITY)),
        Dimension::Acceleration => Some(Role::Sensor(Quantity::ACCELERATION)),
        Dimension::Force => Some(Role::Input(InputKind::Force)),
        Dimension::Voltage => None,
    };
    named.or_else(of_unit)
}

/// Whether the numbers rise in even steps, as times do.
fn is_like_time(values: &[f64]) -> bool {
    let [first, .., last] = *values else { return false };
    let mean = (last - first) / (values.len() - 1) as f64;
    mean > 0.0 && values.windows(2).all(|pair| pair[1] > pair[0] && pair[1] - pair[0] < 100.0 * mean)
}

/// Whether most numbers are larger than the one before: a column of that name is the time, even if a line is wrong.
fn mostly_rises(values: &[f64]) -> bool {
    2 * values.windows(2).filter(|pair| pair[1] > pair[0]).count() >= values.len().saturating_sub(1)
}

/// Whether a column belongs to the truth of a simulated record.
fn is_truth(column: &Column) -> bool {
    column.name.starts_with("true_")
}

impl Mapping {
    /// A guess from names, units and shapes, with the kind of input: names first; then the first column whose numbers rise
    /// evenly is the time; and of two columns without a meaning the first is the input and the second the displacement.
    pub fn guess(table: &Table) -> (Self, InputKind) {
        let columns = &table.columns;
        let numeric = |place: &usize| !table.is_without_numbers(*place) && !is_truth(&columns[*place]);
        let places: Vec<usize> = (0..columns.len()).filter(numeric).collect();
        let mut roles: Vec<(usize, Option<Role>)> =
            places.iter().map(|&place| (place, role_of(&columns[place]))).collect();
        // The first column of each role has it.
        for i in 0..roles.len() {
            let is_taken = |role: Role| match role {
                Role::Input(_) => roles[..i].iter().any(|(_, other)| matches!(other, Some(Role::Input(_)))),
                role => roles[..i].iter().any(|(_, other)| *other == Some(role)),
            };
            let is_false_time = roles[i].1 == Some(Role::Time) && !mostly_rises(&columns[roles[i].0].values);
            if roles[i].1.is_some_and(is_taken) || is_false_time {
                roles[i].1 = None;
            }
        }
        let has = |roles: &[(usize, Option<Role>)], wanted: &dyn Fn(Role) -> bool| {
            roles.iter().any(|(_, role)| role.is_some_and(wanted))
        };
        if !has(&roles, &|role| role == Role::Time)
            && let Some((_, role)) =
                roles.iter_mut().find(|(place, role)| role.is_none() && is_like_time(&columns[*place].values))
        {
            *role = Some(Role::Time);
        }
        let free = |roles: &[(usize, Option<Role>)]| roles.iter().filter(|(_, role)| role.is_none()).count();
        let has_sensor = has(&roles, &|role| matches!(role, Role::Sensor(_)));
        if !has(&roles, &|role| matches!(role, Role::Input(_)))
            && (free(&roles) >= 2 || (has_sensor && free(&roles) == 1))
            && let Some((_, role)) = roles.iter_mut().find(|(_, role)| role.is_none())
        {
            *role = Some(Role::Input(InputKind::Force));
        }
        if !has_sensor && let Some((_, role)) = roles.iter_mut().find(|(_, role)| role.is_none()) {
            *role = Some(Role::Sensor(Quantity::DISPLACEMENT));
        }
        // An accelerometer on a structure feels the ground too.
        let on_ground = |role: Role| role == Role::Input(InputKind::GroundAcceleration);
        if has(&roles, &on_ground) && !has(&roles, &|role| role == Role::Sensor(Quantity::TOTAL_ACCELERATION)) {
            for (_, role) in &mut roles {
                if *role == Some(Role::Sensor(Quantity::ACCELERATION)) {
                    *role = Some(Role::Sensor(Quantity::TOTAL_ACCELERATION));
                }
            }
        }
        let mut mapping = Self::default();
        let mut kind = InputKind::Force;
        for (place, role) in roles {
            let column = &columns[place];
            let unit = column.unit.clone().unwrap_or_default();
            let mapped = || MappedColumn { unit: unit.clone(), ..MappedColumn::new(column.name.clone()) };
            match role {
                Some(Role::Time) => {
                    mapping.time = Time { column: Some(column.name.clone()), unit, rate: None };
                }
                Some(Role::Input(of)) => {
                    kind = of;
                    mapping.input = Some(mapped());
                }
                Some(Role::Sensor(quantity)) => {
                    mapping.sensors.insert(quantity, mapped());
                }
                None => {}
            }
        }
        (mapping, kind)
    }
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::*;

    #[track_caller]
    fn check(text: &str, time: Option<&str>, input: Option<&str>, sensors: &[(Quantity, &str)]) -> InputKind {
        let table = read(text.as_bytes(), None).unwrap();
        let (mapping, kind) = Mapping::guess(&table);
        assert_eq!(mapping.time.column.as_deref(), time, "{text}");
        assert_eq!(mapping.input.as_ref().map(|input| input.column.as_str()), input, "{text}");
        let found: Vec<_> = mapping.sensors.iter().map(|(q, column)| (*q, column.column.as_str())).collect();
        assert_eq!(found, sensors, "{text}");
        kind
    }

    #[test]
    fn names_and_shapes_are_understood() {
        let x = Quantity::DISPLACEMENT;
        check("t,force,displacement\n0,1,2\n1,0,3\n2,1,2\n", Some("t"), Some("force"), &[(x, "displacement")]);
        check("Time,Force,Displacement\n0,1,2\n1,0,3\n2,1,1\n", Some("Time"), Some("Force"), &[(x, "Displacement")]);
        check("V1,V2\n0.1,0.2\n0.3,-0.1\n0.2,0\n", None, Some("V1"), &[(x, "V2")]);
        check("0 1 2\n0.1 0 3\n0.2 1 0\n", Some("column 1"), Some("column 2"), &[(x, "column 3")]);
        let angle = "Time,\"Angle, Ch 1+2 (rad) Run #13\"\n0,0.5\n0.1,0.4\n0.2,0.1\n";
        check(angle, Some("Time"), None, &[(x, "Angle, Ch 1+2 Run #13")]);
        let ground = "time,ground acc (g),total_acceleration\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
        let total = Quantity::TOTAL_ACCELERATION;
        assert_eq!(
            check(ground, Some("time"), Some("ground acc"), &[(total, "total_acceleration")]),
            InputKind::GroundAcceleration
        );
        let felt = "time,ground (g),roof acc (g)\n0,0.1,1\n1,0.2,1\n2,0.1,2\n";
        check(felt, Some("time"), Some("ground"), &[(total, "roof acc")]);
        check("time,acc (g)\n0,1\n1,-1\n2,0\n", Some("time"), None, &[(Quantity::ACCELERATION, "acc")]);
        check("Zeit;Kraft;Weg\n0,0;1;2\n0,1;0;3\n0,2;1;1\n", Some("Zeit"), Some("Kraft"), &[(x, "Weg")]);
        check("1\n3\n2\n", None, None, &[(x, "column 1")]);
        check("t,x,true_displacement\n0,1,1\n1,2,2\n2,1,1\n", Some("t"), None, &[(x, "x")]);
    }
}
