//! Properties of `jbf-core` and `jbf-c` that hold for any input, each a function of bytes that
//! panics where it does not hold. `cargo fuzz` hands them bytes that it breeds
//! (`crates/jbf-core/fuzz`), `cargo test -p jbf-properties` a million strings of seeded ones.

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

/// What an input is made into, and what must hold for it.
pub type Property = fn(&mut Unstructured<'_>) -> Result<()>;

/// One property.
#[derive(Clone, Copy)]
pub struct Entry {
    /// Its name; that of its fuzz target too.
    pub name: &'static str,
    /// The property itself. An error means that the bytes came to their end, no more.
    pub holds: Property,
    /// How many thousand strings of bytes the seeded test hands it.
    pub thousands: u32,
}

macro_rules! all {
    ($($module:ident $thousands:literal,)*) => {
        /// Every property.
        pub const ALL: &[Entry] = &[
            $(Entry { name: stringify!($module), holds: $module::holds, thousands: $thousands },)*
        ];
        $(
            /// The property of that name, of bytes.
            pub fn $module(data: &[u8]) {
                let _ = $module::holds(&mut Unstructured::new(data));
            }
        )*
    };
}

// So many that each takes seconds, and all of them together a minute of one core.
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
