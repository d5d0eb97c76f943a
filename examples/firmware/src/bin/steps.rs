//! Every law, stepper, effect and loop, single and double precision, and nothing else: a program whose
//! symbols show that no step can panic. `bits` compares its results.

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
