//! Reads from a plant's equations which springs and forces act on which mass.

use super::PlantKind;
use crate::Channel;

impl PlantKind {
    /// Whether the force acts on a mass, counted from 0.
    pub fn is_driven(self, mass: usize) -> bool {
        let rate = |force| {
            let mut rate = vec![0.0; self.motion()];
            self.plant().motion_rate(&self.anywhere(), force, &mut rate);
            self.place(Channel::velocity(mass)).map(|place| rate[place])
        };
        rate(1.0) != rate(0.0)
    }

    /// Whether a spring holds a mass, counted from 0, to the one before it, or the first to the wall: whether the displacement
    /// of one accelerates the other.
    pub fn is_held(self, mass: usize) -> bool {
        let mut jacobian = vec![0.0; self.motion() * self.channels().len()];
        self.plant().motion_jacobian(&self.anywhere(), &mut jacobian);
        let accelerates = |by: Channel, mass: usize| {
            let place = self.place(Channel::velocity(mass)).zip(self.place(by));
            place.is_some_and(|(row, column)| jacobian[row * self.channels().len() + column] != 0.0)
        };
        match mass.checked_sub(1) {
            Some(before) => {
                accelerates(Channel::displacement(before), mass) || accelerates(Channel::displacement(mass), before)
            }
            None => accelerates(Channel::displacement(0), 0) || accelerates(Channel::velocity(0), 0),
        }
    }

    fn place(self, channel: Channel) -> Option<usize> {
        self.channels().iter().position(|other| *other == channel)
    }

    /// A state at which no derivative is zero by chance.
    fn anywhere(self) -> Vec<f64> {
        (0..self.channels().len()).map(|i| 0.31 + 0.17 * i as f64).collect()
    }
}

#[cfg(test)]
mod tests {
    use crate::PlantKind;
    use crate::mathematics::equation::EquationSettings;

    #[test]
    fn forces_and_springs_are_those_of_the_equations() {
        let of = |kind: PlantKind| {
            (0..kind.masses()).map(|mass| (kind.is_driven(mass), kind.is_held(mass))).collect::<Vec<_>>()
        };
        let typed = |text: &str| of(PlantKind::of_equation(&EquationSettings::new(text)).expect("an equation"));
        assert_eq!(of(PlantKind::BOUC_WEN), [(true, true)]);
        assert_eq!(of(PlantKind::SHEAR_3), [(true, true); 3]);
        assert_eq!(typed("x1'' + k x1 + q (x1 - x2) = f; x2'' + q (x2 - x1) = 0"), [(true, true), (false, true)]);
        assert_eq!(typed("x1'' + k x1 + g x2' = f; x2'' + k x2 - g x1' = 0"), [(true, true), (false, false)]);
        assert_eq!(typed("x'' = f + z; z' = a x"), [(true, false)]);
        assert_eq!(typed("x'' + z = 0; z' = f - a z + x"), [(false, false)]);
    }
}
