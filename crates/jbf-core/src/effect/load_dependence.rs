//! Load dependence of the film: U_tr and K0 vary with powers of the load relative to the nominal
//! load of the rig.
//!
//! ```text
//! U_tr -> U_tr (F/F_0)^p,  K0 -> K0 (F/F_0)^q,  F_0 the nominal load
//! ```
//!
//! Cohn (1998) had to fit U_tr and K0 again at each load. Tables 4.2 and 4.3 (motion in both
//! directions) have 0.06 m/s and 7.5e5 at 104 N, 0.05 m/s and 6.25e5 at 83.5 N, which implies p = q
//! = 0.83. Tables 4.4 and 4.5 (motion in one direction) imply p = 0, q = 1.50.
//!
//! At the nominal load the effect is zero, so records at one load do not determine the exponents.

use super::registry::named_effect;
use super::{Effect, Info, Need, Rig, Stage};
use crate::described::described;
use crate::law::Scales;
use crate::motion::Motion;
use crate::real::Real;

/// Limit of the power law: load ratios above this value or below its inverse are replaced by the
/// limit.
const FURTHEST: f64 = 10.0;

/// Film parameters U_tr and K0 that vary with powers of the load.
#[derive(Clone, Copy, Debug)]
pub struct LoadDependence<T> {
    exponents: [T; 2],
}

/// Load ratio of the last step, with the factors on the film parameters for this ratio.
#[derive(Clone, Copy, Debug)]
pub struct State<T> {
    share: T,
    scales: Scales<T>,
}

described! {
    named_effect LoadDependence = Info::new::<T, Self>("load_dependence", Stage::Film)
        .summary("transition speed and asperity stiffness that change with the load")
        .equation("U_tr -> U_tr (F/F_0)^p, K0 -> K0 (F/F_0)^q, F_0 the rig's load")
        .source("Cohn 1998, Tables 4.2 to 4.5; Lu, Khonsari & Gelinck 2006 for U_tr")
        .limits(
            "power law, valid within the tested loads; constant below 0.1 and above 10 times \
             the rig's load; loads that change faster than the film responds are untested",
        )
        .needs(&[Need::Film, Need::Loads]);
    p = "p", "-", "exponent of U_tr", [-3.0, 3.0], [0.8] null(0.0);
    q = "q", "-", "exponent of K0", [-3.0, 3.0], [0.8] null(0.0);
}

impl<T: Real> LoadDependence<T> {
    fn with_parameters(p: Parameters<T>) -> Self {
        Self {
            exponents: [p.p, p.q],
        }
    }
}

impl<T: Real> Effect<T> for LoadDependence<T> {
    type State = State<T>;

    fn start(&self, _motion: &Motion<T>, _rig: &Rig<T>) -> State<T> {
        State {
            share: T::ONE,
            scales: Scales {
                transition_speed: T::ONE,
                stiffness: T::ONE,
            },
        }
    }

    #[inline(always)]
    fn scales(&self, state: &mut State<T>, scales: &mut Option<Scales<T>>, share: T) {
        if share.value() != state.share.value() {
            let held = share.max(T::of(1.0 / FURTHEST)).min(T::of(FURTHEST));
            let [speed, stiffness] = self.exponents.map(|e| held.powf(e));
            *state = State {
                share,
                scales: Scales {
                    transition_speed: speed,
                    stiffness,
                },
            };
        }
        let own = state.scales;
        let before = scales.unwrap_or(Scales {
            transition_speed: T::ONE,
            stiffness: T::ONE,
        });
        *scales = Some(Scales {
            transition_speed: before.transition_speed * own.transition_speed,
            stiffness: before.stiffness * own.stiffness,
        });
    }
}
