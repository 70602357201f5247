//! A belief over logarithms, in the units of their channels.

use super::belief::Belief;
use super::function::Function;
use super::number::Number;

/// Converts mean and covariance to first order: the mean of θ is `exp` of the mean of `ln θ`, its standard deviation θ times that of
/// `ln θ`. The size of each component's unit in its channel's goes to `unit`, which is one for all that are no logarithms.
pub(crate) fn convert<T: Number>(logarithms: &[usize], unit: &mut [T], [mean, cov]: [&[T]; 2], belief: &mut Belief<T>) {
    belief.mean.copy_from_slice(mean);
    belief.cov.copy_from_slice(cov);
    for &place in logarithms {
        belief.mean[place] = mean[place].call(Function::Exp);
        unit[place] = belief.mean[place];
    }
    for (column, by) in belief.cov.chunks_exact_mut(unit.len()).zip(&*unit) {
        column.iter_mut().zip(&*unit).for_each(|(entry, unit)| *entry = *entry * (*unit * *by));
    }
}
