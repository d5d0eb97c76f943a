//! Code that the programs share: the board support and the panic handler.
#![no_std]

pub mod board;
pub mod measure;
pub mod plain;

use core::panic::PanicInfo;

/// Stops after a panic; `control` never reaches this function (a test checks its symbols).
#[panic_handler]
fn panic(_info: &PanicInfo) -> ! {
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
