//! Factors on the parameters of a law that depend on the load.

/// Factors on the parameters of a law for a load, relative to the load given to its constructor;
/// see [`super::Law::scaled`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales<T> {
    /// Factor on the transition speed U_tr.
    pub transition_speed: T,
    /// Factor on the asperity stiffness K0.
    pub stiffness: T,
}
