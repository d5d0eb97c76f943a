//! Transition and process noise of a motion whose highest derivative is white noise.

use nalgebra::{SMatrix, SVector};

/// State of a motion: the position and its first N - 1 derivatives.
pub(crate) type State<const N: usize> = SVector<f64, N>;
/// Covariance or transition matrix of states.
pub(crate) type Square<const N: usize> = SMatrix<f64, N, N>;

/// Transition of a state over a time step, with the covariance of its disturbance.
pub(crate) struct Transition<const N: usize> {
    /// Length of the step, in units of the median step.
    pub h: f64,
    /// Transition matrix `F[i][j] = h^(j - i) / (j - i)!`, with zeros below the diagonal.
    pub matrix: Square<N>,
    /// Covariance of the disturbance for process noise of unit intensity.
    pub noise: Square<N>,
}

impl<const N: usize> Transition<N> {
    pub(crate) fn over(h: f64) -> Self {
        let mut powers = [1.0; N];
        for i in 1..N {
            powers[i] = powers[i - 1] * h / i as f64;
        }
        let matrix = Square::from_fn(|i, j| if j < i { 0.0 } else { powers[j - i] });
        let noise = Square::from_fn(|i, j| {
            let (a, b) = (N - 1 - i, N - 1 - j);
            powers[a] * powers[b] * h / (a + b + 1) as f64
        });
        Self { h, matrix, noise }
    }
}

/// Symmetric part of a matrix, which removes the asymmetry of a covariance by rounding.
pub(crate) fn symmetric<const N: usize>(m: &Square<N>) -> Square<N> {
    (m + m.transpose()) * 0.5
}

/// Update of a state estimate by one scalar measurement `y = row x + e`, `e ~ N(0, variance)`.
pub(crate) struct Update<const N: usize> {
    /// Variance of the innovation `y - row mean`.
    pub variance: f64,
    /// Kalman gain.
    pub gain: State<N>,
}

impl<const N: usize> Update<N> {
    pub(crate) fn new(row: &State<N>, variance: f64, covariance: &Square<N>) -> Self {
        let pc = covariance * row;
        let total = row.dot(&pc) + variance;
        Self {
            variance: total,
            gain: pc / total,
        }
    }

    /// Covariance after the measurement, in Joseph's form, which stays positive semidefinite.
    pub(crate) fn posterior(
        &self,
        row: &State<N>,
        variance: f64,
        covariance: &Square<N>,
    ) -> Square<N> {
        // (I - K row') C (I - K row')' + K K' variance, by rank-one updates.
        let half = covariance - self.gain * (covariance * row).transpose();
        let own = self.gain * variance - half * row;
        symmetric(&(half + own * self.gain.transpose()))
    }
}
