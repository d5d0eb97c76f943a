//! Property: the readings of any law with any compatible effects are finite along a motion with
//! jumps.

use crate::bytes::{clock, effects, number, parameters, step_s};
use crate::steps::seen;
use arbitrary::{Result, Unstructured};
use jbf_core::effect::{Effects, Rig};
use jbf_core::law::{self, with_law, Named, Visitor};
use jbf_core::{Bearing, Chain, Motion, Real};

/// Largest value of each quantity of the motion, SI units.
///
/// With larger values, the force of a stiff drive or the heat of a film overflows in single
/// precision.
const LARGEST: f64 = 1e4;

struct Along<'a, 'b, T: Real> {
    bytes: &'a mut Unstructured<'b>,
    effects: Effects<T>,
}

impl<T: Real> Along<'_, '_, T> {
    fn motion(&mut self, before: &Motion<T>) -> Result<Motion<T>> {
        let bytes = &mut *self.bytes;
        let mut motion = *before;
        let changed: u8 = bytes.arbitrary()?;
        for (bit, quantity) in [
            &mut motion.velocity_m_s,
            &mut motion.acceleration_m_s2,
            &mut motion.angle_rad,
            &mut motion.weight_offset_rad,
            &mut motion.load_n,
        ]
        .into_iter()
        .enumerate()
        {
            if changed & (1 << bit) != 0 {
                *quantity = T::of(number(bytes, LARGEST)?);
            }
        }
        if changed & 0x30 == 0x30 {
            motion.velocity_m_s = -motion.velocity_m_s;
        }
        if changed & 0xc0 == 0xc0 {
            let celsius = number(bytes, 2e3)?;
            motion.temperature_c = bytes.arbitrary::<bool>()?.then_some(T::of(celsius));
        }
        Ok(motion)
    }
}

impl<T: Real> Visitor<T> for Along<'_, '_, T> {
    type Output = ();

    fn visit<L: Named<T>>(mut self, law: L) {
        let rig = Rig {
            radius_m: T::of(Bearing::THESIS.radius_m),
            count: T::of(4.0),
            force_at_drive: false,
        };
        let chain = Chain {
            law,
            effects: self.effects,
            rig,
        };
        let rest = Motion::at_rest(T::of(104.0));
        let Ok(mut motion) = self.motion(&rest) else {
            return;
        };
        let mut state = chain.start(&motion);
        assert!(
            state.reading_n.is_finite(),
            "start: {motion:?} {chain:?}",
            chain = L::INFO.name
        );
        while !self.bytes.is_empty() {
            let (Ok(to), Ok(dt_s)) = (self.motion(&motion), step_s(self.bytes)) else {
                return;
            };
            motion = to;
            motion.time_s += T::of(dt_s);
            if !motion.time_s.is_finite() {
                return;
            }
            let reading = chain.step(&mut state, &motion, T::of(dt_s));
            seen();
            assert!(
                reading.is_finite(),
                "{reading:?} after {dt_s} s, {motion:?}: {} {:?}",
                L::INFO.name,
                chain.effects
            );
        }
    }
}

fn run<T: Real>(bytes: &mut Unstructured<'_>) -> Result<()> {
    let page = bytes.choose(law::CATALOGUE)?;
    let values = parameters::<T>(bytes, page.parameters)?;
    let effects = effects(bytes, page)?;
    let clock = clock(bytes)?;
    let bearing = Some(&Bearing::THESIS);
    let along = Along { bytes, effects };
    let _ = with_law(page.name, bearing, Some(104.0), &values, clock, along);
    Ok(())
}

pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    if bytes.arbitrary()? {
        run::<f32>(bytes)
    } else {
        run::<f64>(bytes)
    }
}
