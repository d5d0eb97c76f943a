//! Draws any compensator of `jbf_core` with any valid settings.

use crate::bytes::{between, clock, effects, number, parameters};
use arbitrary::{Result, Unstructured};
use jbf_core::compensator::learning::{self, Learned, Rule};
use jbf_core::compensator::observed::{self, Settings};
use jbf_core::compensator::repetitive::Repetitive;
use jbf_core::compensator::Axis;
use jbf_core::compensator::ChainModel;
use jbf_core::compensator::{
    Compensator, Coulomb, LawModel, Learning, NoCompensation, Observed, Table,
};
use jbf_core::controller::BaseLaw;
use jbf_core::effect::Effects;
use jbf_core::law::journal::{self, Journal};
use jbf_core::law::{self, with_law, Named, Visitor};
use jbf_core::observer::CoulombObserver;
use jbf_core::plant::Drive;
use jbf_core::{Bearing, Chain, Real};

/// Operation on a compensator of any type.
pub trait With<T: Real> {
    /// Performs the operation; `name` identifies the compensator in a failure message.
    fn with<C: Compensator<T>>(
        self,
        bytes: &mut Unstructured<'_>,
        name: &str,
        compensator: C,
    ) -> Result<()>;
}

/// Settings that the control loop and its compensator share.
pub struct Loop {
    /// Motor and shaft.
    pub drive: Drive,
    /// Control law without compensation.
    pub law: BaseLaw<f64>,
    /// Time step of the control loop, s.
    pub dt_s: f64,
}

/// Passes the compensator number `which`, without a friction model and observer, to `then`; invalid
/// settings are skipped.
fn plain<T: Real>(
    bytes: &mut Unstructured<'_>,
    rig: &Loop,
    which: u8,
    then: impl With<T>,
) -> Result<()> {
    let (dt_s, limit_v) = (rig.dt_s, between(bytes, 1e-3, 1e2)?);
    match which {
        0 => then.with(bytes, "none", NoCompensation),
        1 => {
            let (gain, exponent) = (between(bytes, 1e-6, 10.0)?, between(bytes, 0.1, 4.0)?);
            let exponent = if bytes.arbitrary()? { 1.0 } else { exponent };
            let b = rig.drive.input_rad_s2_v;
            let Ok(observer) = CoulombObserver::new(gain, exponent, b, limit_v, dt_s) else {
                return Ok(());
            };
            let start_v = T::of(number(bytes, 1e3)?);
            let mut coulomb = Coulomb::<T>::new(observer, &rig.drive);
            coulomb.start_v = start_v;
            then.with(bytes, "coulomb", coulomb)
        }
        2 => {
            let mut levels = [T::ZERO; 8];
            for level in &mut levels {
                *level = T::of(number(bytes, 1e2)?);
            }
            let axis = *bytes.choose(&[Axis::Speed, Axis::Angle])?;
            let (width, viscous) = (between(bytes, 1e-6, 1e3)?, number(bytes, 1e2)?);
            let Ok(table) = Table::new(levels, axis, width, viscous) else {
                return Ok(());
            };
            then.with(bytes, "table", table)
        }
        3 => {
            let steps = bytes.int_in_range(1..=200_u32)?;
            let (gain, smooth) = (between(bytes, 1e-6, 1e3)?, between(bytes, 0.0, 0.5)?);
            let lead_s = between(bytes, 0.0, 200.0)? * dt_s;
            let lap = Repetitive::<T, 16>::new(steps, gain, smooth, lead_s, limit_v, dt_s);
            let Ok(lap) = lap else { return Ok(()) };
            then.with(bytes, "repetitive", lap)
        }
        _ => {
            let film = parameters::<T>(bytes, <Journal<T> as Named<T>>::INFO.parameters)?;
            let &[f_m, u_tr_m_s, k0, gamma] = film.as_slice() else {
                return Ok(());
            };
            let film = journal::Parameters {
                f_m,
                u_tr_m_s,
                k0,
                gamma,
            };
            let Ok(law) = Journal::new(&Bearing::THESIS, 104.0, &film, clock(bytes)?) else {
                return Ok(());
            };
            let rule = *bytes.choose(&[Rule::Velocity, Rule::THESIS_POSITION])?;
            let begin = Learned {
                k0: k0.value(),
                gamma: gamma.value(),
            };
            let volts = between(bytes, 1e-3, 1e2)?;
            let settings = learning::Settings::new(rule, begin, volts, 0.0127, dt_s);
            let Ok(learning) = Learning::new(law, &settings) else {
                return Ok(());
            };
            let kept = Learned {
                k0: T::of(number(bytes, 1e9)?),
                gamma: T::of(number(bytes, 1e9)?),
            };
            then.with(bytes, "learning", learning.resumed(kept))
        }
    }
}

struct Round<'a, 'b, T: Real, W> {
    bytes: &'a mut Unstructured<'b>,
    settings: Settings,
    volts_per_n: f64,
    effects: Effects<T>,
    then: W,
}

impl<T: Real, W: With<T>> Visitor<T> for Round<'_, '_, T, W> {
    type Output = Result<()>;

    fn visit<L: Named<T>>(self, law: L) -> Result<()> {
        let begin = observed::Learned {
            level_v: T::of(number(self.bytes, 1e3)?),
            rest_v: T::of(number(self.bytes, 1e3)?),
        };
        let name = L::INFO.name;
        if self.bytes.arbitrary()? {
            let model = LawModel::new(law, 0.0127, self.volts_per_n, 104.0);
            let Ok(observed) = Observed::new(model, &self.settings) else {
                return Ok(());
            };
            return self.then.with(self.bytes, name, observed.resumed(begin));
        }
        let chain = Chain::new(law)
            .with_effects(self.effects)
            .on(&Bearing::THESIS);
        let model = ChainModel::new(chain, self.volts_per_n, 104.0);
        let Ok(observed) = Observed::new(model, &self.settings) else {
            return Ok(());
        };
        self.then.with(self.bytes, name, observed.resumed(begin))
    }
}

/// Passes a compensator with a friction model, of any law and any effects, and an observer to
/// `then`.
fn round<T: Real>(bytes: &mut Unstructured<'_>, rig: &Loop, then: impl With<T>) -> Result<()> {
    let settings = Settings::new(
        &rig.drive,
        between(bytes, 0.1, 1e3)?,
        between(bytes, 1e-4, 10.0)?,
        rig.dt_s,
    )
    .with_learning_1_s(between(bytes, 0.0, 100.0)?)
    .with_level_limit_v(between(bytes, 0.0, 10.0)?)
    .with_rest_limit_v(between(bytes, 0.0, 10.0)?)
    .with_breakaway(between(bytes, 0.0, 1.0)?)
    .with_control_law(&rig.law, between(bytes, 1.0, 100.0)?);
    let page = bytes.choose(law::CATALOGUE)?;
    let values = parameters::<T>(bytes, page.parameters)?;
    let effects = effects(bytes, page)?;
    let clock = clock(bytes)?;
    let volts_per_n = rig.drive.volts_per_n;
    let round = Round {
        bytes,
        settings,
        volts_per_n,
        effects,
        then,
    };
    let bearing = Some(&Bearing::THESIS);
    with_law(page.name, bearing, Some(104.0), &values, clock, round).unwrap_or(Ok(()))
}

/// Draws a compensator of any type and passes it to `then`.
pub fn any<T: Real>(bytes: &mut Unstructured<'_>, rig: &Loop, then: impl With<T>) -> Result<()> {
    let which = bytes.int_in_range(0..=9_u8)?;
    if which < 5 {
        plain(bytes, rig, which, then)
    } else {
        round(bytes, rig, then)
    }
}
