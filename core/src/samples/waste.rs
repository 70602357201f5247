//! Unused memory that is returned to the system piece by piece: returning all of it at once takes longer than a frame.

/// Memory that can be returned piece by piece.
pub(crate) trait Piecewise: Send {
    /// Returns one piece of the memory to the system, in a millisecond or so. Returns whether there was one.
    fn free_piece(&mut self) -> bool;
}

#[derive(Default)]
pub(crate) struct Waste(Vec<Box<dyn Piecewise>>);

impl Waste {
    pub(crate) fn extend<T: Piecewise + 'static>(&mut self, unused: impl IntoIterator<Item = T>) {
        self.0.extend(unused.into_iter().map(|one| Box::new(one) as Box<dyn Piecewise>));
    }

    pub(crate) fn append(&mut self, other: &mut Self) {
        self.0.append(&mut other.0);
    }

    pub(crate) fn free_one(&mut self) -> bool {
        let Some(last) = self.0.last_mut() else { return false };
        if !last.free_piece() {
            self.0.pop();
        }
        true
    }
}
