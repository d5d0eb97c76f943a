//! Types of the C interface, with the memory layout of `include/jbf.h`.

use jbf_core::{Bearing, Clock, Error, Motion, Real};

/// Success.
pub const OK: i32 = 0;
/// A pointer is null.
pub const NULL: i32 = -1;
/// A parameter is outside its permitted range.
pub const PARAMETER: i32 = -2;
/// A name is not valid text, or is unknown.
pub const NAME: i32 = -3;

/// A bearing and its lubricant.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CBearing {
    /// Journal radius, m.
    pub radius_m: f64,
    /// Bearing length, m.
    pub length_m: f64,
    /// Radial clearance, m.
    pub clearance_m: f64,
    /// Rotating mass, kg.
    pub mass_kg: f64,
    /// Viscosity of the lubricant, Pa s.
    pub viscosity_pa_s: f64,
    /// Number of bearings on the shaft.
    pub count: u32,
}

impl From<&CBearing> for Bearing {
    fn from(b: &CBearing) -> Self {
        Bearing::new()
            .with_radius_m(b.radius_m)
            .with_length_m(b.length_m)
            .with_clearance_m(b.clearance_m)
            .with_mass_kg(b.mass_kg)
            .with_count(b.count)
            .with_viscosity_pa_s(b.viscosity_pa_s)
    }
}

/// An imposed motion at one instant.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CMotion<T> {
    /// Time, s.
    pub time_s: T,
    /// Surface speed, m/s.
    pub velocity_m_s: T,
    /// Rate of change of the surface speed, m/s^2.
    pub acceleration_m_s2: T,
    /// Shaft angle, rad; on a linear axis the position, m.
    pub angle_rad: T,
    /// Load on one bearing, N.
    pub load_n: T,
    /// Temperature, C; NaN if it is not measured.
    pub temperature_c: T,
    /// Shaft angle of the weight minus the shaft angle of the motion, rad.
    pub weight_offset_rad: T,
}

impl<T: Real> From<&CMotion<T>> for Motion<T> {
    fn from(m: &CMotion<T>) -> Self {
        let temperature_c = m.temperature_c;
        Motion {
            time_s: m.time_s,
            velocity_m_s: m.velocity_m_s,
            acceleration_m_s2: m.acceleration_m_s2,
            angle_rad: m.angle_rad,
            weight_offset_rad: m.weight_offset_rad,
            load_n: m.load_n,
            temperature_c: (!temperature_c.value().is_nan()).then_some(temperature_c),
        }
    }
}

/// A whole recorded run: columns of the same length.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CRecord {
    /// Number of samples.
    pub samples: usize,
    /// Time, s, ascending.
    pub time_s: *const f64,
    /// Surface speed, m/s.
    pub velocity_m_s: *const f64,
    /// Rate of change of the surface speed, m/s^2.
    pub acceleration_m_s2: *const f64,
    /// Shaft angle, rad.
    pub angle_rad: *const f64,
    /// Load on one bearing, N.
    pub load_n: *const f64,
    /// Temperature, C; null if it was not recorded.
    pub temperature_c: *const f64,
    /// Shaft angle of the weight minus the shaft angle of the motion, rad; null if they are equal.
    pub weight_offset_rad: *const f64,
}

/// Description of a refused parameter: its name, its value and the violated rule.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct CError {
    /// Name of the parameter, truncated to fit, zero-terminated.
    pub name: [u8; 32],
    /// Violated rule, truncated to fit, zero-terminated.
    pub rule: [u8; 96],
    /// Value that was refused.
    pub value: f64,
}

fn text<const N: usize>(from: &str) -> [u8; N] {
    let mut to = [0; N];
    // The last byte stays zero.
    for (slot, byte) in to.iter_mut().take(N - 1).zip(from.bytes()) {
        *slot = byte;
    }
    to
}

impl From<Error> for CError {
    fn from(error: Error) -> Self {
        Self {
            name: text(error.name()),
            rule: text(error.rule()),
            value: error.value().unwrap_or(f64::NAN),
        }
    }
}

/// Returns the time scale of the film with a number of the header (`JBF_CLOCK_...`), if there is
/// one.
pub fn clock(number: i32) -> Option<Clock> {
    match number {
        0 => Some(Clock::Journal),
        1 => Some(Clock::Thesis),
        _ => None,
    }
}
