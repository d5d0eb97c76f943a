//! Property: the journal stays inside its bearing, with and without inertia and with each
//! integration method.

use crate::bytes::{between, clock, number, parameter, step_s};
use crate::steps::seen;
use arbitrary::{Result, Unstructured};
use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::law::journal_full::JournalFull;
use jbf_core::law::Law;
use jbf_core::law::Named;
use jbf_core::stepper::{Euler, Rk4, Rodas3, Rodas5P};
use jbf_core::{Bearing, Real};

/// Largest speed and load, SI units.
const LARGEST: f64 = 1e9;

fn run<T: Real>(bytes: &mut Unstructured<'_>) -> Result<()> {
    let mut value =
        |i: usize| parameter(bytes, &<Journal<f64> as Named<f64>>::INFO.parameters[i]).map(T::of);
    let parameters = Parameters {
        f_m: value(0)?,
        u_tr_m_s: value(1)?,
        k0: value(2)?,
        gamma: value(3)?,
    };
    let bearing = Bearing::THESIS.with_mass_kg(between(bytes, 1e-3, 1e3)?);
    let load_n = between(bytes, 1e-2, 1e5)?;
    let clock = clock(bytes)?;
    let (Ok(law), Ok(full)) = (
        Journal::new(&bearing, load_n, &parameters, clock),
        JournalFull::new(&bearing, load_n, &parameters, clock),
    ) else {
        return Ok(());
    };
    let which = bytes.arbitrary::<u8>()? % 6;
    let (mut film, mut whole) = (law.start(T::of(load_n)), full.start(T::of(load_n)));
    let mut held = 0;
    while !bytes.is_empty() {
        if bytes.ratio(1, 6)? {
            let load_n = T::of(number(bytes, LARGEST)?);
            law.set_load(&mut film, load_n);
            full.set_load(&mut whole, load_n);
        }
        let mut u = [T::ZERO; 3];
        for u in &mut u {
            *u = T::of(number(bytes, LARGEST)?.abs());
        }
        let dt_s = T::of(step_s(bytes)?);
        let rate = T::of(between(bytes, 1e-3, 1e3)?);
        match which {
            0 => law.advance_with(&Euler, &mut film, u, rate, dt_s),
            1 => law.advance_with(&Rk4, &mut film, u, rate, dt_s),
            2 => law.advance_stiff_with(&Rodas3, &mut film, u, rate, dt_s),
            3 => law.advance_stiff_with(&Rodas5P, &mut film, u, rate, dt_s),
            4 => full.advance_with(&Rodas3, &mut whole, u, rate, dt_s),
            _ => full.advance_with(&Rodas5P, &mut whole, u, rate, dt_s),
        }
        let (eps, clamped, sliding) = if which < 4 {
            (film.eps(), film.clamped, law.friction(&film, u[2]))
        } else {
            (whole.eps(), whole.clamped, full.friction(&whole, u[2]))
        };
        let told = || format!("{law:?} {film:?} {whole:?} {u:?} {dt_s:?} {rate:?} stepper {which}");
        assert!(eps >= T::ZERO && eps < T::ONE, "eps {eps:?}: {}", told());
        assert!(clamped >= held, "what was held is forgotten: {}", told());
        held = clamped;
        seen();
        assert!(
            sliding.jump >= T::ZERO && sliding.smooth >= T::ZERO,
            "{sliding:?}: {}",
            told()
        );
        assert!(sliding.along(T::ONE).is_finite(), "{sliding:?}: {}", told());
    }
    Ok(())
}

pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    if bytes.arbitrary()? {
        run::<f32>(bytes)
    } else {
        run::<f64>(bytes)
    }
}
