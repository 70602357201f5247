//! The equation of a plant: printed over its picture and in the settings, and edited in its own window.

mod editor;
mod print;
mod rows;

use kalmanscope_core::PlantKind;
use kalmanscope_core::equation::EquationSettings;

pub(crate) use editor::Editor;
pub(crate) use print::job;

const FIRST: &str = "x'' + 2 ζ ωₙ x' + ωₙ² x = f";

pub(crate) const NAME: &str = "equation of your own";

pub(crate) fn first() -> Option<PlantKind> {
    PlantKind::of_equation(&EquationSettings::new(FIRST)).ok()
}

fn typed(kind: PlantKind) -> EquationSettings {
    if let Some(own) = kind.own_equation() {
        return own.settings().clone();
    }
    let typed = EquationSettings::new(kind.equation().replace('ẍ', "x''").replace('ẋ', "x'"));
    let is_one = kind != PlantKind::SDOF && typed.symbols().is_ok();
    if is_one { typed } else { EquationSettings::new(FIRST) }
}
