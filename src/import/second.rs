//! A second file with a clock of its own, joined to the first one.

use std::sync::Arc;

use egui::{DragValue, Ui};
use kalmanscope_core::import::{Agreement, ImportError, Joined, Mapping, Table, apart, hash, join, read};

use crate::session::RecordFile;
use crate::text::sentence;
use crate::theme::Palette;

/// Two files, and what is added to the times of the second one.
pub(super) struct Second {
    first: Arc<RecordFile>,
    name: String,
    table: Table,
    /// \[s\]
    offset: f64,
    /// What is said about the offset: how it was found, or why not.
    said: String,
    is_found: bool,
}

/// Both files as one: its contents, and how it is read.
pub(super) type Both = (Vec<u8>, RecordFile);

impl Second {
    /// Two files, with the offset with which both agree best. Where none is found, they begin at the same time.
    ///
    /// # Errors
    /// The reason why the second file cannot be read, or has no usable times.
    pub(super) fn new(first: Arc<RecordFile>, name: String, bytes: Vec<u8>) -> Result<Self, ImportError> {
        let table = read(bytes, None)?.with_gaps(None);
        let begins = apart([&first.table, &table])?;
        let gaps = first.table.with_gaps(None);
        let found = Agreement::of([&gaps, &table], |both| Mapping::guess(both).0);
        let (offset, said, is_found) = match found {
            Ok(agreement) => (agreement.offset.seconds, agreement.to_string(), true),
            Err(reason) => (begins, format!("both begin at the same time now: {reason}"), false),
        };
        Ok(Self { first, name, table, offset, said, is_found })
    }

    /// Both files as one.
    ///
    /// # Errors
    /// The reason why they cannot be joined.
    pub(super) fn both(&self) -> Result<Both, ImportError> {
        let Self { first, name, table, offset, .. } = self;
        let Joined { table, .. } = join(&first.table.with_gaps(None), table, *offset)?;
        let remarks = table.remarks.clone();
        let bytes = table.csv().into_bytes();
        let mut table = read(bytes.clone(), None)?;
        table.remarks.splice(0..0, remarks);
        let stem = |name: &str| name.rsplit_once('.').map_or(name, |(stem, _)| stem).to_owned();
        let name = format!("{} and {}.csv", stem(&first.name), stem(name));
        let hash = hash(&bytes);
        Ok((bytes, RecordFile { name, hash, table }))
    }

    /// Shows the offset. Returns whether the user has changed it.
    pub(super) fn ui(&mut self, ui: &mut Ui, palette: &Palette) -> bool {
        let Self { name, offset, said, is_found, .. } = self;
        let color = if *is_found { palette.text } else { palette.warning };
        ui.colored_label(color, format!("{}.", sentence(said)));
        ui.horizontal_wrapped(|ui| {
            let text = format!("added to the times of “{name}” [s]");
            let field = DragValue::new(offset).speed(0.01).max_decimals(6).update_while_editing(false);
            let field = ui.add(field).on_hover_text("The offset between the clocks of both files");
            field.ctx.accesskit_node_builder(field.id, |node| node.set_label(text.clone()));
            ui.label(text);
            let changed = field.changed() && offset.is_finite();
            if changed {
                (*said, *is_found) = ("the offset is as stated".to_owned(), true);
            }
            changed
        })
        .inner
    }
}
