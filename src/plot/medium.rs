//! The medium of a drawing: a screen, or a figure on paper.

use egui::{Context, Id};

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) enum Medium {
    #[default]
    Screen,
    /// A figure: outlines that can be enlarged, and nothing that a reader cannot use, such as handles or values at the pointer.
    Figure,
}

impl Medium {
    pub(crate) fn of(ctx: &Context) -> Self {
        ctx.data(|data| data.get_temp(id())).unwrap_or_default()
    }

    pub(crate) fn set(self, ctx: &Context) {
        ctx.data_mut(|data| data.insert_temp(id(), self));
    }

    /// Notes the number of plots of a view, so that the figure can give it enough height.
    pub(crate) fn note_plots(self, ctx: &Context, count: usize) {
        if self == Self::Figure {
            ctx.data_mut(|data| data.insert_temp(plots(), count));
        }
    }

    /// The number of plots of the view that was drawn last in a context for figures. `None` if it has no rows of plots.
    pub(crate) fn take_plots(ctx: &Context) -> Option<usize> {
        ctx.data_mut(|data| data.remove_temp(plots()))
    }

    /// The height of the time axis in the last row of plots \[points\]. In a figure it includes a title.
    pub(crate) const fn axis_height(self) -> f32 {
        match self {
            Self::Screen => 18.0,
            Self::Figure => 33.0,
        }
    }

    /// The least distance between the numbers at a plot's axes, `[across, up]` \[points\].
    pub(crate) const fn between_ticks(self) -> [f32; 2] {
        match self {
            Self::Screen => [75.0, 34.0],
            Self::Figure => [62.0, 25.0],
        }
    }

    /// Columns per point of the screen, into which series are reduced. Lines of figures are thinner than those of a screen.
    pub(crate) fn density(self) -> f32 {
        match self {
            Self::Screen => 1.0,
            Self::Figure => 2.0,
        }
    }
}

fn plots() -> Id {
    Id::unique("number of plots of a view")
}

fn id() -> Id {
    Id::unique("medium of the drawing")
}
