//! Velocity loop with friction compensation as an RTIC application for an STM32F411.
//!
//! A timer starts the task `control` every 2 ms. The task reads the counter of an incremental
//! encoder (TIM3 on PA6 and PA7) and sets the voltage of a motor: magnitude by pulse-width
//! modulation (TIM1 on PA8), direction by the pin PA9. The numbers of the motor and of its friction
//! are placeholders. `jbf export MODEL --rust model.rs` and `jbf control tune MODEL` compute those of
//! a recorded machine.

#![no_std]
#![no_main]

use panic_halt as _;

#[rtic::app(device = stm32f4xx_hal::pac, peripherals = true)]
mod app {
    use jbf_core::compensator::observed::Settings;
    use jbf_core::compensator::ChainModel;
    use jbf_core::compensator::{Compensator, Observed};
    use jbf_core::controller::{BaseLaw, Controller, Limits, State, Status};
    use jbf_core::encoder::Encoder;
    use jbf_core::law::lugre::{self, LuGre};
    use jbf_core::observer::VelocityObserver;
    use jbf_core::plant::Drive;
    use jbf_core::reference::Target;
    use jbf_core::{Chain, Error};
    use stm32f4xx_hal::gpio::{Output, PA9};
    use stm32f4xx_hal::pac::{TIM1, TIM2, TIM3};
    use stm32f4xx_hal::prelude::*;
    use stm32f4xx_hal::qei::Qei;
    use stm32f4xx_hal::rcc::Config;
    use stm32f4xx_hal::timer::{CounterHz, Event, PwmChannel};

    /// Friction model with an observer that corrects it.
    type FrictionCompensator = Observed<f32, ChainModel<f32, LuGre<f32>, ()>>;
    type Loop = Controller<f32, FrictionCompensator>;
    type LoopState = State<f32, <FrictionCompensator as Compensator<f32>>::State>;

    const FREQUENCY_HZ: u32 = 500;
    const PERIOD_S: f64 = 1.0 / FREQUENCY_HZ as f64;
    const COUNTS_PER_RAD: f64 = 2387.3;
    const LIMIT_V: f64 = 10.0;

    /// Creates the control loop.
    fn velocity_loop() -> Result<Loop, Error> {
        // Identified response v' = -135 v + 457 u, with v in rad/s and u in V.
        let drive = Drive::new(135.0, 457.0)
            .with_volts_per_n(0.05)
            .with_limit_v(LIMIT_V);
        let law = BaseLaw::velocity(&drive);
        let friction = LuGre::new(lugre::Parameters {
            f_c: 4.0,
            f_s: 6.0,
            ..Default::default()
        })?;
        let model = ChainModel::new(Chain::new(friction), drive.volts_per_n, 1.0);
        let settings = Settings::new(&drive, 60.0, 0.05, PERIOD_S)
            .with_learning_1_s(2.0)
            .with_level_limit_v(0.5)
            .with_rest_limit_v(1.5)
            .with_control_law(&law, 30.0);
        Controller::new(
            Encoder::new(COUNTS_PER_RAD, 16, drive.top_speed_rad_s(), PERIOD_S)?,
            VelocityObserver::new(15.0, PERIOD_S)?,
            law.cast(),
            Observed::new(model, &settings)?,
            Limits::new(LIMIT_V)
                .with_moving_v(1.83)
                .with_patience_s(0.1),
            PERIOD_S,
        )
    }

    #[shared]
    struct Shared {
        /// Speed in rad/s and acceleration in rad/s^2, written by the communication task.
        target: Target<f32>,
    }

    #[local]
    struct Local {
        control_loop: Loop,
        state: LoopState,
        timer: CounterHz<TIM2>,
        encoder: Qei<TIM3>,
        voltage: PwmChannel<TIM1, 0>,
        direction: PA9<Output>,
    }

    #[init]
    fn init(context: init::Context) -> (Shared, Local) {
        let device = context.device;
        let mut rcc = device.RCC.freeze(Config::hse(25.MHz()).sysclk(100.MHz()));
        let pins = device.GPIOA.split(&mut rcc);
        let encoder = Qei::new(device.TIM3, (pins.pa6, pins.pa7), &mut rcc);
        let (_, (channel, ..)) = device.TIM1.pwm_hz(20.kHz(), &mut rcc);
        let mut voltage = channel.with(pins.pa8);
        voltage.enable();
        let direction = pins.pa9.into_push_pull_output();

        // The task does not start if a parameter is out of bounds.
        let Ok(control_loop) = velocity_loop() else {
            loop {
                cortex_m::asm::wfi();
            }
        };
        let mut timer = device.TIM2.counter_hz(&mut rcc);
        let _ = timer.start(FREQUENCY_HZ.Hz());
        timer.listen(Event::Update);
        let shared = Shared {
            target: Target {
                value: 4.0,
                rate: 0.0,
            },
        };
        let local = Local {
            state: control_loop.start(),
            control_loop,
            timer,
            encoder,
            voltage,
            direction,
        };
        (shared, local)
    }

    /// Control step; a fault of the encoder switches the motor off.
    #[task(
        binds = TIM2,
        priority = 2,
        local = [control_loop, state, timer, encoder, voltage, direction],
        shared = [target]
    )]
    fn control(mut context: control::Context) {
        let local = context.local;
        local.timer.clear_all_flags();
        let target = context.shared.target.lock(|target| *target);
        let counter = u32::from(local.encoder.count());
        let signals = local.control_loop.step(local.state, counter, &target);
        let output_v = if signals.status.has(Status::FROZEN | Status::JUMPED) {
            0.0
        } else {
            signals.output_v
        };
        if output_v < 0.0 {
            local.direction.set_low();
        } else {
            local.direction.set_high();
        }
        let duty = output_v.abs() / LIMIT_V as f32 * f32::from(local.voltage.get_max_duty());
        local.voltage.set_duty(duty as u16);
    }
}
