//! Board support: encoder, amplifier, timer interrupt, and a clock that counts instructions under
//! QEMU.
//!
//! The addresses are those of Arm's MPS2 with the AN386 image; replace them by the HAL of your
//! chip.

use core::ptr;
use cortex_m::peripheral::{syst::SystClkSource, SYST};

/// Address of the CMSDK timer 0 with 25 MHz; with `-icount shift=6` an instruction takes 64 ns.
const TIMER: usize = 0x4000_0000;
const TIMER_VALUE: usize = TIMER + 4;
const TIMER_RELOAD: usize = TIMER + 8;

/// Address of the CMSDK timer 1, which represents the counter of the encoder.
const COUNTER: usize = 0x4000_1004;
/// Address of the LEDs of the FPGA, which represent the converter of the amplifier.
const AMPLIFIER: usize = 0x4002_8000;

fn read(address: usize) -> u32 {
    // A register of this board; reading it has no effect other than its value.
    unsafe { ptr::read_volatile(address as *const u32) }
}

fn write(address: usize, value: u32) {
    // A register of this board.
    unsafe { ptr::write_volatile(address as *mut u32, value) }
}

/// Returns the counter of the encoder, 16 bits.
pub fn counter() -> u32 {
    read(COUNTER) & 0xffff
}

/// Outputs a voltage to the amplifier: 12 bits over +-10 V.
pub fn amplify(volts: f32) {
    let counts = (volts * 204.7) as i32 + 2048;
    write(AMPLIFIER, counts as u32);
}

/// Starts the SysTick interrupt with a period of 2 ms, for a clock of 168 MHz.
pub fn tick_every_2_ms(syst: &mut SYST) {
    syst.set_clock_source(SystClkSource::Core);
    syst.set_reload(336_000 - 1);
    syst.clear_current();
    syst.enable_counter();
    syst.enable_interrupt();
}

/// Time of the timer, to count instructions under QEMU with `-icount shift=6`.
#[derive(Clone, Copy)]
pub struct Instructions(u32);

impl Instructions {
    /// Starts the timer; call once.
    pub fn begin() {
        write(TIMER_RELOAD, u32::MAX);
        write(TIMER_VALUE, u32::MAX);
        write(TIMER, 1);
    }

    /// Returns the present time.
    #[inline(always)]
    pub fn now() -> Self {
        Self(read(TIMER_VALUE))
    }

    /// Returns the number of ticks of the timer (40 ns each) since this time.
    #[inline(always)]
    pub fn ticks(self) -> u32 {
        self.0.wrapping_sub(read(TIMER_VALUE))
    }
}

/// Converts ticks of the timer (40 ns) to instructions (64 ns).
pub fn instructions(ticks: u32) -> u32 {
    ticks * 40 / 64
}
