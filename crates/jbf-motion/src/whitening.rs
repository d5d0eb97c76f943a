//! Whitening of residuals that contain the errors of a recorded motion.

use crate::model::{symmetric, Square, State, Update};
use nalgebra::Vector3;

/// Errors of a motion as a Markov chain backward in time, in units of their standard errors.
///
/// The standard errors of position, velocity and acceleration differ by many powers of ten.
#[derive(Clone, Debug)]
pub struct ErrorChain<const N: usize> {
    /// Standard error of each state.
    scale: Vec<State<N>>,
    /// Regression of the errors at an instant on those at the next one; zero at the last instant.
    back: Vec<Square<N>>,
    /// Covariance at an instant given the errors at the next one.
    conditional: Vec<Square<N>>,
}

impl<const N: usize> ErrorChain<N> {
    /// Creates the chain from the posterior covariances and gains of a motion, see
    /// [`crate::Smoothed`].
    pub fn new(posterior: &[Square<N>], gain: &[Square<N>]) -> Self {
        let n = posterior.len().min(gain.len() + 1);
        let standard_error = |v: f64| if v > 0.0 { v.sqrt() } else { 1.0 };
        let scale: Vec<State<N>> = posterior[..n]
            .iter()
            .map(|p| p.diagonal().map(standard_error))
            .collect();
        let scaled: Vec<Square<N>> = posterior
            .iter()
            .zip(&scale)
            .map(|(p, s)| p.component_div(&(s * s.transpose())))
            .collect();
        let last = n.saturating_sub(1);
        let back: Vec<Square<N>> = (0..n)
            .map(|k| {
                if k == last {
                    return Square::zeros();
                }
                let ratios = scale[k].map(f64::recip) * scale[k + 1].transpose();
                gain[k].component_mul(&ratios)
            })
            .collect();
        let conditional = (0..n)
            .map(|k| {
                if k == last {
                    return scaled[k];
                }
                scaled[k] - back[k] * scaled[k + 1] * back[k].transpose()
            })
            .collect();
        Self {
            scale,
            back,
            conditional,
        }
    }

    /// Number of instants.
    pub fn len(&self) -> usize {
        self.scale.len()
    }

    /// Returns true if the chain has no instant.
    pub fn is_empty(&self) -> bool {
        self.scale.is_empty()
    }

    /// Whitens columns of residuals that contain the errors of the motion, in place.
    ///
    /// A residual is `r[k] = e[k] + s[k] (x[k] - mean[k])`, with independent `e[k] ~ N(0,
    /// variance[k])` and x the motion of a posterior.
    ///
    /// # Arguments
    /// * `sensitivity`: s, derivatives of the prediction with respect to position, velocity and
    ///   acceleration, for each of n instants; in units of the residual per unit of each.
    /// * `variance`: of e, (n,); a sample with an infinite variance is excluded and set to zero.
    /// * `columns`: n rows of `width` values, for instance the residual and its derivatives with
    ///   respect to parameters; each column is filtered in the same way.
    ///
    /// Returns the logarithm of the determinant of the covariance of the included samples.
    ///
    /// # Algorithm
    /// The posterior is a Markov chain backward in time. A Kalman filter along it, from the last
    /// sample to the first, has independent innovations.
    pub fn whiten(
        &self,
        sensitivity: &[Vector3<f64>],
        variance: &[f64],
        width: usize,
        columns: &mut [f64],
    ) -> f64 {
        let n = self.len().min(sensitivity.len()).min(variance.len());
        if n == 0 || width == 0 || columns.len() < n * width {
            return 0.0;
        }
        let mut covariance = Square::zeros();
        let mut means = vec![State::zeros(); width];
        let mut log_determinant = 0.0;
        for k in (0..n).rev() {
            let back = &self.back[k];
            covariance = symmetric(&(self.conditional[k] + back * covariance * back.transpose()));
            for mean in &mut means {
                *mean = back * *mean;
            }
            let values = &mut columns[k * width..(k + 1) * width];
            if !variance[k].is_finite() {
                values.fill(0.0);
                continue;
            }
            let scale = &self.scale[k];
            let row = State::from_fn(|i, _| sensitivity[k].get(i).map_or(0.0, |s| s * scale[i]));
            let update = Update::new(&row, variance[k], &covariance);
            let standard = update.variance.sqrt();
            for (value, mean) in values.iter_mut().zip(&mut means) {
                let innovation = *value - row.dot(mean);
                *mean += update.gain * innovation;
                *value = innovation / standard;
            }
            covariance = update.posterior(&row, variance[k], &covariance);
            log_determinant += update.variance.ln();
        }
        log_determinant
    }
}
