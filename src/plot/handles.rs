//! Handles: settings that are dragged in the plots.

use egui::{Color32, CursorIcon, Id, InputState, Rect, Sense, Shape, Stroke, Ui, pos2, vec2};
use egui_plot::PlotTransform;
use kalmanscope_core::setting::Change;

use super::time_axis::PlotInput;
use crate::request::Request;
use crate::widgets::hover_text;

const RADIUS: f32 = 4.5;
const GRASP: f32 = 10.0;

pub(crate) struct PlotHandle<'a> {
    pub(crate) name: String,
    pub(crate) time: f64,
    pub(crate) value: f64,
    pub(crate) color: Color32,
    pub(crate) set: Set<'a>,
}

type Set<'a> = Box<dyn Fn(f64, f64) -> Vec<(String, f64)> + 'a>;

pub(super) fn handles_ui(
    ui: &Ui,
    key: &str,
    handles: &[PlotHandle<'_>],
    transform: &PlotTransform,
    input: &PlotInput<'_>,
    requests: &mut Vec<Request>,
) {
    // A finger scrolls the page.
    if ui.input(InputState::has_touch_screen) {
        return;
    }
    let frame = *transform.frame();
    let painter = ui.painter_at(frame.expand(RADIUS + 2.0));
    for (i, handle) in handles.iter().enumerate() {
        let at = pos2(transform.position_from_point_x(handle.time), transform.position_from_point_y(handle.value));
        let id = Id::unique(("handle", key, i));
        let is_held = ui.ctx().is_being_dragged(id);
        if !(frame.contains(at) || is_held) {
            // A guess far off does not scale the axis: an arrow points to it.
            if frame.x_range().contains(at.x) {
                let [edge, inwards] = if at.y < frame.top() { [frame.top(), 1.0] } else { [frame.bottom(), -1.0] };
                let foot = edge + inwards * 1.6 * RADIUS;
                let corners = vec![pos2(at.x - RADIUS, foot), pos2(at.x, edge), pos2(at.x + RADIUS, foot)];
                painter.add(Shape::convex_polygon(corners, handle.color, Stroke::NONE));
            }
            continue;
        }
        let grasp = Rect::from_center_size(at, 2.0 * vec2(GRASP, GRASP));
        let response = ui.interact(grasp, id, Sense::drag());
        response.ctx.accesskit_node_builder(id, |node| node.set_label(&*handle.name));
        let is_lit = is_held || response.hovered();
        let fill = if is_lit { handle.color } else { input.palette.ground };
        painter.circle(at, RADIUS, fill, Stroke::new(2.0, handle.color));
        let response = hover_text(response.on_hover_cursor(CursorIcon::Grab), &|| format!("Drag: {}", handle.name));
        // An axis that follows its curves would move under the hand; after the drag it follows again.
        if response.drag_started() && input.axis.follows {
            ui.data_mut(|data| data.insert_temp(id, true));
            requests.push(Request::Unfollow);
        }
        if let Some(pointer) = response.interact_pointer_pos().filter(|_| response.dragged()) {
            let to = transform.value_from_position(frame.clamp(pointer));
            let mut change = Change::default();
            for (address, value) in (handle.set)(to.x, to.y) {
                change.set(input.session.scenario(), &address, value);
            }
            requests.extend(Request::edit(change));
        }
        if response.drag_stopped() && ui.data_mut(|data| data.remove_temp::<bool>(id)).is_some() {
            requests.push(Request::Follow);
        }
    }
}
