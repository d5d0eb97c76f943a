//! Kalman filter, Rauch-Tung-Striebel smoother and disturbance smoother of a motion.

use nalgebra::{Matrix3, Vector3};

use crate::model::{process_noise, symmetric, transition, Update};

/// What was recorded of a motion, at n instants. A reading with an infinite variance is missing.
#[derive(Clone, Copy, Debug)]
pub struct Readings<'a> {
    /// Instants, s, not decreasing; shape (n,).
    pub time: &'a [f64],
    /// Positions, m or rad.
    pub position: &'a [f64],
    /// Their error variances.
    pub position_variance: &'a [f64],
    /// Velocities, m/s or rad/s.
    pub velocity: &'a [f64],
    /// Their error variances.
    pub velocity_variance: &'a [f64],
    /// How late the velocities are, s: each is that of so long before its instant.
    pub velocity_delay: f64,
}

/// The posterior of a motion; in SI units, or radians in place of metres.
#[derive(Clone, Debug, Default)]
pub struct Smoothed {
    /// Position, velocity and acceleration at each instant.
    pub mean: Vec<[f64; 3]>,
    /// Their covariance, by rows.
    pub covariance: Vec<[[f64; 3]; 3]>,
    /// Gains of the posterior as a Markov chain backward in time, n - 1 matrices by rows:
    /// `E[x[k] | x[k+1]] = mean[k] + gain[k] (x[k+1] - mean[k+1])`.
    pub gain: Vec<[[f64; 3]; 3]>,
    /// Expected square `E[w' Q(h)^-1 w]` of the disturbance of each step for a jerk of unit
    /// intensity; 3 q where the readings do not tell. NaN where the step is zero.
    pub disturbance: Vec<f64>,
    /// Logarithm of the likelihood of the readings.
    pub log_likelihood: f64,
}

/// Smooth a motion.
///
/// # Arguments
/// * `jerk`: intensity of the jerk in each of the n - 1 steps, (m/s^3)^2 s.
///
/// Slices of other lengths are read as far as the shortest.
///
/// # Algorithm
/// Readings of one instant are processed one after the other. Inside, time is counted in median
/// steps, so that the three components of the state are of similar size.
pub fn smooth(readings: &Readings, jerk: &[f64]) -> Smoothed {
    let (mut predicted, mut filtered, mut updates) = (Vec::new(), Vec::new(), Vec::new());
    let passed = filter(readings, jerk, |before, both, after| {
        predicted.push(before);
        updates.push(both);
        filtered.push(after);
    });
    let (n, unit, rows, log_likelihood) = (
        filtered.len(),
        passed.unit,
        passed.rows,
        passed.log_likelihood,
    );
    if n == 0 {
        return Smoothed::default();
    }
    let step = |k: usize| scaled_step(readings, jerk, k, unit);
    let mut out = Smoothed {
        mean: vec![[0.0; 3]; n],
        covariance: vec![[[0.0; 3]; 3]; n],
        gain: vec![[[0.0; 3]; 3]; n - 1],
        disturbance: vec![f64::NAN; n - 1],
        log_likelihood,
    };
    let scale = Vector3::new(1.0, 1.0 / unit, 1.0 / (unit * unit));
    let (mut after, mut spread) = filtered[n - 1];
    store(&mut out, n - 1, &after, &spread, &scale);
    let (mut r, mut big) = (Vector3::zeros(), Matrix3::zeros());
    for k in (0..n - 1).rev() {
        let (h, q) = step(k);
        let f = transition(h);
        for (row, update) in rows.iter().zip(&updates[k + 1]).rev() {
            if let Some((update, innovation)) = update {
                let l = Matrix3::identity() - update.gain * row.transpose();
                r = row * (innovation / update.variance) + l.transpose() * r;
                big = row * row.transpose() / update.variance + l.transpose() * big * l;
            }
        }
        if h > 0.0 {
            // E[w' Q^-1 w] for w ~ N(q Q r, q Q - q Q N q Q).
            let noise = process_noise(h);
            let square = q * q * (r.dot(&(noise * r)) - (noise * big).trace()) + 3.0 * q;
            out.disturbance[k] = square.max(0.0) / unit.powi(5);
        }
        r = f.transpose() * r;
        big = symmetric(&(f.transpose() * big * f));

        let (own, own_spread) = filtered[k];
        let (ahead, ahead_spread) = predicted[k + 1];
        let gain = match ahead_spread.cholesky() {
            Some(factor) => factor.solve(&(f * own_spread)).transpose(),
            None => Matrix3::zeros(),
        };
        let left = Matrix3::identity() - gain * f;
        let mean = own + gain * (after - ahead);
        spread = symmetric(
            &(left * own_spread * left.transpose()
                + gain * (spread + process_noise(h) * q) * gain.transpose()),
        );
        after = mean;
        store(&mut out, k, &after, &spread, &scale);
        for i in 0..3 {
            for j in 0..3 {
                out.gain[k][i][j] = gain[(i, j)] * scale[i] / scale[j];
            }
        }
    }
    out
}

/// Logarithm of the likelihood of the readings, as [`smooth`] returns it, by the filter alone.
pub fn log_likelihood(readings: &Readings, jerk: &[f64]) -> f64 {
    filter(readings, jerk, |_, _, _| ()).log_likelihood
}

type State = (Vector3<f64>, Matrix3<f64>);
type Updates = [Option<(Update, f64)>; 2];

/// What the filter passes on besides its states.
struct Passed {
    unit: f64,
    rows: [Vector3<f64>; 2],
    log_likelihood: f64,
}

/// Length of a step and intensity of its jerk, in units of the median step.
fn scaled_step(readings: &Readings, jerk: &[f64], k: usize, unit: f64) -> (f64, f64) {
    let h = (readings.time[k + 1] - readings.time[k]).max(0.0) / unit;
    (h, jerk[k] * unit.powi(5))
}

/// Kalman filter; calls `visit` at each instant with the predicted state, the updates by the
/// readings and the filtered state.
fn filter(
    readings: &Readings,
    jerk: &[f64],
    mut visit: impl FnMut(State, Updates, State),
) -> Passed {
    let n = [
        readings.time.len(),
        readings.position.len(),
        readings.position_variance.len(),
        readings.velocity.len(),
        readings.velocity_variance.len(),
        jerk.len() + 1,
    ]
    .into_iter()
    .min()
    .unwrap_or(0);
    let unit = median_step(&readings.time[..n]);
    let rows = [
        Vector3::new(1.0, 0.0, 0.0),
        Vector3::new(0.0, 1.0, -readings.velocity_delay / unit),
    ];
    let mut log_likelihood = 0.0;
    let (mut mean, mut covariance) = diffuse(readings, n, unit);
    for k in 0..n {
        if k > 0 {
            let (h, q) = scaled_step(readings, jerk, k - 1, unit);
            let f = transition(h);
            mean = f * mean;
            covariance = symmetric(&(f * covariance * f.transpose() + process_noise(h) * q));
        }
        let before = (mean, covariance);
        let pair = [
            (readings.position[k], readings.position_variance[k]),
            (
                readings.velocity[k] * unit,
                readings.velocity_variance[k] * unit * unit,
            ),
        ];
        let mut both = [None, None];
        for ((row, (value, variance)), kept) in rows.iter().zip(pair).zip(&mut both) {
            if variance.is_finite() && value.is_finite() {
                let update = Update::new(row, variance, &covariance);
                let innovation = value - row.dot(&mean);
                mean += update.gain * innovation;
                covariance = update.posterior(row, variance, &covariance);
                log_likelihood -= 0.5
                    * (innovation * innovation / update.variance
                        + (core::f64::consts::TAU * update.variance).ln());
                *kept = Some((update, innovation));
            }
        }
        if both[1].is_some() {
            // The velocity was scaled: its density is per (m/s) again.
            log_likelihood += unit.ln();
        }
        visit(before, both, (mean, covariance));
    }
    Passed {
        unit,
        rows,
        log_likelihood,
    }
}

fn store(
    out: &mut Smoothed,
    k: usize,
    mean: &Vector3<f64>,
    covariance: &Matrix3<f64>,
    scale: &Vector3<f64>,
) {
    for i in 0..3 {
        out.mean[k][i] = mean[i] * scale[i];
        for j in 0..3 {
            out.covariance[k][i][j] = covariance[(i, j)] * scale[i] * scale[j];
        }
    }
}

/// A start that tells next to nothing: position near the first reading, any velocity up to the
/// largest one on record and any acceleration up to that velocity in one step.
fn diffuse(readings: &Readings, n: usize, unit: f64) -> (Vector3<f64>, Matrix3<f64>) {
    let seen =
        |k: &usize| readings.position_variance[*k].is_finite() && readings.position[*k].is_finite();
    let (mut first, mut noise, mut top) = (0.0, 0.0, 0.0_f64);
    if let Some(k) = (0..n).find(seen) {
        (first, noise) = (readings.position[k], readings.position_variance[k]);
    }
    let mut before: Option<usize> = None;
    for k in (0..n).filter(seen) {
        if let Some(j) = before {
            let h = (readings.time[k] - readings.time[j]) / unit;
            let gone = (readings.position[k] - readings.position[j]).abs();
            if h > 0.0 {
                top = top.max(gone / h.max(1.0));
            }
        }
        before = Some(k);
    }
    for k in 0..n {
        if readings.velocity_variance[k].is_finite() && readings.velocity[k].is_finite() {
            top = top.max(readings.velocity[k].abs() * unit);
            top = top.max(readings.velocity_variance[k].sqrt() * unit);
        }
    }
    top = 10.0 * top.max(noise.sqrt()).max(f64::MIN_POSITIVE.sqrt());
    (
        Vector3::new(first, 0.0, 0.0),
        Matrix3::from_diagonal(&Vector3::new(1e4 * noise, top * top, top * top)),
    )
}

/// The median of the positive steps, s; 1 without any.
fn median_step(time: &[f64]) -> f64 {
    let mut steps: Vec<f64> = time
        .windows(2)
        .map(|w| w[1] - w[0])
        .filter(|h| *h > 0.0 && h.is_finite())
        .collect();
    if steps.is_empty() {
        return 1.0;
    }
    let middle = steps.len() / 2;
    *steps.select_nth_unstable_by(middle, f64::total_cmp).1
}
