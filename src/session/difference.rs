//! Names the settings in which two scenarios differ.

use kalmanscope_core::setting::Change;

use crate::text::significant;

const NAMED: usize = 2;

pub(super) fn difference(change: &Change) -> Option<String> {
    let all = change.what_was(|number| significant(number, 4));
    let more = if all.len() > NAMED { ", …" } else { "" };
    (!all.is_empty()).then(|| all.into_iter().take(NAMED).collect::<Vec<_>>().join(", ") + more)
}

#[cfg(test)]
mod tests {
    use super::*;
    use kalmanscope_core::{Channel, Scenario};

    #[test]
    fn a_change_is_named_by_what_was_before() {
        let now = Scenario::default();
        assert_eq!(difference(&Change::between(&now, &now)), None);
        let mut before = now.clone();
        before.filters[0].fading = 1.0;
        assert_eq!(difference(&Change::between(&before, &now)).unwrap(), "EKF λ = 1");
        before.filters[0].initial_mean[Channel::NATURAL_FREQUENCY] = 9.0;
        before.seed = 7;
        assert_eq!(difference(&Change::between(&before, &now)).unwrap(), "EKF λ = 1, EKF guess ωₙ = 9, …");
        let mut fewer = now.clone();
        let removed = fewer.filters.remove(1);
        assert_eq!(difference(&Change::between(&now, &fewer)).unwrap(), format!("with {}", removed.name));
        assert_eq!(difference(&Change::between(&fewer, &now)).unwrap(), format!("without {}", removed.name));
    }
}
