//! Trials from the links of a class.

use kalmanscope_lab::Trial;

use super::App;
use crate::notice::Notice;
use crate::request::ViewKind;
use crate::share::{MARK, Picture};

impl App {
    /// Adds the trials of all links in a text, and says what came of it.
    pub(super) fn collect_trials(&mut self, text: &str) {
        let links = || text.split_whitespace().filter_map(|word| word.split_once(MARK));
        let pictures: Vec<Option<Picture>> = links().map(|(_, link)| Picture::read(link).ok()).collect();
        let damaged = pictures.iter().filter(|picture| picture.is_none()).count();
        let told: Vec<Vec<Trial>> = pictures.into_iter().flatten().map(|picture| picture.laboratory.trials).collect();
        let without = told.iter().filter(|trials| trials.is_empty()).count();
        let trials: Vec<Trial> = told.into_iter().flatten().collect();
        let count = trials.len();
        let added = self.laboratory.trials_mut().add(trials);
        let counts = [
            (links().count(), "Links"),
            (added, "new trials"),
            (count - added, "there already, or without room"),
            (without, "links that were copied while Your own oscillator was not on screen"),
            (damaged, "damaged links"),
        ];
        // The first two are told even if there are none.
        let told = counts.iter().enumerate().filter(|(place, (count, _))| *place < 2 || *count > 0);
        let told: Vec<String> = told.map(|(_, (count, words))| format!("{words}: {count}")).collect();
        let sentence = told.join(", ") + ".";
        self.notice = Some(if added > 0 { Notice::done(&sentence) } else { sentence.into() });
        self.layout.show(ViewKind::Trials);
    }
}
