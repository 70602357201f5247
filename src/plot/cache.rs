//! Values of the last frame, kept while they are valid.

use std::any::Any;
use std::hash::{DefaultHasher, Hash, Hasher as _};
use std::sync::Arc;

use egui::{Context, Id};

/// The value of `make`, computed again only if `depends_on` has changed since the last frame.
pub(crate) fn cached<T: Any + Send + Sync>(
    ctx: &Context,
    id: Id,
    depends_on: impl Hash,
    make: impl FnOnce() -> T,
) -> Arc<T> {
    let mut hasher = DefaultHasher::new();
    depends_on.hash(&mut hasher);
    let version = hasher.finish();
    let last: Option<(u64, Arc<T>)> = ctx.data(|data| data.get_temp(id));
    if let Some((_, value)) = last.filter(|(of, _)| *of == version) {
        return value;
    }
    let value = Arc::new(make());
    ctx.data_mut(|data| data.insert_temp(id, (version, Arc::clone(&value))));
    value
}
