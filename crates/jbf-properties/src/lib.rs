//! Properties of `jbf-core` and `jbf-c` that hold for any input.
//!
//! Each is a function of bytes that panics if the property is violated. `cargo fuzz` generates the
//! bytes (`crates/jbf-core/fuzz`); `cargo test -p jbf-properties` uses a million seeded strings.

mod bytes;
mod chain;
mod compensators;
mod controller;
mod driver;
mod encoder;
mod film;
#[allow(unsafe_code)]
mod interface;
mod law;
mod observers;
mod plant;
mod steps;

pub use steps::all_seen;

use arbitrary::{Result, Unstructured};

/// A function that builds a case from the input and checks the property.
pub type Property = fn(&mut Unstructured<'_>) -> Result<()>;

/// A property.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Name of the property and of its fuzz target.
    pub name: &'static str,
    /// The property itself. An error only means that the bytes are exhausted.
    pub holds: Property,
    /// Number of byte strings in the seeded test, in thousands.
    pub thousands: u32,
}

macro_rules! all {
    ($($module:ident $thousands:literal,)*) => {
        /// All properties.
        pub const ALL: &[Entry] = &[
            $(Entry { name: stringify!($module), holds: $module::holds, thousands: $thousands },)*
        ];
        $(
            /// The property of that name as a function of bytes.
            pub fn $module(data: &[u8]) {
                let _ = $module::holds(&mut Unstructured::new(data));
            }
        )*
    };
}

// Chosen so that each takes seconds, and all together a minute on one core.
all! {
    law 500,
    film 500,
    chain 1000,
    plant 300,
    encoder 500,
    observers 500,
    controller 700,
    interface 400,
    driver 15,
}
