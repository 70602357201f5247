//! A second file with a clock of its own, joined to the first one.

use std::sync::Arc;

use egui::{DragValue, Ui};
use kalmanscope_core::Task;
use kalmanscope_core::import::{ImportError, Loaded, Loading, Mapping, OffsetSearch, Table, apart, join};

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

/// Files of more rows are joined beside the frames.
const LONG_ROWS: usize = 20_000;

/// Both files as one: its contents, and how it is read.
pub(super) type Both = (Vec<u8>, RecordFile);

/// Reads the second file, searches the offset, and joins both.
pub(super) struct Joining {
    first: Arc<RecordFile>,
    name: String,
    stage: Stage,
}

enum Stage {
    Reading(Box<Loading>),
    Searching(Box<[Table; 2]>, Box<OffsetSearch>),
    /// Both as one table, and the text of its first rows.
    Writing(Box<Second>, Box<Table>, String, usize),
    /// The text of both is read as any file is.
    Checking(Box<Second>, Vec<String>, Vec<u8>, Box<Loading>),
    Apart(Box<Second>, ImportError),
    /// A sentence: why the second file cannot be read, or has no usable times.
    Failed(String),
}

/// The share of reading, searching and writing in the progress.
const READING: f64 = 0.2;
const SEARCHING: f64 = 0.5;
const WRITING: f64 = 0.1;

/// The rows that are written between two looks at the time.
const ROWS: usize = 2_000;

impl Joining {
    pub(super) fn new(first: Arc<RecordFile>, name: &str, bytes: Vec<u8>) -> Self {
        Self { first, name: name.to_owned(), stage: Stage::Reading(Box::new(Loading::new(bytes))) }
    }

    /// Joins two files again, with another offset.
    pub(super) fn again(first: Arc<RecordFile>, second: Second) -> Self {
        Self { first, name: second.names[1].clone(), stage: write(second) }
    }

    /// The search of a file that has been read.
    fn search(&self, loading: Loading) -> Result<Stage, ImportError> {
        let tables = [&self.first.table, &loading.finish()?.table].map(|table| table.with_gaps(None));
        let search = OffsetSearch::new(tables.each_ref(), |both| Mapping::guess(both).0)?;
        Ok(Stage::Searching(Box::new(tables), Box::new(search)))
    }

    /// The offset of a search that is done. Where none is found, both begin at the same time.
    fn second(&self, tables: [Table; 2], search: OffsetSearch) -> Result<Second, ImportError> {
        let (offset, said, is_found) = match search.finish() {
            Ok(agreement) => (agreement.offset.seconds, agreement.to_string(), true),
            Err(reason) => {
                let begins = apart(tables.each_ref())?;
                (begins, format!("both begin at the same time now: {reason}"), false)
            }
        };
        let names = [self.first.name.clone(), self.name.clone()];
        Ok(Second { names, tables, offset, said, is_found })
    }

    /// The next stage, if this one is done; else it goes on.
    fn next(&self, stage: Stage, while_time: &mut dyn FnMut() -> bool) -> (Stage, bool) {
        let refused = |reason: ImportError| Stage::Failed(format!("“{}” cannot be joined: {reason}", self.name));
        let next = match stage {
            Stage::Reading(mut loading) => {
                if !loading.advance(while_time) {
                    return (Stage::Reading(loading), false);
                }
                self.search(*loading).unwrap_or_else(refused)
            }
            Stage::Searching(tables, mut search) => {
                if !search.advance(while_time) {
                    return (Stage::Searching(tables, search), false);
                }
                self.second(*tables, *search).map_or_else(refused, write)
            }
            Stage::Writing(second, table, mut text, mut row) => {
                while row < table.rows() {
                    let end = (row + ROWS).min(table.rows());
                    table.csv_rows(row..end, &mut text);
                    row = end;
                    if !while_time() {
                        return (Stage::Writing(second, table, text, row), false);
                    }
                }
                let bytes = text.into_bytes();
                let loading = Box::new(Loading::new(bytes.clone()));
                Stage::Checking(second, table.remarks, bytes, loading)
            }
            Stage::Checking(second, remarks, bytes, mut loading) => {
                let is_done = loading.advance(while_time);
                return (Stage::Checking(second, remarks, bytes, loading), is_done);
            }
            ended @ (Stage::Apart(..) | Stage::Failed(_)) => return (ended, true),
        };
        (next, false)
    }
}

/// Both files as one table, to be written.
fn write(second: Second) -> Stage {
    let [first, other] = &second.tables;
    match join(first, other, second.offset) {
        Ok(table) => {
            let header = table.csv_header();
            Stage::Writing(Box::new(second), Box::new(table), header, 0)
        }
        Err(reason) => Stage::Apart(Box::new(second), reason),
    }
}

impl Task for Joining {
    /// The files and their offset, with both as one, or the reason why they cannot be joined. A sentence: why the second file cannot
    /// be read, or has no usable times.
    type Outcome = Result<(Second, Result<Both, ImportError>), String>;

    fn progress(&self) -> f64 {
        match &self.stage {
            Stage::Reading(loading) => READING * loading.progress(),
            Stage::Searching(_, search) => READING + SEARCHING * search.progress(),
            Stage::Writing(_, table, _, row) => {
                READING + SEARCHING + WRITING * *row as f64 / table.rows().max(1) as f64
            }
            Stage::Checking(_, _, _, loading) => {
                let before = READING + SEARCHING + WRITING;
                before + (1.0 - before) * loading.progress()
            }
            Stage::Apart(..) | Stage::Failed(_) => 1.0,
        }
    }

    fn advance(&mut self, while_time: &mut dyn FnMut() -> bool) -> bool {
        loop {
            let stage = std::mem::replace(&mut self.stage, Stage::Failed(String::new()));
            let (stage, is_done) = self.next(stage, while_time);
            self.stage = stage;
            if is_done || !while_time() {
                return is_done;
            }
        }
    }

    fn finish(mut self) -> Self::Outcome {
        while !self.advance(&mut || true) {}
        match self.stage {
            Stage::Checking(second, remarks, bytes, loading) => {
                let both = loading.finish().map(|Loaded { hash, mut table }| {
                    table.remarks.splice(0..0, remarks);
                    (bytes, RecordFile { name: second.name(), hash, table })
                });
                Ok((*second, both))
            }
            Stage::Apart(second, reason) => Ok((*second, Err(reason))),
            Stage::Failed(reason) => Err(reason),
            Stage::Reading(_) | Stage::Searching(..) | Stage::Writing(..) => Err(String::new()),
        }
    }
}

impl Second {
    /// The name of both files as one.
    fn name(&self) -> String {
        let [first, second] = self.names.each_ref().map(|name| name.rsplit_once('.').map_or(&**name, |(stem, _)| stem));
        format!("{first} and {second}.csv")
    }

    /// Whether it takes long to join them.
    pub(super) fn is_long(&self) -> bool {
        self.tables.iter().any(|table| table.rows() > LONG_ROWS)
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

#[cfg(test)]
mod tests {
    use kalmanscope_core::import::{hash, read};

    use super::*;

    /// A file with a wave; `rate` is the number of readings in a second.
    fn file(name: &str, rate: f64, rows: usize, column: &str) -> (RecordFile, Vec<u8>) {
        let row = |k: usize| {
            let time = k as f64 / rate;
            format!("{time:.4},{:.6}\n", (2.0 * time).sin() + (0.37 * time * time).sin())
        };
        let bytes = (format!("t [s],{column}\n") + &(0..rows).map(row).collect::<String>()).into_bytes();
        let table = read(bytes.clone(), None).unwrap();
        (RecordFile { name: name.to_owned(), hash: hash(&bytes), table }, bytes)
    }

    #[test]
    fn long_files_are_joined_in_pieces() {
        let (first, _) = file("force.csv", 100.0, 12_000, "force");
        let (_, bytes) = file("camera.csv", 150.0, 18_000, "displacement");
        let mut joining = Joining::new(Arc::new(first), "camera.csv", bytes);
        let (mut pieces, mut share) = (0, 0.0);
        while !joining.advance(&mut || false) {
            pieces += 1;
            assert!(joining.progress() >= share && joining.progress() <= 1.0, "{share}");
            share = joining.progress();
        }
        assert!(pieces > 18_000 / ROWS, "{pieces}");
        let (second, both) = joining.finish().unwrap();
        let (bytes, file) = both.unwrap();
        let whole = join(&second.tables[0], &second.tables[1], second.offset).unwrap();
        assert_eq!(bytes, whole.csv().into_bytes());
        assert_eq!(
            (file.name.as_str(), file.table.rows(), &file.hash),
            ("force and camera.csv", 18_000, &hash(&bytes))
        );
        assert!(
            file.table.remarks.iter().any(|remark| remark.contains("each keeps its times")),
            "{:?}",
            file.table.remarks
        );
        // Another offset joins them again; one without common time is refused.
        let again = |offset: f64| {
            let second = Second {
                tables: second.tables.clone(),
                names: second.names.clone(),
                said: String::new(),
                offset,
                is_found: true,
            };
            Joining::again(Arc::new(RecordFile { table: file.table.clone(), ..file.clone() }), second).finish().unwrap()
        };
        assert_eq!(again(second.offset).1.unwrap().0, bytes);
        assert!(matches!(again(1e6).1, Err(ImportError::Apart { .. })));
    }
}
