//! Kalman filter, Rauch-Tung-Striebel smoother and disturbance smoother of a motion.

use nalgebra::{SMatrix, SVector, Vector3};

use crate::model::{symmetric, Square, State, Transition, Update};

/// Recorded motion at n instants; a reading with an infinite error variance is missing.
#[derive(Clone, Copy, Debug)]
pub struct Readings<'a> {
    /// Instants, s, not decreasing; shape (n,).
    pub time: &'a [f64],
    /// Positions, m or rad.
    pub position: &'a [f64],
    /// Error variances of the positions.
    pub position_variance: &'a [f64],
    /// Velocities, m/s or rad/s.
    pub velocity: &'a [f64],
    /// Error variances of the velocities.
    pub velocity_variance: &'a [f64],
    /// Time delay of the velocities, s: each reading is the velocity at this time before its
    /// instant.
    pub velocity_delay: f64,
    /// Measured linear functions of the motion, one for each instant; empty if there are none.
    pub linear: &'a [LinearReading],
}

/// Measured linear function `value = row . (position, velocity, acceleration) + e` of the motion,
/// `e ~ N(0, variance)`.
///
/// A reading with an infinite variance is missing.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinearReading {
    /// Coefficients of position, velocity and acceleration.
    pub row: Vector3<f64>,
    /// Measured value.
    pub value: f64,
    /// Error variance of the value.
    pub variance: f64,
}

/// Posterior distribution of a motion of order N, in SI units, or with radians in place of metres.
#[derive(Clone, Debug, Default)]
pub struct Smoothed<const N: usize> {
    /// Position, velocity, acceleration and further derivatives at each instant.
    pub mean: Vec<SVector<f64, N>>,
    /// Covariance of the state at each instant.
    pub covariance: Vec<SMatrix<f64, N, N>>,
    /// Gains of the posterior as a Markov chain backward in time, n - 1 matrices:
    /// `E[x[k] | x[k+1]] = mean[k] + gain[k] (x[k+1] - mean[k+1])`.
    pub gain: Vec<SMatrix<f64, N, N>>,
    /// Expected square `E[w' Q(h)^-1 w]` of the disturbance w of each step, where `Q(h)` is its
    /// covariance for process noise of unit intensity.
    ///
    /// The value is N q if the readings contain no information about the step, and NaN for a step
    /// of zero length.
    pub disturbance: Vec<f64>,
    /// Log-likelihood of the readings.
    pub log_likelihood: f64,
}

/// Computes the posterior of a motion of order N, whose N-th derivative is white noise.
///
/// # Arguments
/// * `intensity`: intensity of the process noise in each of the n - 1 steps, (m/s^N)^2 s.
///
/// Slices of different lengths are read up to the shortest.
///
/// # Algorithm
/// Readings at one instant are processed one after the other. Internally, time is measured in
/// median steps, so that the components of the state are of similar size.
pub fn smooth<const N: usize>(readings: &Readings, intensity: &[f64]) -> Smoothed<N> {
    let mut forward = Forward::<N>::default();
    forward.pass(readings, intensity);
    let n = forward.filtered.len();
    if n == 0 {
        return Smoothed::default();
    }
    let mut out = Smoothed {
        mean: vec![State::zeros(); n],
        covariance: vec![Square::zeros(); n],
        gain: vec![Square::zeros(); n - 1],
        disturbance: vec![f64::NAN; n - 1],
        log_likelihood: forward.log_likelihood,
    };
    // Conversion from the internal unit of time.
    let scale = State::<N>::from_fn(|i, _| forward.time.unit.powi(-(i as i32)));
    let scales = scale * scale.transpose();
    let ratios = scale * scale.map(f64::recip).transpose();
    let (last, mut spread) = forward.filtered[n - 1];
    out.mean[n - 1] = last.component_mul(&scale);
    out.covariance[n - 1] = spread.component_mul(&scales);
    forward.backward(readings, intensity, |k, step, adjoint, disturbance| {
        out.disturbance[k] = disturbance;
        let (own, own_spread) = forward.filtered[k];
        let f = step.matrix;
        // At the start of an exact record almost nothing is known. Its covariance is singular to
        // working precision there and, without a gain, remains that of the filter.
        let gain = match forward.predicted[k + 1].cholesky() {
            Some(factor) => factor.solve(&(f * own_spread)).transpose(),
            None => Square::zeros(),
        };
        let left = Square::identity() - gain * f;
        let noise = step.noise * (intensity[k] * forward.time.intensity);
        spread = symmetric(
            &(left * own_spread * left.transpose() + gain * (spread + noise) * gain.transpose()),
        );
        let after = own + own_spread * adjoint.state;
        out.mean[k] = after.component_mul(&scale);
        out.covariance[k] = spread.component_mul(&scales);
        out.gain[k] = gain.component_mul(&ratios);
    });
    out
}

/// Computes the log-likelihood of the readings, as returned by [`smooth`], without the smoother.
pub fn log_likelihood<const N: usize>(readings: &Readings, intensity: &[f64]) -> f64 {
    filter::<N>(readings, intensity, |_, _, _| ()).log_likelihood
}

type Estimate<const N: usize> = (State<N>, Square<N>);
type Updates<const N: usize> = [Option<(Update<N>, f64)>; 3];

/// States of the forward pass (Kalman filter), stored for the backward pass; later passes reuse the
/// memory of the first.
#[derive(Default)]
pub(crate) struct Forward<const N: usize> {
    pub time: TimeScale,
    pub log_likelihood: f64,
    /// Mean and covariance of each state given the readings up to its instant.
    pub filtered: Vec<Estimate<N>>,
    /// Covariance of each state given the readings before its instant.
    predicted: Vec<Square<N>>,
    updates: Vec<Updates<N>>,
}

/// Information about a state x in the readings after its instant: `E[x | all] = m + P state` and
/// `cov[x | all] = P - P square P`, where m and P are the filtered mean and covariance.
pub(crate) struct Adjoint<const N: usize> {
    pub state: State<N>,
    pub square: Square<N>,
}

impl<const N: usize> Adjoint<N> {
    /// Adjoint at the last instant, after which there is no reading.
    pub(crate) fn last() -> Self {
        Self {
            state: State::zeros(),
            square: Square::zeros(),
        }
    }
}

impl<const N: usize> Forward<N> {
    /// Computes and stores the filtered states for the readings.
    pub(crate) fn pass(&mut self, readings: &Readings, intensity: &[f64]) {
        self.filtered.clear();
        self.predicted.clear();
        self.updates.clear();
        let passed = filter::<N>(readings, intensity, |before, both, after| {
            self.predicted.push(before.1);
            self.updates.push(both);
            self.filtered.push(after);
        });
        (self.time, self.log_likelihood) = (passed.time, passed.log_likelihood);
    }

    /// Calls `visit` for each step from the last to the first.
    ///
    /// Its arguments are the index, the transition, the adjoint at the start of the step, and the
    /// expected squared disturbance ([`Smoothed::disturbance`]).
    pub(crate) fn backward(
        &self,
        readings: &Readings,
        intensity: &[f64],
        mut visit: impl FnMut(usize, &Transition<N>, &Adjoint<N>, f64),
    ) {
        let [position, velocity] = self.time.rows::<N>(readings);
        let mut adjoint = Adjoint::last();
        let mut step = Transition::over(0.0);
        for k in (0..self.filtered.len().saturating_sub(1)).rev() {
            let Adjoint { state: r, square } = &mut adjoint;
            let rows = [position, velocity, self.time.linear_row(readings, k + 1)];
            for (row, update) in rows.iter().zip(&self.updates[k + 1]).rev() {
                if let Some((update, innovation)) = update {
                    // With L = I - K row': r <- row e / S + L' r, N <- row row' / S + L' N L
                    // (Durbin & Koopman's symbols).
                    *r += row * (innovation / update.variance - update.gain.dot(r));
                    let of_gain = *square * update.gain;
                    let own = update.variance.recip() + update.gain.dot(&of_gain);
                    let half = row * (row * (0.5 * own) - of_gain).transpose();
                    *square += half + half.transpose();
                }
            }
            self.time.step(readings, k, &mut step);
            let q = intensity[k] * self.time.intensity;
            let disturbance = if step.h > 0.0 {
                // E[w' Q^-1 w] for w ~ N(q Q r, q Q - q Q N q Q).
                let noise = step.noise;
                let change = r.dot(&(noise * *r)) - noise.dot(square);
                (q * q * change + N as f64 * q).max(0.0) / self.time.intensity
            } else {
                f64::NAN
            };
            *r = step.matrix.tr_mul(r);
            *square = symmetric(&(step.matrix.tr_mul(square) * step.matrix));
            visit(k, &step, &adjoint, disturbance);
        }
    }
}

/// Internal unit of time, the median step.
#[derive(Clone, Copy, Default)]
pub(crate) struct TimeScale {
    /// Median step, s.
    pub unit: f64,
    /// Factor that converts the intensity of the process noise to the internal unit of time.
    pub intensity: f64,
}

impl TimeScale {
    fn new(time: &[f64], order: usize) -> Self {
        let unit = median_step(time);
        let intensity = unit.powi(2 * order as i32 - 1);
        Self { unit, intensity }
    }

    /// Coefficients of the position and of the recorded velocity as linear functions of the state.
    pub(crate) fn rows<const N: usize>(&self, readings: &Readings) -> [State<N>; 2] {
        let position = State::from_fn(|i, _| if i == 0 { 1.0 } else { 0.0 });
        [position, late_velocity(readings.velocity_delay / self.unit)]
    }

    /// Coefficients of the state in the linear reading at instant k; zero if there is none.
    fn linear_row<const N: usize>(&self, readings: &Readings, k: usize) -> State<N> {
        let mut row = State::zeros();
        if let Some(reading) = readings.linear.get(k) {
            for i in 0..N.min(3) {
                row[i] = reading.row[i] * self.unit.powi(-(i as i32));
            }
        }
        row
    }

    /// Sets `step` to the transition from instant k to k + 1.
    fn step<const N: usize>(&self, readings: &Readings, k: usize, step: &mut Transition<N>) {
        let h = (readings.time[k + 1] - readings.time[k]).max(0.0) / self.unit;
        if h != step.h {
            *step = Transition::over(h);
        }
    }
}

/// Results of the Kalman filter in addition to its states.
struct FilterOutput {
    time: TimeScale,
    log_likelihood: f64,
}

/// Runs the Kalman filter and calls `visit` at each instant.
///
/// Its arguments are the predicted state, the updates by the readings and the filtered state.
fn filter<const N: usize>(
    readings: &Readings,
    intensity: &[f64],
    mut visit: impl FnMut(Estimate<N>, Updates<N>, Estimate<N>),
) -> FilterOutput {
    let n = [
        readings.time.len(),
        readings.position.len(),
        readings.position_variance.len(),
        readings.velocity.len(),
        readings.velocity_variance.len(),
        intensity.len() + 1,
    ]
    .into_iter()
    .min()
    .unwrap_or(0);
    let time = TimeScale::new(&readings.time[..n], N);
    let unit = time.unit;
    let [position, velocity]: [State<N>; 2] = time.rows(readings);
    let mut log_likelihood = 0.0;
    let (mut mean, mut covariance): Estimate<N> = initial_state(readings, n, unit);
    let mut step = Transition::over(0.0);
    for k in 0..n {
        if k > 0 {
            time.step(readings, k - 1, &mut step);
            mean = step.matrix * mean;
            covariance = step.matrix * covariance * step.matrix.transpose()
                + step.noise * (intensity[k - 1] * time.intensity);
        }
        let before = (mean, covariance);
        let linear = readings
            .linear
            .get(k)
            .map_or((0.0, f64::INFINITY), |r| (r.value, r.variance));
        let read = [
            (readings.position[k], readings.position_variance[k]),
            (
                readings.velocity[k] * unit,
                readings.velocity_variance[k] * unit * unit,
            ),
            linear,
        ];
        let rows = [position, velocity, time.linear_row(readings, k)];
        let mut all = [None, None, None];
        for ((row, (value, variance)), kept) in rows.iter().zip(read).zip(&mut all) {
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
        if all[1].is_some() {
            // The velocity was scaled: converts its density back to per (m/s).
            log_likelihood += unit.ln();
        }
        visit(before, all, (mean, covariance));
    }
    FilterOutput {
        time,
        log_likelihood,
    }
}

/// Coefficients of the velocity at `delay` before an instant, as a linear function of the state.
fn late_velocity<const N: usize>(delay: f64) -> State<N> {
    let mut row = State::zeros();
    let mut term = 1.0;
    for i in 1..N {
        row[i] = term;
        term *= -delay / i as f64;
    }
    row
}

/// Initial state with a weakly informative distribution.
///
/// The mean position is the first reading (zero if there is none). The standard deviation of the
/// velocity is the largest one recorded, and that of further derivatives is this velocity per step.
fn initial_state<const N: usize>(readings: &Readings, n: usize, unit: f64) -> Estimate<N> {
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
    let (mut mean, mut variance) = (State::zeros(), State::from_element(top * top));
    (mean[0], variance[0]) = (first, 1e4 * noise);
    (mean, Square::from_diagonal(&variance))
}

/// Median of the positive steps, s; 1 if there are none.
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
