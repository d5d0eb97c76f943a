//! Parameters of a law under a load, relative to those under the load that it was built with.

/// Factors on the parameters of a law; see [`super::Law::scaled`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scales<T> {
    /// Factor on the transition speed U_tr.
    pub transition_speed: T,
    /// Factor on the asperity stiffness K0.
    pub stiffness: T,
}
