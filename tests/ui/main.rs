//! The app in a headless harness: every control, every view, any size.

mod beside;
mod day;
mod diagnosis;
mod equation;
mod export;
mod files;
mod habits;
mod hand;
mod identity;
mod keyboard;
mod lessons;
mod looks;
mod map;
mod marks;
mod measure;
mod memory;
mod monte_carlo;
// Its tests run here: a program of their own would be linked for them alone.
#[allow(dead_code, reason = "the program itself does not run")]
#[path = "../../src/native/mod.rs"]
mod native;
mod phone;
mod playback;
mod record_store;
mod records;
mod screen_text;
mod sensors;
mod settings;
mod share;
mod sizes;
mod sounds;
mod story;
mod streams;
mod thumb;
mod tune;
mod workbench;

use std::collections::HashMap;

use eframe::{App as _, Storage as _};
use egui::{Key, Modifiers, Theme, Vec2, accesskit};
use egui_kittest::Harness;
use egui_kittest::kittest::{NodeT as _, Queryable as _};
use kalmanscope::App;
use kalmanscope::layout::ViewLayout;
use kalmanscope::request::{Arrangement, ViewKind};
use kalmanscope::ruler::RulerEnd;
use kalmanscope::session::{Budget, Mode};
use kalmanscope::views::view;
use kalmanscope_core::{Channel, FilterKind, Force, Hold, PlantKind, Quantity, Scenario, Signal};
use kalmanscope_diagnosis::VerdictKind;

use memory::Memory;

type Screen = Harness<'static, App>;

const DESKTOP: Vec2 = Vec2::new(1280.0, 800.0);
const PHONE: Vec2 = Vec2::new(390.0, 844.0);

/// The explorer as it starts, completed by `with`.
fn started(size: Vec2, theme: Theme, with: impl FnOnce(App, &egui::Context) -> App) -> Screen {
    let builder = Harness::builder().with_size(size).with_theme(theme).with_step_dt(1.0 / 60.0);
    builder.build_eframe(|creation| {
        let app = App::new(creation).expect("the default scenario can be run");
        with(app, &creation.egui_ctx)
    })
}

/// A screen whose frames compute all there is to compute: what it shows does not depend on the machine's speed.
fn screen(size: Vec2, theme: Theme) -> Screen {
    let mut screen = started(size, theme, |app, _| app);
    *screen.state_mut().layout_mut() = ViewLayout::of(Arrangement::Teach);
    screen.state_mut().show_all_settings(true);
    let session = screen.state_mut().session_mut();
    session.set_budget(Budget::Unlimited);
    session.set_scenario(Scenario::default());
    session.play_from_start();
    screen.run_steps(2);
    screen
}

fn verdict(screen: &Screen, filter: &str) -> Option<egui::Rect> {
    let mut kinds = VerdictKind::ALL.into_iter();
    kinds.find_map(|kind| Some(screen.query_all_by_label(&kind.on(filter)).next()?.rect()))
}

fn click(screen: &mut Screen, label: &str) {
    screen.get_by_label(label).click();
    screen.run_steps(4);
}

fn click_on(screen: &mut Screen, at: egui::Pos2) {
    screen.hover_at(at);
    screen.drag_at(at);
    screen.drop_at(at);
    screen.run_steps(4);
}

fn drag(screen: &mut Screen, from: egui::Pos2, way: Vec2) {
    screen.hover_at(from);
    screen.run_steps(2);
    screen.drag_at(from);
    screen.run_steps(2);
    for step in 1..=5 {
        screen.hover_at(from + way * (step as f32 / 5.0));
        screen.run_steps(2);
    }
    screen.drop_at(from + way);
    screen.run_steps(3);
}

fn press(screen: &mut Screen, key: Key) {
    screen.key_press(key);
    screen.run_steps(4);
}

/// Takes the last change back by its keys.
fn undo(screen: &mut Screen) {
    screen.key_press_modifiers(Modifiers::COMMAND, Key::Z);
    screen.run_steps(4);
}

fn show(screen: &mut Screen, views: &[ViewKind]) {
    *screen.state_mut().layout_mut() = ViewLayout::column(views);
    screen.run_steps(4);
}

fn set_scenario(screen: &mut Screen, scenario: Scenario) {
    screen.state_mut().session_mut().set_scenario(scenario);
    screen.run_steps(4);
}

fn show_whole(screen: &mut Screen, scenario: Scenario) {
    let session = screen.state_mut().session_mut();
    session.set_budget(Budget::Unlimited);
    session.set_scenario(scenario);
    session.set_mode(Mode::Whole);
    session.pause();
}

fn opened(link: &str) -> Screen {
    let mut screen = screen(DESKTOP, Theme::Light);
    screen.state_mut().open_address(link);
    screen.run_steps(4);
    screen
}

fn saved(screen: &mut Screen) -> Memory {
    let mut memory = Memory::default();
    screen.state_mut().save(&mut memory);
    memory
}

fn restored(memory: &Memory) -> App {
    restored_in(&egui::Context::default(), memory)
}

fn restored_in(ctx: &egui::Context, memory: &Memory) -> App {
    let mut app = App::stored(ctx, Some(memory)).expect("the saved scenario can be run");
    app.session_mut().set_budget(Budget::Unlimited);
    app.session_mut().advance(0.0);
    app
}

/// The screen of that explorer, completed by `with`.
fn reloaded(memory: &Memory, with: impl FnOnce(App, &egui::Context) -> App) -> Screen {
    let builder = Harness::builder().with_size(DESKTOP).with_step_dt(1.0 / 60.0);
    let mut screen = builder.build_eframe(|creation| with(restored_in(&creation.egui_ctx, memory), &creation.egui_ctx));
    screen.run_steps(4);
    screen
}

fn open_options(screen: &mut Screen) {
    screen.get_all_by_label("Options").next().expect("each filter has options").click();
    screen.run_steps(12);
}

fn workbench() -> Screen {
    let mut screen = screen(Vec2::new(1280.0, 2400.0), Theme::Light);
    screen.state_mut().session_mut().toggle_play();
    for section in ["Record", "UKF"] {
        open(&mut screen, section);
    }
    screen
}

fn open(screen: &mut Screen, section: &str) {
    match section {
        "UKF" => {
            // The header of a filter is a widget separate from its name.
            let y = screen
                .get_all_by_label("UKF")
                .map(|node| node.rect())
                .find(|r| r.left() < 200.0)
                .expect("UKF")
                .center()
                .y;
            screen.hover_at(egui::pos2(18.0, y));
            screen.drag_at(egui::pos2(18.0, y));
            screen.drop_at(egui::pos2(18.0, y));
        }
        _ => screen.get_by_label(section).click(),
    }
    screen.run_steps(30);
}

fn scenario(screen: &Screen) -> &Scenario {
    screen.state().session().scenario()
}

/// Sets the control of this name by its accessibility interface.
fn set(screen: &mut Screen, name: &str, value: f64) {
    screen.get_by_label(name).set_value_accesskit(value);
    screen.run_steps(3);
}

fn choose(screen: &mut Screen, combo: &str, option: &str) {
    let before: Vec<_> = screen.query_all_by_label(option).map(|node| node.rect()).collect();
    click(screen, combo);
    let new = screen.query_all_by_label(option).find(|node| !before.contains(&node.rect()));
    new.expect("the option is in the menu").click();
    screen.run_steps(3);
}
