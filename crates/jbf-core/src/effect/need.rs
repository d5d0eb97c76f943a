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
    /// Returns the name used in files.
    pub const fn name(self) -> &'static str {
        match self {
            Need::Film => "film",
            Need::NoFilm => "no_film",
            Need::NoBristle => "no_bristle",
            Need::NoDryLevel => "no_dry_level",
            Need::Transmitted => "transmitted",
            Need::Angle => "angle",
            Need::Path => "path",
            Need::Position => "position",
            Need::Loads => "loads",
            Need::Temperatures => "temperatures",
        }
    }

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

    /// Returns the reason why a law that does not meet the requirement excludes the effect, as the
    /// continuation of "the law ...".
    pub const fn why_not(self) -> &'static str {
        match self {
            Need::Film => "has no lubricant film",
            Need::NoFilm => "is a bearing law: its friction depends on the load and the film",
            Need::NoBristle => "contains presliding already",
            Need::NoDryLevel => "contains a load-independent dry friction already",
            Need::Transmitted => "transmits nothing",
            Need::Angle => "needs no angle",
            Need::Path => "needs no path",
            Need::Position => "needs no position",
            Need::Loads => "needs no loads",
            Need::Temperatures => "needs no temperatures",
        }
    }
}
