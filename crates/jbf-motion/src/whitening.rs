//! Whitening of residuals that contain the errors of a recorded motion.

use crate::model::{symmetric, Square, State, Update};
use nalgebra::{SMatrix, SVector, Vector3};

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

    /// Creates the filter that whitens residuals with errors of the motion.
    ///
    /// A residual is `r[k] = e[k] / weight[k] + s[k] (x[k] - mean[k])`, with independent
    /// `e[k] ~ N(0, 1)` and x the motion of a posterior.
    ///
    /// # Arguments
    /// * `sensitivity`: s, derivatives of the prediction with respect to position, velocity and
    ///   acceleration, for each of n instants; in standard deviations of e per unit of each.
    /// * `weight`: (n,); a sample with weight zero is excluded.
    ///
    /// # Algorithm
    /// The posterior is a Markov chain backward in time. A Kalman filter along it, from the last
    /// sample to the first, has independent innovations. Its gains do not depend on the residuals.
    pub fn filter(&self, sensitivity: &[Vector3<f64>], weight: &[f64]) -> WhiteningFilter<N> {
        let n = self.len().min(sensitivity.len()).min(weight.len());
        let mut covariance = Square::zeros();
        let mut log_determinant = 0.0;
        let mut steps = Vec::with_capacity(n);
        for k in (0..n).rev() {
            let back = &self.back[k];
            covariance = symmetric(&(self.conditional[k] + back * covariance * back.transpose()));
            let mut step = FilterStep {
                back: *back,
                row: State::zeros(),
                gain: State::zeros(),
                reciprocal: 0.0,
            };
            let variance = weight[k].powi(-2);
            if variance.is_finite() {
                let scale = &self.scale[k];
                step.row =
                    State::from_fn(|i, _| sensitivity[k].get(i).map_or(0.0, |s| s * scale[i]));
                let update = Update::new(&step.row, variance, &covariance);
                step.gain = update.gain;
                step.reciprocal = update.variance.sqrt().recip();
                covariance = update.posterior(&step.row, variance, &covariance);
                log_determinant += update.variance.ln();
            }
            steps.push(step);
        }
        WhiteningFilter {
            steps,
            log_determinant,
        }
    }
}

/// Filter that whitens residuals of one run, see [`ErrorChain::filter`].
#[derive(Clone, Debug)]
pub struct WhiteningFilter<const N: usize> {
    /// Steps from the last sample to the first.
    steps: Vec<FilterStep<N>>,
    /// Logarithm of the determinant of the covariance of the included samples.
    pub log_determinant: f64,
}

/// Step of a filter to the preceding sample.
#[derive(Clone, Debug)]
struct FilterStep<const N: usize> {
    /// Regression of the errors on those at the sample of the last step.
    back: Square<N>,
    /// Sensitivity of the residual to the errors.
    row: State<N>,
    /// Gain of the filter.
    gain: State<N>,
    /// Reciprocal of the standard deviation of the innovation; zero for an excluded sample.
    reciprocal: f64,
}

impl<const N: usize> WhiteningFilter<N> {
    /// Whitens columns in place; excluded samples are set to zero.
    ///
    /// # Arguments
    /// * `columns`: n rows of `width` values, for instance the residual and its derivatives with
    ///   respect to parameters; each column is filtered in the same way.
    pub fn whiten(&self, width: usize, columns: &mut [f64]) {
        let mut first = 0;
        while first < width {
            first += match width - first {
                8.. => self.whiten_columns::<8>(first, width, columns),
                4.. => self.whiten_columns::<4>(first, width, columns),
                2.. => self.whiten_columns::<2>(first, width, columns),
                _ => self.whiten_columns::<1>(first, width, columns),
            };
        }
    }

    /// Whitens `W` adjacent columns, and returns `W`.
    fn whiten_columns<const W: usize>(
        &self,
        first: usize,
        width: usize,
        columns: &mut [f64],
    ) -> usize {
        let mut means = SMatrix::<f64, W, N>::zeros();
        for (step, row) in self.steps.iter().zip(columns.chunks_exact_mut(width).rev()) {
            means *= step.back.transpose();
            let values = &mut row[first..first + W];
            if step.reciprocal == 0.0 {
                values.fill(0.0);
                continue;
            }
            let innovation = SVector::<f64, W>::from_column_slice(values) - means * step.row;
            means += innovation * step.gain.transpose();
            values.copy_from_slice((innovation * step.reciprocal).as_slice());
        }
        W
    }
}
