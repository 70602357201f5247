//! The common plants, one per file, and the only place where a plant becomes a model of a size known to the compiler.

pub(crate) mod bouc_wen;
pub(crate) mod duffing;
pub(crate) mod sdof;
pub(crate) mod shear_chain;

use super::model::Model;
use crate::PlantKind;

use bouc_wen::BoucWen;
use duffing::Duffing;
use sdof::Sdof;
use shear_chain::ShearChain;

/// The plants that have a kernel.
#[cfg(test)]
pub(crate) const ALL: [PlantKind; 6] = [
    PlantKind::SDOF,
    PlantKind::DUFFING,
    PlantKind::BOUC_WEN,
    PlantKind::SHEAR_2,
    PlantKind::SHEAR_3,
    PlantKind::SHEAR_4,
];

/// A function of a model of any type and size.
pub(crate) trait Visitor {
    type Output;

    fn visit<P: Model<N>, const N: usize>(self, model: P) -> Self::Output;
}

/// Calls the visitor with the model of a plant, if it has a kernel. Its parameters decay at the rate `eta` \[1/s\].
pub(crate) fn visit<V: Visitor>(kind: PlantKind, eta: f64, visitor: V) -> Option<V::Output> {
    Some(match kind {
        _ if kind == PlantKind::SDOF => visitor.visit(Sdof { eta }),
        _ if kind == PlantKind::DUFFING => visitor.visit(Duffing { eta }),
        _ if kind == PlantKind::BOUC_WEN => visitor.visit(BoucWen { eta }),
        _ if kind == PlantKind::SHEAR_2 => visitor.visit(ShearChain::<2> { eta }),
        _ if kind == PlantKind::SHEAR_3 => visitor.visit(ShearChain::<3> { eta }),
        _ if kind == PlantKind::SHEAR_4 => visitor.visit(ShearChain::<4> { eta }),
        _ => return None,
    })
}

#[cfg(test)]
mod tests;
