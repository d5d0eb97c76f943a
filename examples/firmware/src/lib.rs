//! Parts that the programs share: the board and the panic handler.
#![no_std]

pub mod board;
pub mod measure;
pub mod plain;

use core::panic::PanicInfo;

/// `control` cannot get here (a test reads its ELF); the reports can.
#[panic_handler]
fn panic(_info: &PanicInfo) -> ! {
    cortex_m_semihosting::debug::exit(cortex_m_semihosting::debug::EXIT_FAILURE);
    loop {
        cortex_m::asm::wfi();
    }
}
