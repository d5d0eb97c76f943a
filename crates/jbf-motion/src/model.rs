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
    /// Terms `h^i / i!`: the transition is `F[i][j] = powers[j - i]`, with zeros below the
    /// diagonal.
    powers: [f64; N],
    /// Covariance of the disturbance for process noise of unit intensity.
    pub noise: Square<N>,
}

impl<const N: usize> Transition<N> {
    pub(crate) fn over(h: f64) -> Self {
        let mut powers = [1.0; N];
        for i in 1..N {
            powers[i] = powers[i - 1] * h / i as f64;
        }
        let noise = Square::from_fn(|i, j| {
            let (a, b) = (N - 1 - i, N - 1 - j);
            powers[a] * powers[b] * h / (a + b + 1) as f64
        });
        Self { h, powers, noise }
    }

    /// Transition matrix `F`.
    pub(crate) fn matrix(&self) -> Square<N> {
        Square::from_fn(|i, j| if j < i { 0.0 } else { self.powers[j - i] })
    }

    /// Product `F M F'` for a symmetric M.
    pub(crate) fn carried(&self, m: &Square<N>) -> Square<N> {
        symmetric(&self.columns(&self.columns(m).transpose()))
    }

    /// Product `F' M F` for a symmetric M.
    pub(crate) fn carried_back(&self, m: &Square<N>) -> Square<N> {
        symmetric(&self.columns_back(&self.columns_back(m).transpose()))
    }

    /// Product `M F'`.
    fn columns(&self, m: &Square<N>) -> Square<N> {
        let mut moved = *m;
        for i in 0..N {
            for j in i + 1..N {
                let further = m.column(j) * self.powers[j - i];
                let mut column = moved.column_mut(i);
                column += further;
            }
        }
        moved
    }

    /// Product `M F`.
    fn columns_back(&self, m: &Square<N>) -> Square<N> {
        let mut moved = *m;
        for i in 0..N {
            for j in 0..i {
                let further = m.column(j) * self.powers[i - j];
                let mut column = moved.column_mut(i);
                column += further;
            }
        }
        moved
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
