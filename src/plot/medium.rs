//! The screen or the figure that plots are drawn on, and how they are arranged there.

use egui::{Context, Id, InputState, Rect, ScrollArea, Sense, Ui, UiBuilder, vec2};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Medium {
    #[default]
    Screen,
    /// A figure: outlines that can be enlarged, and nothing that a reader cannot use, such as handles or values at the pointer.
    Figure,
    /// A film: as a figure, with the values at the time of playback.
    Film,
}

impl Medium {
    pub(crate) fn of(ctx: &Context) -> Self {
        ctx.data(|data| data.get_temp(id())).unwrap_or_default()
    }

    pub(crate) fn set(self, ctx: &Context) {
        ctx.data_mut(|data| data.insert_temp(id(), self));
    }

    pub(crate) fn note_plots(self, ctx: &Context, count: usize) {
        if self == Self::Figure {
            ctx.data_mut(|data| data.insert_temp(plots(), count));
        }
    }

    pub(crate) fn take_plots(ctx: &Context) -> Option<usize> {
        ctx.data_mut(|data| data.remove_temp(plots()))
    }

    /// The height of the time axis in the last row of plots \[points\]. In a figure it includes a title.
    pub(crate) const fn axis_height(self) -> f32 {
        match self {
            Self::Screen | Self::Film => 18.0,
            Self::Figure => 33.0,
        }
    }

    /// The least distance between the numbers at a plot's axes, `[across, up]` \[points\].
    pub(crate) const fn between_ticks(self) -> [f32; 2] {
        match self {
            Self::Screen | Self::Film => [75.0, 34.0],
            Self::Figure => [62.0, 25.0],
        }
    }
}

fn plots() -> Id {
    Id::unique("number of plots of a view")
}

fn id() -> Id {
    Id::unique("medium of the drawing")
}

/// The least height of a plot; if there are too many for it, they scroll \[points\].
const LEAST_HEIGHT: f32 = 72.0;
const ROW_GAP: f32 = 6.0;
const GUTTER: f32 = 16.0;
/// Limits the width for two columns of plots, and that for two that avoid plots lower than [`LOW`] \[points\].
const TWO_COLUMNS: [f32; 2] = [640.0, 480.0];
/// Limits the height of plots below which two columns are better \[points\].
const LOW: f32 = 120.0;

pub(crate) fn cells_ui(ui: &mut Ui, count: usize, cell_ui: &mut dyn FnMut(&mut Ui, usize, bool)) {
    let area = ui.available_size();
    let medium = Medium::of(ui.ctx());
    medium.note_plots(ui.ctx(), count);
    let axis_height = medium.axis_height();
    if area.x < 1.0 || area.y < 1.0 || count == 0 {
        return;
    }
    let low = area.y / (count as f32) < LOW;
    let columns = if area.x < TWO_COLUMNS[usize::from(low)] { 1 } else { 2.min(count) };
    let rows = count.div_ceil(columns);
    let gaps = ROW_GAP * (rows - 1) as f32;
    let scrolls = rows > 2 && medium == Medium::Screen;
    let least = if !scrolls { 1.0 } else { LEAST_HEIGHT };
    let height = ((area.y - gaps - axis_height) / rows as f32).max(least);
    let mut all_ui = |ui: &mut Ui| {
        let top = ui.max_rect().min;
        let bar = if scrolls && height == least { ui.spacing().scroll.bar_width } else { 0.0 };
        let width = ((ui.available_width() - bar - GUTTER * (columns - 1) as f32) / columns as f32).max(1.0);
        for i in 0..count {
            let (row, column) = (i / columns, i % columns);
            let offset = vec2(column as f32 * (width + GUTTER), row as f32 * (height + ROW_GAP));
            let axis = if row + 1 == rows { axis_height } else { 0.0 };
            let cell = Rect::from_min_size(top + offset, vec2(width, height + axis));
            let mut child = ui.new_child(UiBuilder::new().id_salt(i).max_rect(cell));
            cell_ui(&mut child, i, row + 1 == rows);
        }
        let all = vec2(ui.available_width(), rows as f32 * height + gaps + axis_height);
        ui.allocate_rect(Rect::from_min_size(top, all), Sense::hover());
    };
    match medium {
        Medium::Screen => _ = ScrollArea::vertical().auto_shrink(false).show(ui, all_ui),
        Medium::Figure | Medium::Film => all_ui(ui),
    }
}

/// Width for the labels of the vertical axis, at least \[points\].
pub(crate) const Y_AXIS: f32 = 44.0;

pub(crate) fn sense(ui: &Ui) -> Sense {
    // A finger that drags scrolls the page.
    if ui.input(InputState::has_touch_screen) { Sense::click() } else { Sense::click_and_drag() }
}
