//! Properties of `jbf-core` and `jbf-c` that hold for any input.
//!
//! Each property is a function of bytes that panics if the property is violated. `cargo fuzz`
//! generates the bytes (`crates/jbf-core/fuzz`); `cargo test -p jbf-properties` uses a million
//! random byte strings with known seeds.

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

/// Function that draws a case from the input and checks the property.
pub type Property = fn(&mut Unstructured<'_>) -> Result<()>;

/// Property with its name and the number of its tests.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Name of the property and of its fuzz target.
    pub name: &'static str,
    /// Function that checks the property; an error means only that the input is exhausted.
    pub holds: Property,
    /// Number of byte strings in the test with known seeds, in thousands.
    pub thousands: u32,
}

macro_rules! all {
    ($($module:ident $thousands:literal,)*) => {
        /// List of all properties.
        pub const ALL: &[Entry] = &[
            $(Entry { name: stringify!($module), holds: $module::holds, thousands: $thousands },)*
        ];
        $(
            /// Checks the property of this name with `data` as its input, for the fuzzer.
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
