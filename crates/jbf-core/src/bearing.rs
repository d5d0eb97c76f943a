//! Geometry and lubricant of a journal bearing, and the dimensionless groups of equations (3.1) to
//! (3.4) of Cohn (1998).

use crate::builder::with_fields;
use crate::error::{check, positive, Error};
use crate::real::Real;

/// Journal bearing and its lubricant: the data of a rig that are known before any fit.
#[derive(Clone, Copy, Debug, PartialEq)]
#[non_exhaustive]
pub struct Bearing {
    /// Journal radius R, m.
    pub radius_m: f64,
    /// Bearing length L, m.
    pub length_m: f64,
    /// Radial clearance C, m.
    pub clearance_m: f64,
    /// Rotating mass m, kg.
    pub mass_kg: f64,
    /// Number of bearings on the shaft.
    pub count: u32,
    /// Viscosity of the lubricant mu, Pa s.
    pub viscosity_pa_s: f64,
}

impl Default for Bearing {
    /// Returns [`Bearing::new`]: one bearing whose sizes are not set.
    fn default() -> Self {
        Self::new()
    }
}

impl Bearing {
    /// Bearing of Cohn (1998) with 10W-40 oil (Tables 4.2 to 4.5).
    pub const THESIS: Self = Self {
        radius_m: 0.0127,
        length_m: 0.01905,
        clearance_m: 5.08e-5,
        mass_kg: 2.27,
        count: 4,
        viscosity_pa_s: 0.002,
    };

    /// Creates one bearing whose sizes are not set; set each with its `with_...` method.
    ///
    /// [`Bearing::checked`] reports a missing size by name.
    #[must_use]
    pub const fn new() -> Self {
        Self {
            radius_m: f64::NAN,
            length_m: f64::NAN,
            clearance_m: f64::NAN,
            mass_kg: f64::NAN,
            count: 1,
            viscosity_pa_s: f64::NAN,
        }
    }

    with_fields! {
        with_radius_m => radius_m: f64,
        with_length_m => length_m: f64,
        with_clearance_m => clearance_m: f64,
        with_mass_kg => mass_kg: f64,
        with_count => count: u32,
        with_viscosity_pa_s => viscosity_pa_s: f64,
    }

    /// Returns the bearing if every size is valid.
    ///
    /// # Errors
    /// Reports the name of the first size that is not positive and finite, or a clearance that is
    /// not smaller than the radius.
    pub fn checked(self) -> Result<Self, Error> {
        positive("radius_m", self.radius_m)?;
        positive("length_m", self.length_m)?;
        positive("clearance_m", self.clearance_m)?;
        positive("mass_kg", self.mass_kg)?;
        positive("viscosity_pa_s", self.viscosity_pa_s)?;
        check(
            self.count >= 1,
            "count",
            f64::from(self.count),
            "must be at least 1",
        )?;
        check(
            self.clearance_m < self.radius_m,
            "clearance_m",
            self.clearance_m,
            "must be smaller than radius_m",
        )?;
        Ok(self)
    }

    /// Load number (dimensionless load) `Fb = C^2 F / (mu U_tr L^3)`, equation (3.1) of Cohn
    /// (1998).
    pub(crate) fn load_number<T: Real>(&self, load_n: T, u_tr_m_s: T) -> T {
        let l3 = self.length_m * self.length_m * self.length_m;
        let group = self.clearance_m * self.clearance_m / (self.viscosity_pa_s * l3);
        T::of(group) * load_n / u_tr_m_s
    }

    /// Mass number (dimensionless mass) `mb = C^3 U_tr m / (mu L^3 R^2)`, equation (3.4) of Cohn
    /// (1998).
    pub(crate) fn mass_number<T: Real>(&self, u_tr_m_s: T) -> T {
        let l3 = self.length_m * self.length_m * self.length_m;
        let c3 = self.clearance_m * self.clearance_m * self.clearance_m;
        let group = c3 * self.mass_kg / (self.viscosity_pa_s * l3 * self.radius_m * self.radius_m);
        T::of(group) * u_tr_m_s
    }

    /// Factor `C R / L^2` of the viscous friction in equation (3.14) of Cohn (1998).
    pub(crate) fn viscous_ratio(&self) -> f64 {
        self.radius_m * self.clearance_m / (self.length_m * self.length_m)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn missing_size_of_a_bearing_is_reported_by_name() {
        let most = Bearing::new()
            .with_radius_m(0.0127)
            .with_length_m(0.01905)
            .with_clearance_m(5.08e-5)
            .with_mass_kg(2.27)
            .with_count(4);
        let error = most.checked().expect_err("no viscosity");
        assert_eq!(error.name(), "viscosity_pa_s");
        assert_eq!(most.with_viscosity_pa_s(0.002), Bearing::THESIS);
    }
}
