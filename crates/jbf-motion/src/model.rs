//! Transition and process noise of a Wiener-process acceleration.

use nalgebra::{Matrix3, Vector3};

/// Transition over a step of `h`.
pub(crate) fn transition(h: f64) -> Matrix3<f64> {
    Matrix3::new(1.0, h, 0.5 * h * h, 0.0, 1.0, h, 0.0, 0.0, 1.0)
}

/// Covariance of the disturbance over a step of `h` with a jerk of unit intensity.
pub(crate) fn process_noise(h: f64) -> Matrix3<f64> {
    let (h2, h3) = (h * h, h * h * h);
    let (pp, pv, pa) = (h2 * h3 / 20.0, h2 * h2 / 8.0, h3 / 6.0);
    Matrix3::new(pp, pv, pa, pv, h3 / 3.0, h2 / 2.0, pa, h2 / 2.0, h)
}

/// The symmetric part of a matrix: rounding makes a covariance slightly asymmetric.
pub(crate) fn symmetric(m: &Matrix3<f64>) -> Matrix3<f64> {
    (m + m.transpose()) * 0.5
}

/// How one scalar measurement `y = row x + e`, `e ~ N(0, variance)`, updates a state estimate.
pub(crate) struct Update {
    /// Variance of the innovation `y - row mean`.
    pub variance: f64,
    /// Kalman gain.
    pub gain: Vector3<f64>,
}

impl Update {
    pub(crate) fn new(row: &Vector3<f64>, variance: f64, covariance: &Matrix3<f64>) -> Self {
        let pc = covariance * row;
        let total = row.dot(&pc) + variance;
        Self {
            variance: total,
            gain: pc / total,
        }
    }

    /// The covariance after the measurement, in Joseph's form: it stays positive semidefinite.
    pub(crate) fn posterior(
        &self,
        row: &Vector3<f64>,
        variance: f64,
        covariance: &Matrix3<f64>,
    ) -> Matrix3<f64> {
        let left = Matrix3::identity() - self.gain * row.transpose();
        symmetric(
            &(left * covariance * left.transpose() + self.gain * self.gain.transpose() * variance),
        )
    }
}
