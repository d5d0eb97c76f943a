//! Computes every fingerprint of `jbf-trace` on this target and compares it with the common table.

#![no_std]
#![no_main]

use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use jbf_firmware as _;

#[entry]
fn main() -> ! {
    let found = jbf_trace::check(|trace, expected| {
        if expected != Some(trace.hash) {
            let (group, name, kind) = (trace.group, trace.name, trace.kind);
            hprintln!("{}/{} {}: {:016x}", group, name, kind, trace.hash);
        }
    });
    let (same, different, unknown) = (found.same, found.different, found.unknown);
    hprintln!(
        "bits: {} as the table has them, {} differ, {} not in the table",
        same,
        different,
        unknown
    );
    debug::exit(if different == 0 && unknown == 0 {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    });
    loop {
        cortex_m::asm::wfi();
    }
}
