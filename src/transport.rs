//! The bar at the top: play, pause, step, restart, speed, live or whole record, and the time.

use egui::{Button, ComboBox, DragValue, Rect, RichText, Slider, Ui, vec2};

use crate::hover::hover_text;
use crate::probe;
use crate::request::Request;
use crate::session::{Mode, Session};
use crate::text::{clock, parse_clock, significant};

/// The parts of the transport that are shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Extent {
    /// All of it.
    Full,
    /// The buttons of playback and the time; a lesson chooses the rest.
    Short,
    /// Nothing, where settings need the room.
    Nothing,
}

/// Shows the playback's buttons; where it is narrow, the time has its own row, with `add_contents` at its beginning.
pub(crate) fn transport_ui(
    ui: &mut Ui,
    session: &Session,
    (narrow, extent): (bool, Extent),
    requests: &mut Vec<Request>,
    add_contents: impl FnOnce(&mut Ui, &mut Vec<Request>),
) {
    if extent == Extent::Nothing {
        return;
    }
    let (icon, name) = if session.playing() { ("⏸", "Pause") } else { ("▶", "Play") };
    if button(ui, icon, name, "Space") {
        requests.push(Request::TogglePlay);
    }
    if button(ui, "⏭", "Step", "→") {
        requests.push(Request::Step);
    }
    if button(ui, "↺", "Restart", "R") {
        requests.push(Request::Restart);
    }
    if extent == Extent::Short {
        return time_ui(ui, session, requests);
    }
    speed_ui(ui, session, requests);
    if !narrow {
        ui.separator();
    }
    for (mode, text, hint) in [
        (Mode::Live, "Live", "The filters run as time goes on"),
        (Mode::Whole, "Whole record", "All of the record, recomputed at once when anything changes"),
    ] {
        let button = Button::selectable(session.mode() == mode, text);
        let possible = mode == Mode::Live || session.can_be_whole();
        let too_long = format!("Too long to be recomputed at once: more than {} times Δt", Session::LONGEST_WHOLE);
        let button = ui.add_enabled(possible, button).on_hover_text(hint).on_disabled_hover_text(too_long);
        probe::remember(ui.ctx(), text, button.rect);
        if button.clicked() {
            requests.push(Request::SetMode(mode));
        }
    }
    if narrow {
        ui.end_row();
    } else {
        ui.separator();
    }
    add_contents(ui, requests);
    time_ui(ui, session, requests);
}

fn button(ui: &mut Ui, icon: &str, name: &str, key: &str) -> bool {
    let button = Button::new(RichText::new(icon).size(16.0)).min_size(egui::vec2(32.0, 26.0));
    let response = hover_text(ui.add(button), &|| format!("{name} ({key})"));
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
    probe::remember(ui.ctx(), name, response.rect);
    response.clicked()
}

fn speed_ui(ui: &mut Ui, session: &Session, requests: &mut Vec<Request>) {
    let text = |speed: f64| format!("{}×", significant(speed, 3));
    let combo = ComboBox::from_id_salt("speed").selected_text(text(session.speed())).width(58.0).show_ui(ui, |ui| {
        for speed in Session::SPEEDS {
            if ui.selectable_label(session.speed() == speed, text(speed)).clicked() {
                requests.push(Request::SetSpeed(speed));
            }
        }
    });
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Speed"));
}

/// A word with a thin progress bar below it.
fn progress_ui(ui: &mut Ui, share: f64) {
    let label = ui.weak(format!("computing, {:.0} %", (100.0 * share).floor()));
    let label = label.on_hover_text("The last complete picture stays until the next one is computed. Esc gives it up.");
    let bar = Rect::from_min_max(label.rect.left_bottom(), label.rect.right_bottom() + vec2(0.0, BAR));
    let [ground, done] = [ui.visuals().widgets.noninteractive.bg_stroke.color, ui.visuals().selection.bg_fill];
    ui.painter().rect_filled(bar, 0.0, ground);
    let done_bar = bar.with_max_x(bar.left() + share as f32 * bar.width());
    ui.painter().rect_filled(done_bar, 0.0, done);
}

/// Height of the progress bar \[points\].
const BAR: f32 = 2.0;

fn time_ui(ui: &mut Ui, session: &Session, requests: &mut Vec<Request>) {
    let start = session.run().record().time_of(0);
    let mut time = session.time() - start;
    let end = start + session.end();
    let text_width = if end > LONG { 170.0 } else { 130.0 };
    ui.spacing_mut().slider_width = (ui.available_size_before_wrap().x - text_width).clamp(60.0, 260.0);
    let slider = ui.add(Slider::new(&mut time, 0.0..=session.end()).show_value(false));
    slider.ctx.accesskit_node_builder(slider.id, |node| node.set_label("Time"));
    probe::remember(ui.ctx(), "Time", slider.rect);
    if slider.changed() {
        requests.push(Request::Seek(time));
    }
    if let Some(share) = session.progress() {
        progress_ui(ui, share);
    } else if end > LONG {
        // A pixel of the slider may be minutes of a day: so a time can be typed, too.
        let field = DragValue::new(&mut time).range(0.0..=session.end()).speed(1.0).update_while_editing(false);
        let field = field.custom_formatter(|time, _| clock(start + time));
        let field = ui.add(field.custom_parser(|text| parse_clock(text).map(|time| time - start)));
        field.ctx.accesskit_node_builder(field.id, |node| node.set_label("Time, value"));
        if field.changed() {
            requests.push(Request::Seek(time));
        }
        ui.label(format!("/ {}", clock(end)));
    } else {
        ui.label(format!("{:6.2} / {} s", session.time(), significant(end, 4)));
    }
}

/// Limits the times in plain seconds; longer ones are in hours, minutes and seconds \[s\].
const LONG: f64 = 600.0;
