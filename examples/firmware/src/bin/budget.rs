//! Measures the cost of every observer, model and loop on this target; `make firmware` prints a
//! table of it.

#![no_std]
#![no_main]

use core::hint::black_box;
use core::mem::size_of_val;
use cortex_m_rt::entry;
use cortex_m_semihosting::{debug, hprintln};
use jbf_core::compensator::Compensator;
use jbf_core::controller::Controller;
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::{with_law, Law, Named, Visitor, CATALOGUE};
use jbf_core::stepper::{Euler, Rk4, Rodas5P};
use jbf_core::JournalMotion;
use jbf_core::{Bearing, Clock, Error, Motion, Real};
use jbf_firmware::board::Instructions;
use jbf_firmware::measure::measure;
use jbf_firmware::plain::Plain;
use jbf_trace::loops::{coulomb_observer, each, velocity_observer, LoopVisitor};
use jbf_trace::{asked, Shaft, LOOP_STEPS, LOOP_STEP_S};

/// Steps of one period of U = 0.127 sin(t), and of double precision, which is emulated here.
const PERIOD: u32 = 3141;
const SHORT: u32 = 800;

/// Motion in both directions of chapter 4 of Cohn (1998), at a step.
fn two_way<T: Real>(step: u32, omega_rad_s: f64) -> Motion<T> {
    let time_s = LOOP_STEP_S * f64::from(step);
    let (sin, cos) = (
        Real::sin(omega_rad_s * time_s),
        Real::cos(omega_rad_s * time_s),
    );
    Motion {
        time_s: T::of(time_s),
        velocity_m_s: T::of(0.127 * sin),
        acceleration_m_s2: T::of(0.127 * omega_rad_s * cos),
        angle_rad: T::of(0.127 / omega_rad_s * (1.0 - cos) / Bearing::THESIS.radius_m),
        ..Motion::at_rest(T::of(104.0))
    }
}

fn ends<T: Real>(step: u32, omega_rad_s: f64) -> (Motion<T>, Motion<T>) {
    (two_way(step, omega_rad_s), two_way(step + 1, omega_rad_s))
}

/// Absolute surface speeds |U| at the start, middle and end of a step, m/s.
fn speeds<T: Real>(from: &Motion<T>, to: &Motion<T>) -> [T; 3] {
    let (a, b) = (from.velocity_m_s, to.velocity_m_s);
    [a, (a + b) * T::of(0.5), b].map(T::abs)
}

fn table_4_2<T: Real>() -> Parameters<T> {
    let p = Parameters::TABLE_4_2;
    Parameters {
        f_m: T::of(p.f_m),
        u_tr_m_s: T::of(p.u_tr_m_s),
        k0: T::of(p.k0),
        gamma: T::of(p.gamma),
    }
}

fn observers() -> Result<(), Error> {
    let observer = black_box(velocity_observer::<f32>()?);
    let mut velocity = 0.0_f32;
    let angle = |step| {
        (
            two_way::<f32>(step, 1.0).angle_rad,
            two_way::<f32>(step + 1, 1.0).angle_rad,
        )
    };
    measure(
        "observer/velocity",
        size_of_val(&observer) + 4,
        PERIOD,
        angle,
        |(from, to)| {
            velocity = observer.correct(velocity, to - from);
            velocity = black_box(observer.predict(velocity, 1.0));
        },
    );
    for (name, exponent) in [
        ("observer/coulomb/p=1", 1.0),
        ("observer/coulomb/p=0.5", 0.5),
        ("observer/coulomb/p=2", 2.0),
    ] {
        let observer = black_box(coulomb_observer::<f32>(0.01, exponent)?);
        let mut state = observer.learned(0.0);
        let speed = |step| two_way::<f32>(step, 1.0).velocity_m_s * 100.0;
        measure(
            name,
            size_of_val(&observer) + size_of_val(&state),
            PERIOD,
            speed,
            |&v| {
                let power = observer.power(v);
                let level = observer.level_v(&state, &power);
                observer.learn(&mut state, &power, v, level);
                black_box(level);
            },
        );
    }
    Ok(())
}

fn models<T: Real>(kind: &str, steps: u32) -> Result<(), Error> {
    let bearing = Bearing::THESIS;
    let reduced = black_box(Journal::<T>::new(
        &bearing,
        104.0,
        &table_4_2(),
        Clock::Journal,
    )?);
    let full = black_box(JournalFull::<T>::new(
        &bearing,
        104.0,
        &table_4_2(),
        Clock::Journal,
    )?);
    let dt_s = T::of(LOOP_STEP_S);
    macro_rules! on {
        ($($name:literal: $law:ident.$advance:ident($stepper:expr);)*) => {$({
            let mut state = $law.start(T::of(104.0));
            let ram = size_of_val(&$law) + size_of_val(&state);
            let name = if kind == "f32" { concat!($name, "/f32") } else { concat!($name, "/f64") };
            measure(name, ram, steps, |step| ends::<T>(step, 1.0), |(from, to)| {
                $law.$advance(&$stepper, &mut state, speeds(from, to), T::ONE, dt_s);
                let u = to.velocity_m_s;
                black_box($law.friction(&state, u).along(u.sign()));
            });
        })*};
    }
    on! {
        "model/reduced/euler": reduced.advance_with(Euler);
        "model/reduced/rk4": reduced.advance_with(Rk4);
        "model/full/rodas3": full.advance_with(jbf_core::stepper::Rodas3);
        "model/full/rodas5p": full.advance_with(Rodas5P);
    }
    Ok(())
}

struct Bare(&'static str);

impl Visitor<f32> for Bare {
    type Output = ();

    /// Measures a law without effects: its state (film or frictional memory), friction and bristle.
    fn visit<L: Named<f32>>(self, law: L) {
        let law = black_box(law);
        let mut state = law.start(104.0);
        let mut before = 0.0;
        let dt_s = LOOP_STEP_S as f32;
        let ram = size_of_val(&law) + size_of_val(&state);
        measure(
            self.0,
            ram,
            PERIOD,
            |step| ends::<f32>(step, 1.0),
            |(from, to)| {
                law.advance(&mut state, speeds(from, to), 1.0, dt_s);
                let sliding = law.friction(&state, to.velocity_m_s);
                if L::HAS_BRISTLE {
                    let levels = [before, sliding.jump];
                    before = sliding.jump;
                    let (from, to) = (JournalMotion::from(from), JournalMotion::from(to));
                    black_box(law.bend(&mut state, &from, &to, levels, dt_s) + sliding.smooth);
                } else {
                    black_box(sliding.along(to.velocity_m_s.sign()));
                }
            },
        );
    }
}

fn laws() -> Result<(), Error> {
    for page in CATALOGUE {
        let mut values = [0.0_f32; 16];
        for (value, p) in values.iter_mut().zip(page.parameters) {
            *value = p.starts[0] as f32;
        }
        let values = &values[..page.parameters.len().min(16)];
        hprintln!("law {}", page.name);
        with_law(
            page.name,
            Some(&Bearing::THESIS),
            Some(104.0),
            values,
            Clock::Journal,
            Bare("law"),
        )?;
    }
    Ok(())
}

struct Looped;

impl LoopVisitor<f32> for Looped {
    fn visit<C: Compensator<f32>>(
        &mut self,
        name: &'static str,
        controller: &Controller<f32, C>,
        position: bool,
    ) {
        let controller = black_box(controller);
        let mut state = controller.start();
        let shaft = core::cell::RefCell::new((Shaft::<f32>::default(), 0.0, 0.0));
        let ram = size_of_val(controller) + size_of_val(&state);
        hprintln!("loop {}", name);
        let prepare = |step| {
            let mut shaft = shaft.borrow_mut();
            let (output_v, level_v) = (shaft.1, shaft.2);
            shaft.0.push(output_v, level_v);
            let (target, level_v) = asked::<f32>(step, position);
            shaft.2 = level_v;
            (shaft.0.counter(step), target)
        };
        measure("loop", ram, LOOP_STEPS, prepare, |(counter, target)| {
            let parts = controller.step(&mut state, *counter, target);
            shaft.borrow_mut().1 = parts.output_v;
        });
    }
}

/// Reports the difference of the model with inertia between single and double precision, relative
/// to the peak of the loop.
fn precision() -> Result<(), Error> {
    let bearing = Bearing::THESIS;
    let single = JournalFull::<f32>::new(&bearing, 104.0, &table_4_2(), Clock::Journal)?;
    let double = JournalFull::<f64>::new(&bearing, 104.0, &table_4_2(), Clock::Journal)?;
    let (mut s, mut d) = (single.start(104.0), double.start(104.0));
    let (mut worst, mut peak) = (0.0_f64, 0.0_f64);
    for step in 0..PERIOD {
        let (from, to) = ends::<f64>(step, 2.0);
        let (from32, to32) = ends::<f32>(step, 2.0);
        double.advance(&mut d, speeds(&from, &to), 1.0, LOOP_STEP_S);
        single.advance(&mut s, speeds(&from32, &to32), 1.0, LOOP_STEP_S as f32);
        let u = to.velocity_m_s;
        let a = double.friction(&d, u).along(Real::sign(u));
        let b = single.friction(&s, u as f32).along(Real::sign(u as f32));
        worst = Real::max(worst, Real::abs(a - f64::from(b)));
        peak = Real::max(peak, Real::abs(a));
    }
    hprintln!("precision {:e}", worst / peak);
    Ok(())
}

fn plain() -> Result<(), Error> {
    let mut model = black_box(Plain::new()?);
    let speed = |step| two_way::<f32>(step, 1.0).velocity_m_s;
    measure(
        "model/reduced/as_printed/f32",
        size_of_val(&model),
        PERIOD,
        speed,
        |&u| {
            black_box(model.step(u, LOOP_STEP_S as f32));
        },
    );
    Ok(())
}

fn all() -> Result<(), Error> {
    observers()?;
    models::<f32>("f32", PERIOD)?;
    plain()?;
    models::<f64>("f64", SHORT)?;
    laws()?;
    each(&mut Looped)?;
    precision()
}

#[entry]
fn main() -> ! {
    Instructions::begin();
    let done = all();
    if let Err(error) = &done {
        hprintln!("{:?}", error);
    }
    debug::exit(if done.is_ok() {
        debug::EXIT_SUCCESS
    } else {
        debug::EXIT_FAILURE
    });
    loop {
        cortex_m::asm::wfi();
    }
}
