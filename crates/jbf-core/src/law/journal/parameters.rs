//! Parameters of the journal law: their descriptions and the values in Table 4.2 of Cohn (1998).
//!
//! The original form of the asperity stiffness, equation (3.15), corresponds to `K0 = kappa0 /
//! (eps_b - eps_tr)`.

#[cfg(doc)]
use super::Journal;
use crate::described::described;

/// Physical meaning of the journal law for the catalogue, in one line.
pub(in crate::law) const SUMMARY: &str =
    "hydrodynamic journal bearing, boundary to full film (reduced Harnoy-Friedland model)";

described! {
    parameters Journal;
    f_m = "f_m", "-", "maximum friction coefficient of the asperities",
        [1e-4, 10.0], [0.25] .log();
    u_tr_m_s = "U_tr_m_s", "m/s", "transition speed from mixed to full film",
        [1e-5, 1e2], [0.055] .log();
    k0 = "K0", "-", "asperity stiffness constant",
        [1.0, 1e9], [6.5e5] .log();
    gamma = "gamma", "-", "slope factor of the viscous term",
        [1e-3, 1e5], [33.0] .log();
}

/// Indices of the parameters `U_tr_m_s` and `K0`, which affect the film.
pub(in crate::law) const FILM_PARAMETERS: [usize; 2] = [1, 2];

impl Parameters<f64> {
    /// Values of Table 4.2 of Cohn (1998): motion in both directions and Stribeck curve at 104 N.
    pub const TABLE_4_2: Self = Self {
        f_m: 0.26,
        u_tr_m_s: 0.06,
        k0: 7.5e5,
        gamma: 33.0,
    };
}
