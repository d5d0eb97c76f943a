//! Steps every law, integration method, effect and loop in single and double precision, and does
//! nothing else.
//!
//! The symbols of this program show that no step can panic. The program `bits` compares the
//! results.

#![no_std]
#![no_main]

use core::hint::black_box;
use cortex_m_rt::entry;
use jbf_firmware as _;

#[entry]
fn main() -> ! {
    loop {
        jbf_trace::steps::<f32>("f32", &mut |trace| {
            black_box(trace);
        });
        jbf_trace::steps::<f64>("f64", &mut |trace| {
            black_box(trace);
        });
    }
}
