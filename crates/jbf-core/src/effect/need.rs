//! Requirements of an effect on the law, on other effects and on the record.

use crate::law;

/// Requirement of an effect on the law, on other effects or on the record.
///
/// The description of a law states whether the law meets a requirement. Requirements on the record
/// are checked when the record is read. An effect that requires another effect is zero without it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// The law has a lubricant film.
    Film,
    /// The law is in newtons and does not depend on the load.
    NoFilm,
    /// The law jumps at zero speed, so that a bristle or a compliant drive can replace the jump.
    NoBristle,
    /// The law has no dry friction that is independent of the load.
    NoDryLevel,
    /// Another effect has a force that the drive transmits, see
    /// [`transmitted`](field@super::Info::transmitted).
    Transmitted,
    /// The record has the angle of the shaft.
    Angle,
    /// The record has the travel of the drive, as an angle or on a line.
    Path,
    /// The record has the position of the drive, as an angle or on a line.
    Position,
    /// The record has loads that differ, within a run or between runs.
    Loads,
    /// The record has temperatures that differ, within a run or between runs.
    Temperatures,
}

impl Need {
    /// Returns true if the law meets the requirement, or if the requirement does not concern the
    /// law.
    pub(crate) const fn met_by(self, law: &law::Info) -> bool {
        match self {
            Need::Film => law.has_film,
            Need::NoFilm => !law.has_film,
            Need::NoBristle => !law.has_bristle,
            Need::NoDryLevel => !law.has_dry_level,
            Need::Transmitted
            | Need::Angle
            | Need::Path
            | Need::Position
            | Need::Loads
            | Need::Temperatures => true,
        }
    }
}
