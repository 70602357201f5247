//! The keyboard: one table says what each key does, and lists it.

use egui::{Grid, Key, Modifiers, RichText, Ui};

use crate::command::Command;
use crate::session::{Mode, Session};
use crate::theme;

/// A key and what it does.
struct Shortcut {
    /// As it is written on the keyboard.
    name: &'static str,
    what: &'static str,
    keys: &'static [Key],
    modifiers: Modifiers,
    command: fn(&Session) -> Command,
}

/// A key that is pressed alone, or with what it takes to get at its sign.
const fn plain(
    name: &'static str,
    what: &'static str,
    keys: &'static [Key],
    command: fn(&Session) -> Command,
) -> Shortcut {
    Shortcut { name, what, keys, modifiers: Modifiers::NONE, command }
}

const SHORTCUTS: &[Shortcut] = &[
    plain("Space", "play or pause", &[Key::Space], |_| Command::TogglePlay),
    plain("→", "one sample forward", &[Key::ArrowRight], |_| Command::Step),
    plain("←", "one sample back", &[Key::ArrowLeft], |_| Command::StepBack),
    plain("R", "back to the start", &[Key::R, Key::Home], |_| Command::Restart),
    plain("L", "live, or the whole record", &[Key::L], |session| {
        Command::SetMode(if session.mode() == Mode::Live { Mode::Whole } else { Mode::Live })
    }),
    plain("+", "faster", &[Key::Plus, Key::Equals], |session| Command::SetSpeed(session.next_speed(true))),
    plain("−", "slower", &[Key::Minus], |session| Command::SetSpeed(session.next_speed(false))),
    plain("S", "show or hide the settings", &[Key::S], |_| Command::ToggleControls),
    plain("P", "presenter mode: large type", &[Key::P], |_| Command::TogglePresenter),
    plain("?", "this list", &[Key::Questionmark], |_| Command::ToggleKeys),
    plain("Esc", "leave this list, or an enlarged view", &[Key::Escape], |_| Command::Leave),
    Shortcut {
        name: "Ctrl+Shift+Z",
        what: "make the change again",
        keys: &[Key::Z],
        modifiers: Modifiers::COMMAND.plus(Modifiers::SHIFT),
        command: |_| Command::Redo,
    },
    Shortcut {
        name: "Ctrl+Z",
        what: "take back the last change of a setting",
        keys: &[Key::Z],
        modifiers: Modifiers::COMMAND,
        command: |_| Command::Undo,
    },
];

/// The keys that show and hide the filters, in their order.
const DIGITS: [Key; 6] = [Key::Num1, Key::Num2, Key::Num3, Key::Num4, Key::Num5, Key::Num6];

/// What is done without a command.
const GESTURES: &[(&str, &str)] = &[
    ("1 to 6", "show or hide a filter"),
    ("Drag in a plot", "zoom in"),
    ("Right drag in a plot", "move it"),
    ("Double click in a plot", "all of it again"),
    ("Click on a plot's symbol", "that plot alone, or all again"),
    ("Double click on a number", "back to what it was"),
    ("Alt and wheel on a number", "turn it"),
];

/// What the pressed keys ask for, unless something is being typed.
pub(crate) fn keys(ctx: &egui::Context, session: &Session, commands: &mut Vec<Command>) {
    if ctx.memory(|memory| memory.focused().is_some()) {
        return;
    }
    ctx.input_mut(|input| {
        for Shortcut { keys, modifiers, command, .. } in SHORTCUTS {
            let alone = !input.modifiers.command && !input.modifiers.alt;
            let pressed = keys.iter().any(|&key| {
                if modifiers.is_none() { alone && input.key_pressed(key) } else { input.consume_key(*modifiers, key) }
            });
            if pressed {
                commands.push(command(session));
            }
        }
        for (place, &key) in DIGITS.iter().enumerate() {
            if input.modifiers.is_none() && input.key_pressed(key) {
                commands.push(Command::ToggleFilter(place));
            }
        }
    });
}

/// The list of all keys.
pub(crate) fn list_ui(ui: &mut Ui) {
    Grid::new("keys").num_columns(2).spacing([18.0, 5.0]).show(ui, |ui| {
        let keys = SHORTCUTS.iter().map(|shortcut| (shortcut.name, shortcut.what));
        for (name, what) in keys.chain(GESTURES.iter().copied()) {
            ui.label(RichText::new(name).family(theme::strong()));
            ui.label(what);
            ui.end_row();
        }
    });
}
