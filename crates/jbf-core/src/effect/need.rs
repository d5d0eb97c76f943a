//! What an effect needs of the law and the effects beside it, and of the record.

use crate::law;

/// One need. Those of a law are answered by its page; those of a record by whoever reads it;
/// without the effect that it needs beside it an effect changes nothing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Need {
    /// Of the law: a lubricant film.
    Film,
    /// Of the law: that it is one in newtons, which knows no load.
    NoFilm,
    /// Of the law: that it jumps at zero speed, so that a bristle or a soft drive can take the
    /// jump's place.
    NoBristle,
    /// Of the law: no dry friction of its own that depends on no load.
    NoDryLevel,
    /// Of the effects beside it: one whose force the drive transmits ([`super::Info::transmitted`]).
    Transmitted,
    /// Of the record: the shaft's angle.
    Angle,
    /// Of the record: how far the drive has gone, as an angle or on a line.
    Path,
    /// Of the record: where the drive stands, as an angle or on a line.
    Position,
    /// Of the record: loads that differ, within a run or from run to run.
    Loads,
    /// Of the record: temperatures that differ, within a run or from run to run.
    Temperatures,
}

impl Need {
    /// The name used in files.
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

    /// True where a law gives what is needed, or where it is not the law's to give.
    pub const fn met_by(self, law: &law::Info) -> bool {
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

    /// Why a law that leaves the need open does not go with the effect: "the law ...".
    pub const fn why_not(self) -> &'static str {
        match self {
            Need::Film => "has no lubricant film",
            Need::NoFilm => "is a bearing's: its friction follows the load and the film",
            Need::NoBristle => "bends before it slides: it has a bristle of its own",
            Need::NoDryLevel => "already holds a dry friction that does not depend on the load",
            Need::Transmitted => "transmits nothing",
            Need::Angle => "needs no angle",
            Need::Path => "needs no path",
            Need::Position => "needs no position",
            Need::Loads => "needs no loads",
            Need::Temperatures => "needs no temperatures",
        }
    }
}
