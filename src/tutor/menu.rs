//! How a lesson is begun: the menu, and an invitation for new users.

use egui::text::{LayoutJob, TextFormat};
use egui::{Align2, Button, CornerRadius, Response, RichText, Sense, Stroke, StrokeKind, Ui, vec2};
use kalmanscope_lessons::Lesson;

use super::Catalogue;
use crate::menu::{self, Closing};
use crate::probe::{self, Remembered as _};
use crate::request::Request;
use crate::theme::{self, Palette};
use crate::thumbnail;
use crate::widgets::named;

/// The width of the window that the menu leaves, and the least width of a card \[points\].
const AROUND: f32 = 40.0;
const LEAST: f32 = 164.0;

const MOST: usize = 7;

const GAP: f32 = 8.0;
const PADDING: f32 = 7.0;

/// The height of a card's picture as a share of its width, and at least and at most \[points\].
const SHARE: f32 = 0.25;
const HEIGHTS: (f32, f32) = (40.0, 84.0);

const TITLE: f32 = 36.0;
const FOOT: f32 = 15.0;

pub(crate) fn invitation_ui(ui: &mut Ui, requests: &mut Vec<Request>) {
    let text = RichText::new("New here? Start with lesson 1").color(ui.visuals().hyperlink_color);
    ui.add_space(10.0);
    if ui.add(Button::new(text).frame(false).wrap()).remembered("First lesson").clicked() {
        requests.push(Request::StartLesson(0));
    }
}

pub(crate) fn menu_ui(ui: &mut Ui, catalogue: &Catalogue, requests: &mut Vec<Request>) {
    let button = menu::menu_ui(ui, "Lessons", Closing::AtOnce, |ui| {
        ui.spacing_mut().item_spacing = vec2(GAP, 6.0);
        let room = ui.ctx().content_rect().width() - AROUND;
        let columns = ((room / LEAST) as usize).clamp(1, MOST);
        let width = room / columns as f32 - GAP;
        let mut place = 0;
        for course in catalogue.lessons.chunk_by(|one, next| one.course == next.course) {
            ui.horizontal(|ui| {
                ui.spacing_mut().interact_size.y = 0.0;
                ui.label(RichText::new(&course[0].course).family(theme::strong()).size(15.0));
                let finished = course.iter().filter(|lesson| catalogue.is_finished(lesson)).count();
                if finished > 0 {
                    ui.weak(format!("{finished} of {} finished", course.len()));
                }
            });
            let begin = place;
            for row in course.chunks(columns) {
                ui.horizontal_top(|ui| {
                    for lesson in row {
                        let state = (place - begin + 1, catalogue.is_finished(lesson));
                        if card_ui(ui, lesson, state, width).clicked() {
                            requests.push(Request::StartLesson(place));
                            ui.close();
                        }
                        place += 1;
                    }
                });
            }
        }
    });
    probe::remember(ui.ctx(), "Lessons", button.rect);
}

fn card_ui(ui: &mut Ui, lesson: &Lesson, (number, is_finished): (usize, bool), width: f32) -> Response {
    let above = (SHARE * width).clamp(HEIGHTS.0, HEIGHTS.1);
    let size = vec2(width, above + TITLE + FOOT + 2.5 * PADDING);
    let (rect, card) = ui.allocate_exact_size(size, Sense::click());
    let palette = Palette::of(ui.ctx().theme());
    let foot = format!("{number} · {} min", lesson.minutes());
    if ui.is_rect_visible(rect) {
        let painter = ui.painter_at(rect);
        let is_on = card.hovered() || card.has_focus();
        let edge = if is_on { palette.accent } else { palette.separator };
        painter.rect(rect, CornerRadius::same(6), palette.ground, Stroke::new(1.0, edge), StrokeKind::Inside);
        let inner = rect.shrink(PADDING);
        let picture = inner.with_max_y(inner.top() + above);
        if let Some(made) = thumbnail::of_lesson(ui.ctx(), lesson) {
            made.paint(&painter.with_clip_rect(picture), picture, &palette);
        }
        let format = TextFormat::simple(egui::FontId::new(13.0, theme::strong()), palette.text);
        let mut title = LayoutJob::single_section(lesson.title.clone(), format);
        (title.wrap.max_width, title.wrap.max_rows) = (inner.width(), 2);
        painter.galley(picture.left_bottom() + vec2(0.0, 0.5 * PADDING), painter.layout_job(title), palette.text);
        let small = egui::FontId::proportional(11.5);
        painter.text(inner.left_bottom(), Align2::LEFT_BOTTOM, &foot, small.clone(), palette.weak);
        if is_finished {
            painter.text(inner.right_bottom(), Align2::RIGHT_BOTTOM, "✓ finished", small, ui.visuals().hyperlink_color);
        }
    }
    probe::remember(ui.ctx(), &lesson.title, rect);
    let ending = if is_finished { ", finished" } else { "" };
    card.widget_info(|| egui::WidgetInfo::labeled(egui::Role::Button, true, &lesson.title));
    let card = named(card, format!("{}{ending}", lesson.title));
    card.ctx.accesskit_node_builder(card.id, |node| node.set_description(format!("{foot}. {}", lesson.summary)));
    card.on_hover_text(&lesson.summary)
}
