//! Whitening of residuals that contain the errors of a recorded motion.

use nalgebra::{SMatrix, Vector3};

use crate::model::{symmetric, State, Update};

/// Whitens columns of residuals that contain the errors of a motion, in place.
///
/// A residual is `r[k] = e[k] + s[k] (x[k] - mean[k])`, with independent `e[k] ~ N(0, variance[k])`
/// and x the motion of a posterior.
///
/// # Arguments
/// * `posterior`, `gain`: covariances and gains of the motion, see [`crate::Smoothed`].
/// * `sensitivity`: s, derivatives of the prediction with respect to position, velocity and
///   acceleration, (n,).
/// * `variance`: of e, (n,); a sample with an infinite variance is excluded and set to zero.
/// * `columns`: n rows of `width` values, for instance the residual and its derivatives with
///   respect to parameters; each column is filtered in the same way.
///
/// Returns the logarithm of the determinant of the covariance of the included samples.
///
/// # Algorithm
/// The posterior is a Markov chain backward in time. A Kalman filter along it, from the last sample
/// to the first, has independent innovations.
pub fn whiten<const N: usize>(
    posterior: &[SMatrix<f64, N, N>],
    gain: &[SMatrix<f64, N, N>],
    sensitivity: &[Vector3<f64>],
    variance: &[f64],
    width: usize,
    columns: &mut [f64],
) -> f64 {
    let n = posterior
        .len()
        .min(gain.len() + 1)
        .min(sensitivity.len())
        .min(variance.len());
    if n == 0 || width == 0 || columns.len() < n * width {
        return 0.0;
    }
    // States in units of their standard errors, which differ by many powers of ten.
    let standard_error = |v: f64| if v > 0.0 { v.sqrt() } else { 1.0 };
    let scale: Vec<State<N>> = posterior[..n]
        .iter()
        .map(|p| p.diagonal().map(standard_error))
        .collect();
    let scaled = |k: usize| posterior[k].component_div(&(scale[k] * scale[k].transpose()));
    let mut covariance = scaled(n - 1);
    let mut means = vec![State::zeros(); width];
    let mut log_determinant = 0.0;
    for k in (0..n).rev() {
        if k + 1 < n {
            let ratios = scale[k].map(f64::recip) * scale[k + 1].transpose();
            let back = gain[k].component_mul(&ratios);
            // Covariance of x[k] given x[k+1], plus the contribution of the uncertainty of x[k+1].
            covariance =
                symmetric(&(scaled(k) + back * (covariance - scaled(k + 1)) * back.transpose()));
            for mean in &mut means {
                *mean = back * *mean;
            }
        }
        let values = &mut columns[k * width..(k + 1) * width];
        if !variance[k].is_finite() {
            values.fill(0.0);
            continue;
        }
        let row = State::from_fn(|i, _| sensitivity[k].get(i).map_or(0.0, |s| s * scale[k][i]));
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
