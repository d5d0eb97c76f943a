//! Measures the cost of a step: instructions and stack, over many steps.

use crate::board::{instructions, Instructions};
use core::hint::black_box;
use core::ptr;
use cortex_m::register::msp;
use cortex_m_semihosting::hprintln;

/// Largest number of steps of one measurement.
const MOST: usize = 8000;

/// Number of bytes below the stack pointer in which the use of the stack is detected.
const WATCHED: usize = 4096;
const PAINT: u32 = 0x5a5a_a5a5;

/// Ticks of the timer that each step took.
static mut TICKS: [u32; MOST] = [0; MOST];

/// Measures the stack that a call uses, bytes: fills it with a pattern before, and counts the
/// changed bytes after.
#[inline(never)]
fn depth(call: &mut dyn FnMut()) -> usize {
    let top = msp::read() as usize & !3;
    // Below the stack pointer nothing lives; the program has one stack and no interrupts here.
    unsafe {
        for at in (top - WATCHED..top).step_by(4) {
            ptr::write_volatile(at as *mut u32, PAINT);
        }
    }
    call();
    unsafe {
        for at in (top - WATCHED..top).step_by(4) {
            if ptr::read_volatile(at as *const u32) != PAINT {
                return top - at;
            }
        }
    }
    0
}

/// Measures the time of `work`, ticks of the timer.
#[inline(never)]
fn timed(work: &mut dyn FnMut()) -> u32 {
    let begin = Instructions::now();
    work();
    begin.ticks()
}

/// Measures `steps` steps and reports the cost; `work` is measured, and `prepare`, which returns
/// its input, is not.
pub fn measure<I>(
    name: &str,
    ram: usize,
    steps: u32,
    mut prepare: impl FnMut(u32) -> I,
    mut work: impl FnMut(&I),
) {
    let nothing = (0..16)
        .map(|_| {
            timed(&mut || {
                black_box(());
            })
        })
        .min()
        .unwrap_or(0);
    let stack_of_nothing = depth(&mut || {
        black_box(());
    });
    // The program has one thread, and this is the only use.
    let ticks = unsafe { &mut *ptr::addr_of_mut!(TICKS) };
    let (mut n, mut stack) = (0, 0);
    for step in 0..steps {
        let input = black_box(prepare(step));
        let mut took = 0;
        let mut once = || took = timed(&mut || work(&input));
        // Every eighth step, and the stack of each branch is met thousands of times.
        if step % 8 == 0 {
            stack = stack.max(depth(&mut once));
        } else {
            once();
        }
        if let Some(slot) = ticks.get_mut(n) {
            *slot = took.saturating_sub(nothing);
            n += 1;
        }
    }
    let seen = &mut ticks[..n];
    seen.sort_unstable();
    let (median, worst) = (instructions(seen[n / 2]), instructions(seen[n - 1]));
    hprintln!(
        "row {} {} {} {} {}",
        name,
        median,
        worst,
        ram,
        stack.saturating_sub(stack_of_nothing)
    );
}
