//! Control loop for a product: every 2 ms, it reads the counter of the encoder and outputs a
//! voltage.
//!
//! The program does not report, panic or allocate; `make firmware` checks its size and its symbols.

#![no_std]
#![no_main]

use cortex_m::Peripherals;
use cortex_m_rt::{entry, exception};
use jbf_core::compensator::Compensator;
use jbf_core::controller::Controller;
use jbf_core::reference::Target;
use jbf_core::Error;
use jbf_firmware::board;
use jbf_trace::loops;

/// Creates the control loop with the selected compensator.
fn chosen() -> Result<Controller<f32, impl Compensator<f32>>, Error> {
    #[cfg(feature = "none")]
    let compensator = jbf_core::compensator::NoCompensation;
    #[cfg(feature = "coulomb")]
    let compensator = loops::coulomb(0.01, 1.0)?;
    #[cfg(feature = "table")]
    let compensator = loops::table()?;
    #[cfg(feature = "repetitive")]
    let compensator = loops::repetitive()?;
    #[cfg(feature = "learning")]
    let compensator = loops::learning(false)?;
    #[cfg(feature = "observed")]
    let compensator = loops::observed(loops::reduced()?, false)?;
    #[cfg(feature = "observed_full")]
    let compensator = loops::observed(loops::full()?, false)?;
    loops::around(compensator, false)
}

#[exception]
fn SysTick() {}

#[entry]
fn main() -> ! {
    let (Some(mut peripherals), Ok(controller)) = (Peripherals::take(), chosen()) else {
        // Nothing moves without sound settings.
        loop {
            cortex_m::asm::wfi();
        }
    };
    let mut state = controller.start();
    board::tick_every_2_ms(&mut peripherals.SYST);
    // To and fro at 4 rad/s, turning round every second.
    let mut target = Target {
        value: 4.0,
        rate: 0.0,
    };
    let mut step = 0_u32;
    loop {
        cortex_m::asm::wfi();
        step += 1;
        if step == 500 {
            step = 0;
            target.value = -target.value;
        }
        let signals = controller.step(&mut state, board::counter(), &target);
        board::amplify(signals.output_v);
    }
}
