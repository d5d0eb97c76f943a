//! Time scale of the dimensionless film equations.

/// Time scale that converts seconds into the dimensionless time `tbar` of equations (3.7) to (3.19)
/// of Cohn (1998).
///
/// Equation (3.4) defines `tbar = t U_tr / R`. This physical time scale is [`Clock::Journal`], the
/// default. Cohn's control programs step `TS * eps'` with `TS` in seconds, which implies `tbar = t
/// / (1 s)`. This is [`Clock::Thesis`]; Tables 4.2 to 4.5 and chapter 6 were fitted with it. The
/// hysteresis loops of the two differ visibly.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// Time scale `tbar = t U_tr / R`.
    #[default]
    Journal,
    /// Time scale `tbar = t / (1 s)`.
    Thesis,
}
