//! The screen in words and tables, for screen readers.

use egui::Theme;
use kalmanscope_diagnosis::VerdictKind;

use crate::layout::ViewLayout;
use crate::plot::sheet::{Sheet, SheetColumn};
use crate::plot::time_axis::TimeAxis;
use crate::ruler::Ruler;
use crate::session::Session;
use crate::story::story_of;
use crate::text::{sentence, significant};
use crate::theme::Palette;
use crate::trouble::{FilterTrouble, Gap, troubles};
use crate::view::ViewContext;
use crate::views::view;
use crate::visibility::Visibility;

/// A table has a row at the end of each of this many equal parts of the record.
const PARTS: usize = 10;

const NONE: &str = "–";

const UNKNOWN: &str = "not known yet";

#[derive(Clone, Debug, Default, PartialEq)]
pub struct ScreenText {
    pub parts: Vec<ScreenPart>,
    pub messages: Vec<String>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ScreenPart {
    pub name: String,
    pub about: String,
    pub tables: Vec<ScreenTable>,
}

#[derive(Clone, Debug, PartialEq)]
pub struct ScreenTable {
    pub caption: String,
    pub columns: Vec<String>,
    pub rows: Vec<Vec<String>>,
}

impl ScreenText {
    pub const VERDICTS: &str = "Verdicts";

    pub fn new(
        session: &Session,
        visible: &Visibility,
        axis: &TimeAxis,
        layout: &ViewLayout,
        notice: Option<&str>,
    ) -> Self {
        // Words have no colours.
        let palette = Palette::of(Theme::Light);
        // Marks are no part of a table.
        let ruler = Ruler::default();
        let context = ViewContext::new(session, &palette, visible, axis, &ruler);
        // The run on screen is then that of another scenario, whose place on screen is empty.
        let is_missing = session.missing_record().is_some();
        let views = layout.enlarged().map_or_else(|| layout.in_order(), |view| vec![view]);
        let views = views.into_iter().filter(|_| !is_missing).map(|kind| {
            let view = view(kind);
            let tables: Vec<ScreenTable> = view.sheets(&context).iter().map(|sheet| table(sheet, &context)).collect();
            let [about, ..] = view.help;
            let rest = if tables.is_empty() { " No numbers by time." } else { "" };
            ScreenPart { name: view.name.to_owned(), about: format!("{about}{rest}"), tables }
        });
        let verdicts = (visible.verdicts && !is_missing).then(|| verdicts(&context));
        let troubles = troubles(session).into_iter().map(|FilterTrouble { sentence, .. }| sentence);
        let gaps = Gap::all(session).into_iter().filter(|gap| gap.is_over && !is_missing);
        let gaps = gaps.map(|gap| format!("{}.", sentence(&gap.words())));
        Self {
            parts: std::iter::once(story(session)).chain(verdicts).chain(views).collect(),
            messages: notice.map(str::to_owned).into_iter().chain(troubles).chain(gaps).collect(),
        }
    }

    pub fn news(&self, before: &Self) -> Vec<String> {
        let is_new = |row: &&[String]| row[1] != UNKNOWN && !before.verdicts().any(|old| old[..2] == row[..2]);
        let verdicts = self.verdicts().filter(is_new).filter_map(|row| {
            let kind = VerdictKind::ALL.into_iter().find(|kind| kind.name() == row[1])?;
            Some(format!("{}.", kind.on(&row[0])))
        });
        let messages = self.messages.iter().filter(|message| !before.messages.contains(message)).cloned();
        verdicts.chain(messages).collect()
    }

    fn verdicts(&self) -> impl Iterator<Item = &[String]> {
        let part = self.parts.iter().find(|part| part.name == Self::VERDICTS);
        part.into_iter().flat_map(|part| &part.tables).flat_map(|table| &table.rows).map(Vec::as_slice)
    }
}

fn story(session: &Session) -> ScreenPart {
    ScreenPart { name: "What happens".to_owned(), about: story_of(session).to_string(), tables: Vec::new() }
}

fn verdicts(context: &ViewContext<'_>) -> ScreenPart {
    let row = |(place, estimates): (usize, &kalmanscope_core::Estimates)| {
        let verdict = context.session.diagnosis(place).and_then(|diagnosis| diagnosis.verdict.as_ref());
        let (kind, reason) = verdict.map_or((UNKNOWN, NONE), |verdict| (verdict.kind.name(), verdict.reason.as_str()));
        [estimates.name(), kind, reason].map(str::to_owned).to_vec()
    };
    let table = ScreenTable {
        caption: "Verdicts on the filters".to_owned(),
        columns: ["Filter", "Verdict", "Reason"].map(str::to_owned).to_vec(),
        rows: context.filters().map(row).collect(),
    };
    ScreenPart {
        name: ScreenText::VERDICTS.to_owned(),
        about: "Whether each filter deserves to be believed, and why.".to_owned(),
        tables: vec![table],
    }
}

fn table(sheet: &Sheet<'_>, context: &ViewContext<'_>) -> ScreenTable {
    let Sheet { title, unit, columns } = sheet;
    let ViewContext { session, axis, .. } = *context;
    let record = session.run().record();
    let row = |name: &str, k: usize| {
        let text = |column: &SheetColumn<'_>| {
            let text = column.text(k)?;
            Some(column.aside(k).map_or_else(|| text.clone(), |aside| format!("{text} ({aside})")))
        };
        let texts = columns.iter().map(|column| text(column).unwrap_or_else(|| NONE.to_owned()));
        std::iter::once(format!("{name}{} s", significant(record.time(k), 7))).chain(texts).collect()
    };
    let last = session.run().len().saturating_sub(1);
    let now = if axis.pointed.is_some() { "At the pointer, " } else { "At playback, " };
    let parts = PARTS.min(last.max(1));
    let tenths = (0..=parts).map(|part| row("", part * last / parts));
    ScreenTable {
        caption: if unit.is_empty() { title.clone() } else { format!("{title} [{unit}]") },
        columns: std::iter::once("Time".to_owned()).chain(columns.iter().map(|column| column.owner.clone())).collect(),
        rows: std::iter::once(row(now, axis.readout(session))).chain(tenths).collect(),
    }
}
