//! Sentences about all trials together.

use egui::{Label, RichText, Ui};
use kalmanscope_core::Story;
use kalmanscope_lab::{Estimated, Spread, Spring, Trial};

use crate::text::significant;

/// Points lie far from a line, and trials differ more than their bands, from this multiple on. Less is chance, and said from the
/// second multiple on.
const FAR: f64 = 2.0;
const SOME: f64 = 1.1;

/// Shows the sentences above the picture.
pub(super) fn sentence_ui(ui: &mut Ui, rows: &[Trial]) {
    ui.add(Label::new(RichText::new(sentences(rows).join(" "))).wrap());
}

/// The sentences on some trials.
pub(super) fn sentences(rows: &[Trial]) -> Vec<String> {
    let mut said = if is_weighed(rows) { of_spring(rows) } else { of_spread(rows) };
    let doubtful = rows.iter().filter(|trial| !trial.is_believed).count();
    if doubtful > 0 {
        let of = if doubtful == 1 { "1 trial".to_owned() } else { format!("{doubtful} trials") };
        said.push(format!("The verdict on {of} was bad: those bands may be too narrow."));
    }
    said
}

/// Whether masses were added that differ, so that a line tells the stiffness.
pub(super) fn is_weighed(rows: &[Trial]) -> bool {
    rows.iter().any(|trial| trial.mass != rows[0].mass)
}

fn of_spring(rows: &[Trial]) -> Vec<String> {
    let Some(spring) = Spring::of(rows) else {
        return vec!["The period does not grow with the mass: no spring does that. Are the masses right?".to_owned()];
    };
    let stiffness = Story::estimate(spring.stiffness.mean, spring.stiffness.band(), "N/m");
    let own = spring.own_mass.times(1000.0);
    let own = Story::estimate(own.mean, own.band(), "g");
    let mut said = vec![format!("k = {stiffness}, and m₀ = {own} swing beside the added mass.")];
    if spring.freedom == 0 {
        said.push("Two points always lie on a line: a third mass tests it.".to_owned());
    } else if spring.excess() > FAR {
        said.push(format!(
            "The points lie {} times as far from the line as their bands allow, so these bands are that much wider: masses, or \
             the oscillator, were not as thought.",
            significant(spring.excess(), 2)
        ));
    } else if spring.excess() > SOME {
        said.push(format!(
            "The points lie {} times as far from the line as their bands allow, which may be chance; these bands are that much wider.",
            significant(spring.excess(), 2)
        ));
    } else {
        said.push("The points lie on the line, as far as their bands can tell.".to_owned());
    }
    if spring.own_mass.mean + spring.own_mass.band() < 0.0 {
        said.push("A mass below 0 is impossible: are the added masses in grams?".to_owned());
    }
    said
}

fn of_spread(rows: &[Trial]) -> Vec<String> {
    let numbers = |of: &dyn Fn(&Trial) -> Estimated| Spread::of(&rows.iter().map(of).collect::<Vec<_>>());
    let Some((frequency, damping)) = numbers(&Trial::hertz).zip(numbers(&|trial| trial.damping.times(100.0))) else {
        return vec![
            "One trial. Add another one: the same again shows how well it repeats, another mass tells the stiffness."
                .to_owned(),
        ];
    };
    let range = |spread: &Spread| spread.ends.map(|end| significant(end, 3)).join(" to ");
    let mut said = vec![format!("{} trials: {} Hz, ζ {} %.", frequency.count, range(&frequency), range(&damping))];
    let more = frequency.among / frequency.own;
    said.push(if more > FAR {
        format!(
            "The frequencies differ {} times as much as their bands say: a band tells what a filter knows of one oscillator, not \
             how alike oscillators are.",
            significant(more, 2)
        )
    } else {
        "The frequencies differ no more than their bands say.".to_owned()
    });
    said
}

#[cfg(test)]
mod tests {
    use super::*;

    fn trial(grams: f64, frequency: f64, std: f64) -> Trial {
        let of = |mean: f64, std: f64| Estimated { mean, std };
        Trial {
            name: String::new(),
            mass: grams / 1000.0,
            frequency: of(frequency, std),
            damping: of(0.01, 0.001),
            is_believed: true,
        }
    }

    fn told(rows: &[Trial]) -> String {
        sentences(rows).join(" ")
    }

    #[test]
    fn one_trial_asks_for_another() {
        assert!(told(&[trial(0.0, 6.0, 0.01)]).starts_with("One trial."));
    }

    #[test]
    fn a_spring_is_told_with_its_bands() {
        let at = |grams: f64| trial(grams, f64::sqrt(24.0 / (0.2 + grams / 1000.0)), 0.01);
        let two = told(&[at(0.0), at(100.0)]);
        assert!(two.starts_with("k = 24.0") && two.contains("m₀ = 200") && two.contains("a third mass"), "{two}");
        let three = told(&[at(0.0), at(100.0), at(200.0)]);
        assert!(three.contains("The points lie on the line"), "{three}");
        let off = told(&[at(0.0), trial(100.0, 8.2, 0.01), at(200.0)]);
        assert!(off.contains("times as far from the line"), "{off}");
        let falling = told(&[trial(0.0, 6.0, 0.01), trial(100.0, 7.0, 0.01)]);
        assert!(falling.starts_with("The period does not grow"), "{falling}");
    }

    #[test]
    fn trials_of_one_mass_are_compared_with_their_bands() {
        let alike = told(&[trial(0.0, 6.0, 0.05), trial(0.0, 6.04, 0.05), trial(0.0, 5.97, 0.05)]);
        assert!(alike.starts_with("3 trials: 0.95 to 0.961 Hz") && alike.contains("no more than"), "{alike}");
        let mut class = [trial(0.0, 6.0, 0.05), trial(0.0, 7.0, 0.05), trial(0.0, 5.0, 0.05)];
        class[1].is_believed = false;
        let class = told(&class);
        assert!(
            class.contains("differ 20 times as much") && class.contains("The verdict on 1 trial was bad"),
            "{class}"
        );
    }
}
