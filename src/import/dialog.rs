//! The window of an import.

use egui::{Align2, Button, Context, Key, Popup, ProgressBar, ScrollArea, Ui, Vec2, Window};

use kalmanscope_core::free_decay::{Decay, NoDecay};
use kalmanscope_core::import::{Table, ThreeAxes};

use super::columns::columns_ui;
use super::columns::{conditioning_ui, meaning_ui};
use super::{Draft, Import, Opened, Stage};
use crate::probe;
use crate::request::{RawFile, Request};
use crate::text::{sentence, significant};
use crate::theme::Palette;

enum Choice {
    Open,
    HoldOut,
    Cancel,
    /// Continue with the free decay in the file, as its own file.
    Decay(Result<String, NoDecay>),
}

impl Import {
    /// Shows the window. Returns the outcome if the record is opened at once. `can_hold_out` is true if there are
    /// models from another record to test.
    pub(crate) fn ui(
        &mut self,
        ctx: &Context,
        palette: &Palette,
        can_hold_out: bool,
        requests: &mut Vec<Request>,
    ) -> Option<Opened> {
        let size = ctx.content_rect().size();
        let window = Window::new("Open a measured record").collapsible(false).resizable(false);
        let width = (size.x - 40.0).min(940.0);
        let window = window.anchor(Align2::CENTER_CENTER, Vec2::ZERO).fixed_size([width, size.y - 120.0]);
        let choice = window.show(ctx, |ui| {
            ScrollArea::vertical()
                .max_height(size.y - 120.0)
                .show(ui, |ui| self.stage_ui(ui, palette, can_hold_out))
                .inner
        });
        let choice = choice.and_then(|shown| shown.inner).flatten().or_else(|| self.pressed(ctx));
        match choice? {
            Choice::Cancel => requests.push(Request::CancelImport),
            Choice::Decay(Ok(csv)) => {
                let name = format!("{}, free decay.csv", self.name.trim_end_matches(".csv"));
                requests.push(Request::ImportFile(Box::new(RawFile { name, bytes: csv.into_bytes() })));
            }
            Choice::Decay(Err(reason)) => self.stage = Stage::Failed(reason.to_string()),
            Choice::HoldOut => requests.push(Request::HoldOut),
            Choice::Open => {
                let Stage::Asking(draft) = &mut self.stage else { return None };
                let scenario = draft.scenario()?;
                let record = draft.outcome()?.ok()?.record.clone();
                return self.accept(record, scenario);
            }
        }
        None
    }

    /// The choice by a key, unless it is typed into a field or presses the widget with the focus: Esc closes the
    /// window, Enter opens the record.
    fn pressed(&self, ctx: &Context) -> Option<Choice> {
        if ctx.text_edit_focused() || Popup::is_any_open(ctx) {
            return None;
        }
        let has_focus = ctx.memory(|memory| memory.focused().is_some());
        let [escape, enter] = ctx.input(|input| [Key::Escape, Key::Enter].map(|key| input.key_pressed(key)));
        let is_possible = matches!(&self.stage, Stage::Asking(draft) if draft.is_possible());
        match (escape, enter && !has_focus && is_possible) {
            (true, _) => Some(Choice::Cancel),
            (false, true) => Some(Choice::Open),
            (false, false) => None,
        }
    }

    fn stage_ui(&mut self, ui: &mut Ui, palette: &Palette, can_hold_out: bool) -> Option<Choice> {
        let Self { name, stage, is_still, .. } = self;
        match stage {
            Stage::Reading(reading) => {
                ui.label(format!("Reading “{name}”"));
                progress_ui(ui, palette, reading.seen, *is_still)
            }
            Stage::Suggesting(_, suggest) => {
                ui.label(format!("Making start values from “{name}”"));
                progress_ui(ui, palette, suggest.seen, *is_still)
            }
            Stage::Failed(reason) => {
                ui.colored_label(palette.warning, format!("“{name}” cannot be opened: {reason}."));
                button(ui, "Close", true).then_some(Choice::Cancel)
            }
            Stage::Asking(draft) => draft.ui(ui, palette, can_hold_out),
        }
    }
}

fn progress_ui(ui: &mut Ui, palette: &Palette, share: f64, is_still: bool) -> Option<Choice> {
    ui.add(ProgressBar::new(share as f32).show_percentage());
    if is_still {
        ui.colored_label(palette.warning, "It has made no progress for 10 s. Esc stops it.");
    }
    button(ui, "Cancel the import", true).then_some(Choice::Cancel)
}

fn button(ui: &mut Ui, text: &str, enabled: bool) -> bool {
    let button = ui.add_enabled(enabled, Button::new(text));
    probe::remember(ui.ctx(), text, button.rect);
    button.clicked()
}

fn decay_ui(ui: &mut Ui, table: &Table) -> Option<Choice> {
    let axes = ThreeAxes::of(table)?;
    let mut choice = None;
    ui.horizontal_wrapped(|ui| {
        ui.label("An accelerometer with three axes.");
        let hint = "Without gravity, along the axis that moves most, from when the hand is gone until it rests; each time that it was plucked";
        let take = ui.button("Take its free decay").on_hover_text(hint);
        probe::remember(ui.ctx(), "Take its free decay", take.rect);
        choice = take.clicked().then(|| Choice::Decay(Decay::alike(&axes.readings(table)).map(|decays| Decay::file(&decays))));
    });
    choice
}

impl Draft {
    fn ui(&mut self, ui: &mut Ui, palette: &Palette, can_hold_out: bool) -> Option<Choice> {
        let file = std::sync::Arc::clone(&self.file);
        let table = &file.table;
        let rows = table.rows();
        ui.horizontal_wrapped(|ui| {
            ui.strong(&file.name);
            ui.weak(format!("{rows} rows, {} columns; {}", table.columns.len(), table.form));
        });
        if let Some(choice) = decay_ui(ui, table) {
            return Some(choice);
        }
        if let Some(remark) = &self.remark {
            ui.label(format!("{}.", sentence(remark)));
        }
        ui.add_space(4.0);
        columns_ui(ui, self, palette);
        ui.add_space(6.0);
        meaning_ui(ui, self);
        conditioning_ui(ui, self, palette);
        ui.checkbox(&mut self.suggest, "make start values from the data: R, guess, gain, Q")
            .on_hover_text("From spectra and from the likelihood; every number can be changed afterwards");
        ui.add_space(4.0);
        match self.outcome() {
            None => _ = ui.label("Making the record…"),
            Some(Ok(imported)) => {
                let record = &imported.record;
                let [dt, rate] = [record.dt(), 1.0 / record.dt()].map(|x| significant(x, 5));
                let [from, to] = [0, record.len() - 1].map(|k| significant(record.time(k), 5));
                ui.label(format!("{} samples from {from} s to {to} s, {dt} s apart ({rate} Hz)", record.len()));
                for remark in &imported.remarks {
                    ui.weak(remark);
                }
            }
            Some(Err(reason)) => _ = ui.colored_label(palette.warning, reason),
        }
        ui.add_space(4.0);
        ui.horizontal(|ui| {
            let open = button(ui, "Open the record", self.is_possible());
            let hint = "The free run of the models on screen over this record, which the filters do not see";
            let tests =
                can_hold_out && self.base.is_none() && ui.button("Test the models on it").on_hover_text(hint).clicked();
            let cancel = button(ui, "Cancel the import", true);
            match (open, tests, cancel) {
                (true, ..) => Some(Choice::Open),
                (_, true, _) => Some(Choice::HoldOut),
                (.., true) => Some(Choice::Cancel),
                _ => None,
            }
        })
        .inner
    }
}
