//! The bar at the top: play, pause, step, restart, speed, live or whole record, and the time.

use egui::{Button, ComboBox, RichText, Slider, Ui};

use crate::command::Command;
use crate::controls::number;
use crate::session::{Mode, Session};
use crate::text::significant;

/// Shows the playback's buttons; where it is narrow the time has a row of its own.
pub fn transport_ui(ui: &mut Ui, session: &Session, narrow: bool, commands: &mut Vec<Command>) {
    let (icon, name) = if session.playing() { ("⏸", "Pause") } else { ("▶", "Play") };
    if button(ui, icon, name, "Space") {
        commands.push(Command::TogglePlay);
    }
    if button(ui, "⏭", "Step", "→") {
        commands.push(Command::Step);
    }
    if button(ui, "↺", "Restart", "R") {
        commands.push(Command::Restart);
    }
    speed_ui(ui, session, commands);
    if !narrow {
        ui.separator();
    }
    for (mode, text, hint) in [
        (Mode::Live, "Live", "The filters run as time goes on"),
        (Mode::Whole, "Whole record", "All of the record, recomputed at once when anything changes"),
    ] {
        if ui.selectable_label(session.mode() == mode, text).on_hover_text(hint).clicked() {
            commands.push(Command::SetMode(mode));
        }
    }
    if narrow {
        ui.end_row();
    } else {
        ui.separator();
    }
    time_ui(ui, session, commands);
}

fn button(ui: &mut Ui, icon: &str, name: &str, key: &str) -> bool {
    let button = Button::new(RichText::new(icon).size(16.0)).min_size(egui::vec2(32.0, 26.0));
    let response = ui.add(button).on_hover_text(format!("{name} ({key})"));
    response.ctx.accesskit_node_builder(response.id, |node| node.set_label(name));
    response.clicked()
}

fn speed_ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let text = |speed: f64| format!("{}×", significant(speed, 3));
    let combo = ComboBox::from_id_salt("speed").selected_text(text(session.speed())).width(58.0).show_ui(ui, |ui| {
        for speed in Session::SPEEDS {
            if ui.selectable_label(session.speed() == speed, text(speed)).clicked() {
                commands.push(Command::SetSpeed(speed));
            }
        }
    });
    ui.ctx().accesskit_node_builder(combo.response.id, |node| node.set_label("Speed"));
}

fn time_ui(ui: &mut Ui, session: &Session, commands: &mut Vec<Command>) {
    let start = session.run().record().time(0);
    let mut time = session.time() - start;
    ui.spacing_mut().slider_width = (ui.available_width() - 130.0).clamp(60.0, 260.0);
    let slider = ui.add(Slider::new(&mut time, 0.0..=session.end()).show_value(false));
    slider.ctx.accesskit_node_builder(slider.id, |node| node.set_label("Time"));
    number::remember(ui, "Time", slider.rect);
    if slider.changed() {
        commands.push(Command::Seek(time));
    }
    ui.label(format!("{:6.2} / {} s", session.time(), significant(start + session.end(), 4)));
}
