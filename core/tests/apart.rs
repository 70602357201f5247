//! The tests that `all` would slow down or that it would disturb.

mod allocations;
mod docs;
