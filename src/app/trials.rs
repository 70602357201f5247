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
        let all = match links().count() {
            0 => "There is no link in this text".to_owned(),
            1 => format!("1 link: {added} new trials"),
            several => format!("{several} links: {added} new trials"),
        };
        let remarks = [
            (count - added, "were there already, or had no room"),
            (without, "links have no trial: they were copied while Your own oscillator was not on screen"),
            (damaged, "links are damaged"),
        ];
        let remarks = remarks.iter().filter(|(count, _)| *count > 0);
        let said: String = remarks.map(|(count, words)| format!("; {count} {words}")).collect();
        let sentence = format!("{all}{said}.");
        self.notice = Some(if added > 0 { Notice::done(&sentence) } else { sentence.into() });
        self.layout.show(ViewKind::Trials);
    }
}
