//! Measurements that take minutes, of start values and of the largest filters.
//!
//! ```text
//! cargo bench -p kalmanscope-core --bench measurements -- grid|losses|decays|ambient|largest
//! ```
#![expect(clippy::unwrap_used, reason = "a helper that fails is a measurement that fails")]

#[path = "../common/ambient.rs"]
mod ambient;
#[path = "../common/ambient_end.rs"]
mod ambient_end;
#[path = "../common/excitation.rs"]
mod excitation;
mod largest;
#[path = "ambient.rs"]
mod of_ambient;
#[path = "start_values.rs"]
mod of_start_values;
#[path = "../common/random.rs"]
mod random;
#[path = "../common/ring_down.rs"]
mod ring_down;
#[path = "../common/start_values.rs"]
mod start_values;

fn main() {
    let all: [(&str, fn()); 5] = [
        ("grid", of_start_values::print_grid),
        ("losses", of_start_values::print_losses),
        ("decays", of_start_values::print_decays),
        ("ambient", of_ambient::print),
        ("largest", largest::print),
    ];
    let wanted: Vec<String> = std::env::args().skip(1).filter(|word| !word.starts_with('-')).collect();
    for (name, print) in all.iter().filter(|(name, _)| wanted.iter().any(|word| word == name)) {
        println!("== {name}");
        print();
    }
    if wanted.is_empty() {
        println!("one or more of: {}", all.map(|(name, _)| name).join(" "));
    }
}
