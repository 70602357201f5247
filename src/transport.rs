//! The bar at the foot of the plots: play, step, restart, speed, the timeline, live or whole record, and the time.

use egui::{Align, Button, ComboBox, DragValue, Layout, Rect, RichText, Ui, vec2};

use crate::bar::{History, history_ui};
use crate::probe::Remembered as _;
use crate::request::Request;
use crate::ruler::Ruler;
use crate::session::{Mode, Session};
use crate::text::{clock, parse_clock, significant};
use crate::theme::Palette;
use crate::timeline::track_ui;
use crate::widgets::{hover_text, named};

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum TransportExtent {
    Full,
    Short,
    Nothing,
}

pub(crate) struct Transport<'a> {
    pub(crate) session: &'a Session,
    pub(crate) ruler: &'a Ruler,
    pub(crate) palette: &'a Palette,
    pub(crate) narrow: bool,
    pub(crate) extent: TransportExtent,
    pub(crate) embedded: bool,
    pub(crate) history: History,
}

impl Transport<'_> {
    pub(crate) fn ui(&self, ui: &mut Ui, requests: &mut Vec<Request>) {
        let Self { session, ruler, palette, narrow, extent, embedded, history } = *self;
        let is_full = extent == TransportExtent::Full;
        ui.spacing_mut().item_spacing.y = 2.0;
        ui.horizontal(|ui| {
            playback_ui(ui, session, requests);
            if is_full && !narrow {
                speed_ui(ui, session, requests);
            }
            ui.with_layout(Layout::right_to_left(Align::Center), |ui| {
                if embedded {
                    open_outside_ui(ui, requests);
                }
                if is_full && !narrow {
                    modes_ui(ui, session, requests);
                }
                time_ui(ui, session, requests);
                let width = (ui.available_width() - ui.spacing().item_spacing.x).max(60.0);
                track_ui(ui, session, ruler, palette, width, requests);
            });
        });
        if is_full && narrow {
            ui.horizontal(|ui| {
                speed_ui(ui, session, requests);
                if !embedded {
                    history_ui(ui, history, requests);
                }
                ui.with_layout(Layout::right_to_left(Align::Center), |ui| modes_ui(ui, session, requests));
            });
        }
    }
}

fn playback_ui(ui: &mut Ui, session: &Session, requests: &mut Vec<Request>) {
    let (icon, name) = if session.playing() { ("⏸", "Pause") } else { ("▶", "Play") };
    if button_ui(ui, icon, name, "Space") {
        requests.push(Request::TogglePlay);
    }
    if button_ui(ui, "⏭", "Step", "→") {
        requests.push(Request::Step);
    }
    if button_ui(ui, "↺", "Restart", "R") {
        requests.push(Request::Restart);
    }
}

fn modes_ui(ui: &mut Ui, session: &Session, requests: &mut Vec<Request>) {
    for (mode, text, hint) in [
        (Mode::Whole, "Whole record", "All of the record, recomputed at once when anything changes"),
        (Mode::Live, "Live", "The filters run as time goes on"),
    ] {
        let button = Button::selectable(session.mode() == mode, text);
        let possible = mode == Mode::Live || session.can_be_whole();
        let too_long = format!("Too long to be recomputed at once: more than {} times Δt", Session::LONGEST_WHOLE);
        let button = ui.add_enabled(possible, button).on_hover_text(hint).on_disabled_hover_text(too_long);
        if button.remembered(text).clicked() {
            requests.push(Request::SetMode(mode));
        }
    }
}

fn button_ui(ui: &mut Ui, icon: &str, name: &str, key: &str) -> bool {
    let button = Button::new(RichText::new(icon).size(16.0)).min_size(egui::vec2(32.0, 26.0));
    let response = named(hover_text(ui.add(button), &|| format!("{name} ({key})")), name).remembered(name);
    response.clicked()
}

fn speed_ui(ui: &mut Ui, session: &Session, requests: &mut Vec<Request>) {
    if session.is_live() {
        // A live record has its own speed.
        return;
    }
    let text = |speed: f64| format!("{}×", significant(speed, 3));
    let combo = ComboBox::from_id_salt("speed").selected_text(text(session.speed())).width(58.0).show_ui(ui, |ui| {
        for speed in Session::SPEEDS {
            if ui.selectable_label(session.speed() == speed, text(speed)).clicked() {
                requests.push(Request::SetSpeed(speed));
            }
        }
    });
    named(combo.response, "Speed");
}

fn progress_ui(ui: &mut Ui, share: f64) {
    // Rounded down: 100 % must not be said before it is true.
    let label = ui.weak(format!("computing, {:.0} %", (100.0 * share).floor()));
    let label = label.on_hover_text("The last complete picture stays until the next one is computed. Esc gives it up.");
    let bar = Rect::from_min_max(label.rect.left_bottom(), label.rect.right_bottom() + vec2(0.0, BAR));
    let [ground, done] = [ui.visuals().widgets.noninteractive.bg_stroke.color, ui.visuals().selection.bg_fill];
    ui.painter().rect_filled(bar, 0.0, ground);
    let done_bar = bar.with_max_x(bar.left() + share as f32 * bar.width());
    ui.painter().rect_filled(done_bar, 0.0, done);
}

const BAR: f32 = 2.0;

fn open_outside_ui(ui: &mut Ui, requests: &mut Vec<Request>) {
    let button = ui.button("Explore").on_hover_text("This picture in the whole explorer, in a page of its own");
    if button.remembered("Explore").clicked() {
        requests.push(Request::OpenOutside);
    }
}

/// The width of the time in figures, so that the timeline does not move \[points\]; and that in hours, minutes and seconds.
const TIME_WIDTH: f32 = 104.0;
const CLOCK_WIDTH: f32 = 146.0;

fn time_ui(ui: &mut Ui, session: &Session, requests: &mut Vec<Request>) {
    let start = session.run().record().time_of(0);
    let end = start + session.end();
    let width = if end > LONG { CLOCK_WIDTH } else { TIME_WIDTH };
    let size = vec2(width, ui.spacing().interact_size.y);
    ui.allocate_ui_with_layout(size, Layout::left_to_right(Align::Center), |ui| {
        ui.set_min_width(width);
        if let Some(share) = session.progress() {
            progress_ui(ui, share);
        } else if end > LONG {
            // A pixel of the timeline may be minutes of a day: so a time can be typed, too.
            let mut time = session.time() - start;
            let field = DragValue::new(&mut time).range(0.0..=session.end()).speed(1.0).update_while_editing(false);
            let field = field.custom_formatter(|time, _| clock(start + time));
            let field =
                named(ui.add(field.custom_parser(|text| parse_clock(text).map(|time| time - start))), "Time, value");
            if field.changed() {
                requests.push(Request::Seek(time));
            }
            ui.label(format!("/ {}", clock(end)));
        } else {
            ui.label(format!("{:6.2} / {} s", session.time(), significant(end, 4)));
        }
    });
}

/// Limits the times in plain seconds; longer ones are in hours, minutes and seconds \[s\].
const LONG: f64 = 600.0;
