//! The story of each built-in scenario: its numbers are those of the run, and no sentence contradicts a verdict.

use kalmanscope_core::setting::Address;
use kalmanscope_core::{Channel, Diagnosis, Diagnostics, Phrase, Run, Scenario, Story, VerdictKind};
use kalmanscope_lessons::{BUILT_IN, BuiltIn, EQUATIONS, records::source};

/// A run of which a part is done, with what the story needs.
struct Told {
    run: Run,
    diagnostics: Vec<Diagnostics>,
    diagnoses: Vec<Option<Diagnosis>>,
}

impl Told {
    /// The part of a scenario's run before a share of its samples.
    fn new(scenario: &Scenario, share: f64) -> Self {
        let mut run =
            Run::from_source(scenario, source(scenario).expect("its record is built in")).expect("it can be run");
        run.advance_to((share * run.samples() as f64) as usize);
        let all = run.estimates().iter();
        let diagnostics: Vec<Diagnostics> = all.map(|estimates| Diagnostics::new(estimates, run.record())).collect();
        let diagnoses = diagnostics.iter().zip(run.estimates());
        let diagnoses = diagnoses.map(|(one, estimates)| Diagnosis::new(one, estimates, run.record(), None)).collect();
        Self { run, diagnostics, diagnoses }
    }

    fn story(&self) -> Story {
        let diagnoses: Vec<Option<&Diagnosis>> = self.diagnoses.iter().map(Option::as_ref).collect();
        Story::of(&self.run, &self.diagnostics, &diagnoses)
    }

    fn kind(&self, id: u32) -> Option<VerdictKind> {
        let place = self.run.scenario().filters.iter().position(|filter| filter.id == id)?;
        Some(self.diagnoses[place].as_ref()?.verdict.as_ref()?.kind)
    }

    fn faults(&self) -> Vec<String> {
        let (story, scenario) = (self.story(), self.run.scenario());
        let text = story.to_string();
        let mut faults = Vec::new();
        if !text.ends_with('.') || ["NaN", "inf", "  ", " ,", "..", "--"].iter().any(|part| text.contains(part)) {
            faults.push(format!("not a text: {text}"));
        }
        for setting in story.phrases().filter_map(Phrase::setting) {
            match Address::parse(scenario, &setting.address) {
                Ok(address) if (setting.value(setting.shown) - address.get(scenario)).abs() < 1e-9 => {}
                Ok(address) => faults.push(format!("{} is {}", setting.address, address.get(scenario))),
                Err(error) => faults.push(error.to_string()),
            }
        }
        for sentence in &story.sentences {
            let [Phrase::Filter { id, name }, ..] = &sentence[..] else { continue };
            let text: String = sentence.iter().map(Phrase::to_string).collect();
            let kind = self.kind(*id);
            for (words, allowed) in [
                ("does not know it", &[VerdictKind::Overconfident][..]),
                ("more than it knows", &[VerdictKind::Overconfident]),
                ("more than it claims", &[VerdictKind::Underconfident]),
                ("its band says so", &[VerdictKind::Consistent, VerdictKind::Recovered]),
                ("its band is right", &[VerdictKind::Consistent, VerdictKind::Recovered]),
                ("does not determine", &[VerdictKind::NotIdentifiable]),
                ("leaves a pattern", &[VerdictKind::PatternLeft]),
                ("is lost", &[VerdictKind::Lost]),
                ("has lost the truth", &[VerdictKind::Diverged]),
            ] {
                if text.contains(words) && !kind.is_some_and(|kind| allowed.contains(&kind)) {
                    faults.push(format!("{name} is {kind:?}, but: {text}"));
                }
            }
        }
        let last: String = story.sentences.last().expect("it has sentences").iter().map(Phrase::to_string).collect();
        let kinds: Vec<Option<VerdictKind>> = scenario.filters.iter().map(|filter| self.kind(filter.id)).collect();
        let honest = |kind: VerdictKind| kind.is_good() || kind == VerdictKind::NotIdentifiable;
        for filter in &scenario.filters {
            let kind = self.kind(filter.id);
            let believed = last.contains(&format!("Believe {}", filter.name)) || last.starts_with("Both");
            if believed && !kind.is_some_and(honest) {
                faults.push(format!("{} is {kind:?}, but: {last}", filter.name));
            }
        }
        if (last.starts_with("Trust n"))
            && kinds.iter().flatten().any(|k| honest(*k))
            && !text.contains("outside its ±2σ band")
        {
            faults.push(format!("{kinds:?}, but: {last}"));
        }
        faults.extend(self.early(&last));
        faults
    }

    /// Every filter that is believed, though its error is outside its band.
    fn early(&self, last: &str) -> Vec<String> {
        let run = &self.run;
        let believed = |name: &str| last.contains(&format!("Believe {name}")) || last.contains("can be believed");
        let outside = run.estimates().iter().zip(&self.diagnostics).filter(|(estimates, diagnostics)| {
            let channel = Channel::NATURAL_FREQUENCY;
            let (Some(place), Some(error)) = (estimates.place(channel), diagnostics.error(channel)) else {
                return false;
            };
            !estimates.is_empty()
                && estimates.initial_std(place) > 0.0
                && error.abs() > 2.0 * estimates.std(estimates.len() - 1, place)
        });
        let outside: Vec<&str> = outside.map(|(estimates, _)| estimates.name()).collect();
        let is_of_some = last.contains(" of ");
        outside
            .iter()
            .filter(|name| believed(name) && !is_of_some)
            .map(|name| format!("{name} is outside, but: {last}"))
            .collect()
    }
}

fn all() -> impl Iterator<Item = &'static BuiltIn> {
    BUILT_IN.iter().chain(EQUATIONS)
}

#[test]
fn the_stories_of_the_built_in_scenarios_are_these() {
    let text: String = all()
        .map(|built_in| {
            let scenario = built_in.scenario().unwrap();
            let [begun, ended] = [0.1, 1.0].map(|share| Told::new(&scenario, share).story());
            format!("{}\n  at first: {begun}\n  at the end: {ended}\n\n", built_in.title)
        })
        .collect();
    let path = format!("{}/tests/stories.txt", env!("CARGO_MANIFEST_DIR"));
    if std::env::var_os("UPDATE_SNAPSHOTS").is_some() {
        std::fs::write(&path, &text).unwrap();
    }
    let known = std::fs::read_to_string(&path).unwrap_or_default();
    for (line, known) in text.lines().zip(known.lines()) {
        assert_eq!(line, known, "UPDATE_SNAPSHOTS=1 writes tests/stories.txt anew");
    }
    assert_eq!(text.len(), known.len());
}

#[test]
fn stories_agree_with_the_runs_at_every_time_and_with_other_seeds() {
    let mut faults = Vec::new();
    for built_in in all() {
        let scenario = built_in.scenario().unwrap();
        for (seed, share) in [
            (1, 0.0),
            (1, 0.02),
            (1, 0.3),
            (1, 0.4),
            (1, 0.417),
            (1, 0.45),
            (1, 1.0),
            (5001, 0.5),
            (5002, 1.0),
            (5003, 1.0),
        ] {
            let told = Told::new(&Scenario { seed, ..scenario.clone() }, share);
            faults.extend(told.faults().into_iter().map(|fault| format!("{}, seed {seed}: {fault}", built_in.title)));
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
