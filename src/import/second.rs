//! A second file with a clock of its own, joined to the first one.

use std::sync::Arc;

use egui::{DragValue, Ui};
use kalmanscope_core::Task;
use kalmanscope_core::import::{ImportError, Loading, Mapping, OffsetSearch, Table, apart, hash, join, read};

use crate::session::RecordFile;
use crate::text::sentence;
use crate::theme::Palette;

/// Two files, and the offset that is added to the times of the second one.
pub(super) struct Second {
    names: [String; 2],
    /// Both tables, with empty cells where there is no reading.
    tables: [Table; 2],
    /// \[s\]
    offset: f64,
    /// A sentence on the offset: how it was found, or why it was not.
    said: String,
    is_found: bool,
}

/// Both files as one: its contents, and how it is read.
pub(super) type Both = (Vec<u8>, RecordFile);

/// Reads the second file, then searches the offset.
pub(super) struct Joining {
    first: Arc<RecordFile>,
    name: String,
    stage: Stage,
}

enum Stage {
    Reading(Box<Loading>),
    Searching(Box<[Table; 2]>, Box<OffsetSearch>),
    Failed(ImportError),
}

/// The share of the reading in the progress.
const READING: f64 = 0.3;

impl Joining {
    pub(super) fn new(first: Arc<RecordFile>, name: &str, bytes: Vec<u8>) -> Self {
        Self { first, name: name.to_owned(), stage: Stage::Reading(Box::new(Loading::new(bytes))) }
    }

    /// The search of a file that has been read.
    fn search(&self, loading: Loading) -> Result<Stage, ImportError> {
        let tables = [&self.first.table, &loading.finish()?.table].map(|table| table.with_gaps(None));
        let search = OffsetSearch::new(tables.each_ref(), |both| Mapping::guess(both).0)?;
        Ok(Stage::Searching(Box::new(tables), Box::new(search)))
    }
}

impl Task for Joining {
    /// A sentence: why the second file cannot be read, or has no usable times.
    type Outcome = Result<Second, String>;

    fn progress(&self) -> f64 {
        match &self.stage {
            Stage::Reading(loading) => READING * loading.progress(),
            Stage::Searching(_, search) => READING + (1.0 - READING) * search.progress(),
            Stage::Failed(_) => 1.0,
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        if let Stage::Reading(loading) = &mut self.stage {
            if !loading.advance(while_time) {
                return false;
            }
            let Stage::Reading(loading) = std::mem::replace(&mut self.stage, Stage::Failed(ImportError::Empty)) else {
                return true;
            };
            self.stage = self.search(*loading).unwrap_or_else(Stage::Failed);
        }
        if let Stage::Searching(_, search) = &mut self.stage { search.advance(while_time) } else { true }
    }

    /// Where no offset is found, both begin at the same time.
    fn finish(mut self) -> Self::Outcome {
        while !self.advance(&mut || true) {}
        let Self { first, name, stage } = self;
        let refused = |reason: ImportError| format!("“{name}” cannot be joined: {reason}");
        let (tables, search) = match stage {
            Stage::Searching(tables, search) => (*tables, *search),
            Stage::Failed(reason) => return Err(refused(reason)),
            Stage::Reading(_) => return Err(refused(ImportError::Empty)),
        };
        let (offset, said, is_found) = match search.finish() {
            Ok(agreement) => (agreement.offset.seconds, agreement.to_string(), true),
            Err(reason) => {
                let begins = apart(tables.each_ref()).map_err(refused)?;
                (begins, format!("both begin at the same time now: {reason}"), false)
            }
        };
        let names = [first.name.clone(), name];
        Ok(Second { names, tables, offset, said, is_found })
    }
}

impl Second {
    /// Both files as one.
    ///
    /// # Errors
    /// The reason why they cannot be joined.
    pub(super) fn both(&self) -> Result<Both, ImportError> {
        let Self { names, tables: [first, second], offset, .. } = self;
        let table = join(first, second, *offset)?;
        let remarks = table.remarks.clone();
        let bytes = table.csv().into_bytes();
        let mut table = read(bytes.clone(), None)?;
        table.remarks.splice(0..0, remarks);
        let [first, second] = names.each_ref().map(|name| name.rsplit_once('.').map_or(&**name, |(stem, _)| stem));
        let name = format!("{first} and {second}.csv");
        let hash = hash(&bytes);
        Ok((bytes, RecordFile { name, hash, table }))
    }

    /// Shows the offset. Returns whether the user has set another one.
    pub(super) fn ui(&mut self, ui: &mut Ui, palette: &Palette) -> bool {
        let Self { names: [_, name], offset, said, is_found, .. } = self;
        let color = if *is_found { palette.text } else { palette.warning };
        ui.colored_label(color, format!("{}.", sentence(said)));
        ui.horizontal_wrapped(|ui| {
            let field = DragValue::new(offset).speed(0.01).max_decimals(6).update_while_editing(false);
            let field = ui.add(field).on_hover_text("The offset between the clocks of both files");
            field.ctx.accesskit_node_builder(field.id, |node| node.set_label("Offset of the second file"));
            ui.label(format!("added to the times of “{name}” [s]"));
            if field.changed() {
                (*said, *is_found) = ("the offset is as stated".to_owned(), true);
            }
            // While it is dragged, nothing is joined: that takes long with large files.
            field.drag_stopped() || (field.changed() && !field.dragged())
        })
        .inner
    }
}
