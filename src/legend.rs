//! The legend of all plots; a click shows or hides an entry.

use egui::scroll_area::ScrollBarVisibility;
use egui::text::{LayoutJob, TextWrapping};
use egui::{Button, Color32, Painter, Rect, ScrollArea, Sense, Stroke, StrokeKind, TextStyle, Ui, Vec2, WidgetInfo};
use kalmanscope_core::Estimates;

use crate::request::{LegendEntry, Request};
use crate::session::{Before, Session};
use crate::theme::Palette;
use crate::trouble::{FilterTrouble, troubles};
use crate::verdict::chip_ui;
use crate::visibility::Visibility;
use crate::widgets::named;

#[derive(Clone, Copy)]
pub(crate) enum LegendMark {
    Line,
    Dots,
    Band,
    Chip,
    Dashes,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum LegendExtent {
    Full,
    OneRow,
}

/// The width that is kept for the chip of the picture from before, at least \[points\].
const CHIP: f32 = 96.0;

pub(crate) struct Legend<'a> {
    pub(crate) session: &'a Session,
    pub(crate) visible: &'a Visibility,
    pub(crate) palette: &'a Palette,
}

impl Legend<'_> {
    pub(crate) fn ui(&self, ui: &mut Ui, extent: LegendExtent, requests: &mut Vec<Request>) {
        match extent {
            LegendExtent::OneRow => {
                let hidden = ScrollBarVisibility::AlwaysHidden;
                ScrollArea::horizontal().id_salt("legend").scroll_bar_visibility(hidden).show(ui, |ui| {
                    ui.horizontal(|ui| self.entries_ui(ui, extent, requests));
                });
            }
            LegendExtent::Full => _ = ui.horizontal_wrapped(|ui| self.entries_ui(ui, extent, requests)),
        }
        self.troubles_ui(ui);
    }

    fn entries_ui(&self, ui: &mut Ui, extent: LegendExtent, requests: &mut Vec<Request>) {
        ui.spacing_mut().item_spacing.x = 12.0;
        let is_one_row = extent == LegendExtent::OneRow;
        let before = self.session.before();
        // In one row, which scrolls, the change that was just made and the filters come first, in sight.
        if let Some(before) = before.filter(|_| is_one_row) {
            self.before_ui(ui, before, requests);
        }
        if !is_one_row {
            self.record_ui(ui, requests);
        }
        for (place, estimates) in self.session.run().estimates().iter().enumerate() {
            self.filter_ui(ui, place, estimates, requests);
        }
        if is_one_row {
            self.record_ui(ui, requests);
        }
        self.switches_ui(ui, requests);
        self.only_ui(ui, requests);
        match before {
            _ if is_one_row => {}
            Some(before) => self.before_ui(ui, before, requests),
            // Reserves the room of the change's chip, so that nothing else moves when it appears.
            None => _ = ui.allocate_exact_size(Vec2::new(CHIP, HEIGHT), Sense::hover()),
        }
    }

    fn record_ui(&self, ui: &mut Ui, requests: &mut Vec<Request>) {
        let Self { session, visible, palette } = self;
        let run = session.run();
        if run.channels().iter().any(|channel| run.record().truth(*channel).is_some()) {
            entry_ui(ui, LegendEntry::Truth, "truth", (LegendMark::Line, palette.truth, visible.truth), requests);
        }
        entry_ui(ui, LegendEntry::Measured, "measured", (LegendMark::Dots, palette.weak, visible.measured), requests);
    }

    fn filter_ui(&self, ui: &mut Ui, place: usize, estimates: &Estimates, requests: &mut Vec<Request>) {
        let Self { session, visible, palette } = self;
        let (color, on) = (palette.shade(estimates.color()), visible.filter(estimates.id()));
        let entry = LegendEntry::Filter(estimates.id());
        entry_ui(ui, entry, estimates.name(), (LegendMark::Band, color, on), requests);
        let verdict = session.diagnosis(place).and_then(|diagnosis| diagnosis.verdict.as_ref());
        if let Some(verdict) = verdict.filter(|_| visible.verdicts)
            && chip_ui(ui, estimates.name(), verdict, (color, on), palette).clicked()
        {
            requests.push(Request::Diagnose(estimates.id()));
        }
    }

    fn switches_ui(&self, ui: &mut Ui, requests: &mut Vec<Request>) {
        let Self { session, visible, palette } = self;
        if session.scenario().filters.iter().any(|filter| filter.smoother) {
            let shown = (LegendMark::Dashes, palette.weak, visible.hindsight);
            entry_ui(ui, LegendEntry::Hindsight, "hindsight", shown, requests);
        }
        entry_ui(ui, LegendEntry::Bands, "±2σ", (LegendMark::Band, palette.weak, visible.bands), requests);
        entry_ui(ui, LegendEntry::Verdicts, "verdicts", (LegendMark::Chip, palette.weak, visible.verdicts), requests);
    }

    fn before_ui(&self, ui: &mut Ui, before: &Before, requests: &mut Vec<Request>) {
        let text = format!("before: {}", before.words);
        let left = ui.available_size_before_wrap().x;
        let room = if left < CHIP { ui.max_rect().width() } else { left };
        let shown = format!("{} ×", fitted(ui, &text, room - CHIP_EDGES));
        let chip =
            Button::new(shown).small().stroke(Stroke::new(1.2, self.palette.weak)).min_size(Vec2::new(CHIP, 0.0));
        let hint = || {
            format!("Thin grey lines: the estimates before the last change ({}). Click to remove them", before.words)
        };
        let chip = named(ui.add(chip).on_hover_ui(|ui| _ = ui.label(hint())), format!("{text} ×"));
        if chip.clicked() {
            requests.push(Request::ForgetBefore);
        }
    }

    fn only_ui(&self, ui: &mut Ui, requests: &mut Vec<Request>) {
        if !self.visible.only.is_empty() {
            let symbols: Vec<&str> = self.visible.only.iter().map(|channel| channel.symbol()).collect();
            let all = Button::new(format!("only {} ×", symbols.join(", "))).small();
            if ui.add(all).on_hover_text("Click to show all quantities").clicked() {
                requests.push(Request::ShowAllChannels);
            }
        }
    }

    fn troubles_ui(&self, ui: &mut Ui) {
        for FilterTrouble { sentence, is_failure } in troubles(self.session) {
            if is_failure {
                ui.colored_label(self.palette.warning, sentence);
            } else {
                ui.weak(sentence);
            }
        }
    }
}

const CHIP_EDGES: f32 = 34.0;

fn fitted(ui: &Ui, text: &str, room: f32) -> String {
    let mut job = LayoutJob::simple_singleline(text.to_owned(), TextStyle::Button.resolve(ui.style()), Color32::WHITE);
    job.wrap = TextWrapping::truncate_at_width(room);
    ui.painter().layout_job(job).rows.iter().map(|row| row.text()).collect()
}

const HEIGHT: f32 = 20.0;

fn entry_ui(
    ui: &mut Ui,
    entry: LegendEntry,
    name: &str,
    (mark, color, on): (LegendMark, Color32, bool),
    requests: &mut Vec<Request>,
) {
    let font = TextStyle::Body.resolve(ui.style());
    let text_color = if on { ui.visuals().text_color() } else { ui.visuals().weak_text_color().gamma_multiply(0.6) };
    let galley = ui.painter().layout_no_wrap(name.to_owned(), font, text_color);
    let size = Vec2::new(galley.size().x + 26.0, HEIGHT);
    let (rect, response) = ui.allocate_exact_size(size, Sense::click());
    response.widget_info(|| WidgetInfo::selected(egui::Role::CheckBox, true, on, format!("Show {name}")));
    let color = if on { color } else { color.gamma_multiply(0.3) };
    let sample = Rect::from_center_size(rect.left_center() + Vec2::new(10.0, 0.0), Vec2::new(20.0, 10.0));
    paint_mark(ui.painter(), sample, mark, color);
    let painter = ui.painter();
    painter.galley(egui::pos2(rect.left() + 26.0, rect.center().y - galley.size().y / 2.0), galley, text_color);
    if response.has_focus() {
        painter.rect_stroke(rect.expand(2.0), 3.0, ui.visuals().selection.stroke, StrokeKind::Outside);
    }
    if response.on_hover_text(if on { "Click to hide" } else { "Click to show" }).clicked() {
        requests.push(Request::ToggleEntry(entry));
    }
}

pub(crate) fn paint_mark(painter: &Painter, sample: Rect, mark: LegendMark, color: Color32) {
    match mark {
        LegendMark::Line => {
            painter.hline(sample.x_range(), sample.center().y, Stroke::new(2.0, color));
        }
        LegendMark::Dashes => {
            for part in [[0.0, 0.4], [0.6, 1.0]] {
                let [from, to] = part.map(|x| sample.lerp_inside(egui::vec2(x, 0.5)).x);
                painter.hline(from..=to, sample.center().y, Stroke::new(1.4, color));
            }
        }
        LegendMark::Dots => {
            for (x, y) in [(0.2, 0.7), (0.5, 0.25), (0.8, 0.6)] {
                painter.circle_filled(sample.lerp_inside(egui::vec2(x, y)), 1.6, color);
            }
        }
        LegendMark::Chip => {
            painter.rect_stroke(sample, 5.0, Stroke::new(1.0, color), StrokeKind::Inside);
        }
        LegendMark::Band => {
            painter.rect_filled(sample, 2.0, color.gamma_multiply(0.25));
            painter.hline(sample.x_range(), sample.center().y, Stroke::new(2.0, color));
        }
    }
}
