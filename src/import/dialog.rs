//! The window of an import.

use egui::{Align2, Button, Context, Grid, Key, Popup, ProgressBar, RichText, ScrollArea, Ui, Vec2, Window};

use kalmanscope_core::free_decay::{Decay, NoDecay};
use kalmanscope_core::import::{Imported, Table, ThreeAxes};

use super::columns::{columns_ui, conditioning_ui, meaning_ui};
use super::{Draft, Import, ImportStage, Opened};
use crate::probe::Remembered as _;
use crate::request::{RawFile, Request};
use crate::text::{grouped, sentence};
use crate::theme::{self, Palette};
use crate::widgets::{named, primary};

/// The width of the window, folded and unfolded, if there is room \[points\].
const WIDTHS: [f32; 2] = [540.0, 940.0];

const AROUND: f32 = 170.0;

enum DialogChoice {
    Open,
    HoldOut,
    Cancel,
    Decay(Result<String, NoDecay>),
}

impl Import {
    pub(crate) fn ui(
        &mut self,
        ctx: &Context,
        palette: &Palette,
        can_hold_out: bool,
        requests: &mut Vec<Request>,
    ) -> Option<Opened> {
        let size = ctx.content_rect().size();
        let window = Window::new("Open a measured record").collapsible(false).resizable(false);
        let is_unfolded = matches!(&self.stage, ImportStage::Asking(draft) if draft.is_unfolded);
        let width = (size.x - 40.0).min(WIDTHS[usize::from(is_unfolded)]);
        let window = window.anchor(Align2::CENTER_CENTER, Vec2::ZERO);
        let choice = window.show(ctx, |ui| {
            ui.set_width(width);
            self.stage_ui(ui, palette, can_hold_out, size.y - AROUND)
        });
        let choice = choice.and_then(|shown| shown.inner).flatten().or_else(|| self.pressed(ctx));
        match choice? {
            DialogChoice::Cancel => requests.push(Request::CancelImport),
            DialogChoice::Decay(Ok(csv)) => {
                let name = format!("{}, free decay.csv", self.name.trim_end_matches(".csv"));
                let file = RawFile { name, bytes: csv.into_bytes(), is_measured: false };
                requests.push(Request::ImportFile(Box::new(file)));
            }
            DialogChoice::Decay(Err(reason)) => self.stage = ImportStage::Failed(reason.to_string()),
            DialogChoice::HoldOut => requests.push(Request::HoldOut),
            DialogChoice::Open => return self.open(),
        }
        None
    }

    fn pressed(&self, ctx: &Context) -> Option<DialogChoice> {
        if ctx.text_edit_focused() || Popup::is_any_open(ctx) {
            return None;
        }
        // Enter presses the button that has the focus, such as Cancel.
        let has_focus = ctx.memory(|memory| memory.focused().is_some());
        let [escape, enter] = ctx.input(|input| [Key::Escape, Key::Enter].map(|key| input.key_pressed(key)));
        match (escape, enter && !has_focus) {
            (true, _) => Some(DialogChoice::Cancel),
            (false, true) => Some(DialogChoice::Open),
            (false, false) => None,
        }
    }

    fn stage_ui(&mut self, ui: &mut Ui, palette: &Palette, can_hold_out: bool, height: f32) -> Option<DialogChoice> {
        let Self { name, stage, at_once, is_still, .. } = self;
        match stage {
            ImportStage::Reading(reading) => {
                ui.label(format!("Reading “{name}”"));
                progress_ui(ui, palette, reading.seen, *is_still)
            }
            ImportStage::Suggesting(_, suggest) => {
                ui.label(format!("Making start values from “{name}”"));
                progress_ui(ui, palette, suggest.seen, *is_still)
            }
            ImportStage::Failed(reason) => {
                ui.colored_label(palette.warning, format!("“{name}” cannot be opened: {reason}."));
                button_ui(ui, Button::new("Close"), "Close", true).then_some(DialogChoice::Cancel)
            }
            ImportStage::Asking(_) if *at_once => {
                ui.label(format!("Reading “{name}”"));
                None
            }
            ImportStage::Asking(draft) => draft.ui(ui, palette, can_hold_out, height),
        }
    }
}

fn progress_ui(ui: &mut Ui, palette: &Palette, share: f64, is_still: bool) -> Option<DialogChoice> {
    ui.add(ProgressBar::new(share as f32).show_percentage());
    if is_still {
        ui.colored_label(palette.warning, "It has made no progress for 10 s. Esc stops it.");
    }
    button_ui(ui, Button::new("Cancel"), "Cancel the import", true).then_some(DialogChoice::Cancel)
}

fn button_ui(ui: &mut Ui, button: Button<'_>, name: &str, enabled: bool) -> bool {
    let button = named(ui.add_enabled(enabled, button), name).remembered(name);
    button.clicked()
}

fn decay_ui(ui: &mut Ui, table: &Table) -> Option<DialogChoice> {
    const NAME: &str = "Take its free decay";
    let axes = ThreeAxes::of(table)?;
    let is_taken = button_ui(ui, Button::new(NAME), NAME, true);
    ui.weak("Along the axis that moves most, without gravity, from when the hand is gone until it rests.");
    is_taken.then(|| DialogChoice::Decay(Decay::alike(&axes.readings(table)).map(|decays| Decay::file(&decays))))
}

impl Draft {
    fn ui(&mut self, ui: &mut Ui, palette: &Palette, can_hold_out: bool, height: f32) -> Option<DialogChoice> {
        let scroll = ScrollArea::vertical().max_height(height).auto_shrink([false, true]);
        let decay = scroll.show(ui, |ui| self.contents_ui(ui, palette)).inner;
        ui.separator();
        let buttons = ui.horizontal_wrapped(|ui| {
            let open = button_ui(ui, primary("Open the record", palette), "Open the record", self.is_possible());
            let hint = "The free run of the models on screen over this record, which the filters do not see";
            let tests =
                can_hold_out && self.base.is_none() && ui.button("Test the models on it").on_hover_text(hint).clicked();
            let cancel = button_ui(ui, Button::new("Cancel"), "Cancel the import", true);
            match (open, tests, cancel) {
                (true, ..) => Some(DialogChoice::Open),
                (_, true, _) => Some(DialogChoice::HoldOut),
                (.., true) => Some(DialogChoice::Cancel),
                _ => None,
            }
        });
        decay.or(buttons.inner)
    }

    fn contents_ui(&mut self, ui: &mut Ui, palette: &Palette) -> Option<DialogChoice> {
        let file = std::sync::Arc::clone(&self.file);
        ui.label(RichText::new(&file.name).family(theme::strong()).size(15.0));
        match self.outcome() {
            None => _ = ui.label("Making the record…"),
            Some(Ok(imported)) => self.found_ui(ui, imported, palette),
            Some(Err(reason)) => _ = ui.colored_label(palette.warning, reason),
        }
        for doubt in self.doubts() {
            ui.colored_label(palette.warning, doubt);
        }
        let decay = decay_ui(ui, &file.table);
        ui.add_space(4.0);
        let mark = if self.is_unfolded { "▾" } else { "▸" };
        let unfold = Button::new(format!("{mark} Columns…")).frame(false);
        self.is_unfolded ^= named(ui.add(unfold), "Columns…").clicked();
        if self.is_unfolded {
            ui.weak(format!(
                "{} rows, {} columns; {}",
                grouped(file.table.rows()),
                file.table.columns.len(),
                file.table.form
            ));
            columns_ui(ui, self, palette);
            ui.add_space(6.0);
            meaning_ui(ui, self);
            conditioning_ui(ui, self);
            ui.checkbox(&mut self.suggest, "estimate noise and starting guess from the data")
                .on_hover_text("From spectra and from the likelihood; every number can be changed afterwards");
        }
        decay
    }

    fn found_ui(&self, ui: &mut Ui, made: &Imported, palette: &Palette) {
        ui.label(Self::extent(made));
        if let Some(remark) = &self.remark {
            ui.label(format!("{}.", sentence(remark)));
        }
        Grid::new("recognised").num_columns(2).spacing([12.0, 2.0]).show(ui, |ui| {
            for (place, column) in self.file.table.columns.iter().enumerate() {
                let Some(meaning) = self.meaning(place) else { continue };
                self.sparks[place].ui(ui, palette.truth);
                ui.vertical(|ui| {
                    ui.strong(&column.name);
                    ui.label(meaning);
                });
                ui.end_row();
            }
        });
        for left_out in self.left_out(made) {
            ui.label(left_out);
        }
        for remark in &made.remarks {
            ui.weak(format!("{}.", sentence(remark)));
        }
        if self.suggest {
            ui.weak("Start values are made from the data. A mean that is no motion is removed.");
        }
    }
}
