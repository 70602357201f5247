//! The story of each built-in scenario: its numbers are those of the run, and no sentence contradicts a verdict.

use kalmanscope_core::setting::Address;
use kalmanscope_core::signal::Step;
use kalmanscope_core::{Channel, Diagnostics, Run, Scenario, Signal};
use kalmanscope_diagnosis::{Diagnosis, Phrase, Story, VerdictKind};
use kalmanscope_lessons::{BUILT_IN, BuiltIn, EQUATIONS, records::source};

/// The stories are read at the ends of this many equal parts of each run.
const GRID: usize = 20;

/// A run of which a part is done, with what the story needs.
struct PartialRun<'a> {
    run: &'a Run,
    diagnostics: Vec<Diagnostics>,
    diagnoses: Vec<Option<Diagnosis>>,
}

fn run_of(scenario: &Scenario) -> Run {
    Run::from_source(scenario, source(scenario).expect("its record is built in")).expect("it can be run")
}

impl<'a> PartialRun<'a> {
    fn at(run: &'a mut Run, share: f64) -> Self {
        run.advance_to((share * run.samples() as f64) as usize);
        let all = run.estimates().iter();
        let diagnostics: Vec<Diagnostics> = all.map(|estimates| Diagnostics::new(estimates, run.record())).collect();
        let diagnoses = diagnostics.iter().zip(run.estimates());
        let diagnoses = diagnoses.map(|(one, estimates)| Diagnosis::new(one, estimates, run.record())).collect();
        Self { run, diagnostics, diagnoses }
    }

    fn story(&self) -> Story {
        let diagnoses: Vec<Option<&Diagnosis>> = self.diagnoses.iter().map(Option::as_ref).collect();
        Story::of(self.run, &self.diagnostics, &diagnoses)
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
                ("band is too narrow", &[VerdictKind::Overconfident]),
                ("band is too wide", &[VerdictKind::Underconfident]),
                ("but inside its ±2σ band", &[VerdictKind::Consistent, VerdictKind::Recovered]),
                ("its band covers it", &[VerdictKind::Consistent, VerdictKind::Recovered]),
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
        let last = story.sentences.last().expect("it has sentences");
        let words: String = last.iter().map(Phrase::to_string).collect();
        let is_of_all = words.starts_with("Trust both") || words.starts_with("Trust all ");
        let is_named =
            |id: u32| last.iter().any(|phrase| matches!(phrase, Phrase::Filter { id: named, .. } if *named == id));
        let advises = words.starts_with("Trust ") && !words.starts_with("Trust n");
        let honest = |kind: VerdictKind| kind.is_good() || kind == VerdictKind::NotIdentifiable;
        let behind_a_band = text.contains("because the import filters them").then_some(VerdictKind::Underconfident);
        for filter in scenario.filters.iter().filter(|filter| advises && (is_of_all || is_named(filter.id))) {
            let kind = self.kind(filter.id);
            if !kind.is_some_and(honest) && (kind.is_none() || kind != behind_a_band) {
                faults.push(format!("{} is {kind:?}, but: {words}", filter.name));
            }
            if let Some(channel) = self.outside(filter.id) {
                faults.push(format!("{} of {} is outside, but: {words}", channel.symbol(), filter.name));
            }
        }
        let kinds: Vec<Option<VerdictKind>> = scenario.filters.iter().map(|filter| self.kind(filter.id)).collect();
        if words.starts_with("Trust n") && kinds.iter().flatten().any(|kind| honest(*kind)) {
            faults.push(format!("{kinds:?}, but: {words}"));
        }
        if advises && self.has_just_changed() {
            faults.push(format!("advice after a change: {words}"));
        }
        faults
    }

    /// The first parameter that a filter estimates with an error outside its band.
    fn outside(&self, id: u32) -> Option<Channel> {
        let place = self.run.scenario().filters.iter().position(|filter| filter.id == id)?;
        let (estimates, diagnostics) = (&self.run.estimates()[place], &self.diagnostics[place]);
        let last = estimates.len().checked_sub(1)?;
        estimates.channels().iter().enumerate().find_map(|(place, channel)| {
            let is_estimated = channel.is_parameter() && estimates.initial_std(place) > 0.0;
            let is_outside = diagnostics.error(*channel)?.abs() > 2.0 * estimates.std(last, place);
            (is_estimated && is_outside).then_some(*channel)
        })
    }

    /// Whether a parameter has changed all at once in the last second.
    fn has_just_changed(&self) -> bool {
        let scenario = self.run.scenario();
        let now = self.run.record().time(self.run.len().saturating_sub(1));
        let mut signals = scenario.plant.parameters().filter_map(|channel| scenario.plant.parameter(channel));
        let is_recent = |step: Step| step.from != step.to && step.at > 0.0 && (step.at..step.at + 1.0).contains(&now);
        signals.any(|signal| matches!(signal, Signal::Step(step) if is_recent(step)))
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
            let mut run = run_of(&scenario);
            let [begun, ended] = [0.1, 1.0].map(|share| PartialRun::at(&mut run, share).story());
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
        let grid: Vec<f64> = (0..=GRID).map(|part| part as f64 / GRID as f64).collect();
        for (seed, shares) in [(1, &grid[..]), (5001, &[0.417]), (5002, &[0.5, 1.0]), (5003, &[1.0])] {
            let mut run = run_of(&Scenario { seed, ..scenario.clone() });
            for share in shares {
                let fault = |fault| format!("{}, seed {seed}, {share}: {fault}", built_in.title);
                faults.extend(PartialRun::at(&mut run, *share).faults().into_iter().map(fault));
            }
        }
    }
    assert!(faults.is_empty(), "{}", faults.join("\n"));
}
