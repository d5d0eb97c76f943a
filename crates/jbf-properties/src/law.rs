//! Property: the friction of any law resists the motion.
//!
//! The part that jumps is not negative, the smooth part has the sign of the motion, and the force
//! of a bristle does not exceed its friction level.

use crate::bytes::{between, clock, number, parameters, step_s};
use crate::steps::seen;
use arbitrary::{Result, Unstructured};
use jbf_core::internals::SHORTEST_STEP_S;
use jbf_core::law::{self, with_law, Named, Visitor};
use jbf_core::{Bearing, Chain, Motion, Real};

/// Largest speed and load, SI units.
const LARGEST: f64 = 1e4;

/// Laws whose friction force may exceed the present friction level.
///
/// Their bristle has a damper in parallel, or their level follows the speed with a delay.
const FREER: [&str; 2] = ["lugre", "seven_parameter"];

struct Along<'a, 'b>(&'a mut Unstructured<'b>);

impl<T: Real> Visitor<T> for Along<'_, '_> {
    type Output = Result<()>;

    fn visit<L: Named<T>>(self, law: L) -> Result<()> {
        let bytes = self.0;
        let chain = Chain::new(law).on(&Bearing::THESIS);
        let mut motion = Motion::at_rest(T::of(104.0));
        let mut state = chain.start(&motion);
        let mut highest = T::ZERO;
        while !bytes.is_empty() {
            let dt_s = T::of(step_s(bytes)?.min(1e3));
            motion.time_s += dt_s;
            motion.velocity_m_s = T::of(number(bytes, LARGEST)?);
            motion.angle_rad += motion.velocity_m_s * dt_s / chain.rig.radius_m;
            if bytes.ratio(1, 8)? {
                motion.load_n = T::of(between(bytes, 0.0, LARGEST)?);
            }
            chain.step(&mut state, &motion, dt_s);
            if dt_s < T::of(SHORTEST_STEP_S) {
                // A step of zero length changes nothing.
                continue;
            }
            seen();
            let v = motion.velocity_m_s;
            let told = || format!("{}: {motion:?} {dt_s:?} {:?}", L::INFO.name, state.force_n);
            let sliding = chain.law.friction(&state.law, v);
            assert!(sliding.jump >= T::ZERO, "{sliding:?} {}", told());
            assert!(sliding.smooth * v >= T::ZERO, "{sliding:?} {}", told());
            assert!(state.force_n.is_finite(), "{}", told());
            if !L::HAS_BRISTLE {
                let power_w = state.force_n * v;
                assert!(power_w >= T::ZERO, "{power_w:?} {}", told());
            } else if !FREER.contains(&L::INFO.name) {
                // A deflected spring keeps its deflection.
                highest = highest.max(sliding.jump);
                let bent_n = (state.force_n - sliding.smooth).abs();
                let rounding = T::of(1e-3) * (highest + sliding.smooth.abs());
                assert!(
                    bent_n <= highest + rounding,
                    "{bent_n:?} {highest:?} {}",
                    told()
                );
            }
        }
        Ok(())
    }
}

fn run<T: Real>(bytes: &mut Unstructured<'_>) -> Result<()> {
    let page = bytes.choose(law::CATALOGUE)?;
    let values = parameters::<T>(bytes, page.parameters)?;
    let clock = clock(bytes)?;
    let bearing = Some(&Bearing::THESIS);
    with_law(
        page.name,
        bearing,
        Some(104.0),
        &values,
        clock,
        Along(bytes),
    )
    .unwrap_or(Ok(()))
}

/// Checks that the friction of any law, with any valid parameters, resists a motion with jumps of
/// the speed.
pub fn holds(bytes: &mut Unstructured<'_>) -> Result<()> {
    if bytes.arbitrary()? {
        run::<f32>(bytes)
    } else {
        run::<f64>(bytes)
    }
}
