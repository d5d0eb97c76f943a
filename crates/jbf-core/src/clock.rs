//! Time scale of the dimensionless equations.

/// Clock that converts seconds into the dimensionless time of equations (3.7) to (3.19).
///
/// Equation (3.4) fixes it as `tbar = t U_tr / R`. That is [`Clock::Journal`], the physical clock
/// and the default. Cohn's control programs step `TS * eps'` with `TS` in seconds, as if `tbar = t
/// / (1 s)`. That is [`Clock::Thesis`], which Tables 4.2 to 4.5 and chapter 6 were tuned with.
/// Hysteresis loops differ visibly between the two.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Clock {
    /// Time scale `tbar = t U_tr / R`.
    #[default]
    Journal,
    /// Time scale `tbar = t / (1 s)`.
    Thesis,
}

impl Clock {
    /// Name used in files and on the command line.
    pub const fn name(self) -> &'static str {
        match self {
            Clock::Journal => "journal",
            Clock::Thesis => "thesis",
        }
    }

    /// Returns the clock with this name.
    pub fn from_name(name: &str) -> Option<Self> {
        match name {
            "journal" => Some(Clock::Journal),
            "thesis" => Some(Clock::Thesis),
            _ => None,
        }
    }
}
