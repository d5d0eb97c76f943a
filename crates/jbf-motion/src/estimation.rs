//! Errors of the readings of a motion, and its corners (steps with a high intensity of the process
//! noise), by expectation-maximisation (EM).

use core::ops::Range;

use crate::smoother::{Adjoint, Forward, LinearReading, Readings};

/// Degrees of freedom of the t distribution of the process noise; with few, corners are sharp.
const FREEDOM: u32 = 2;
/// Relative change of intensity and variances in one EM pass below which the iteration ends.
const SETTLED: f64 = 0.01;
/// Smallest number of EM passes with the t distribution.
const FEWEST: usize = 3;
/// Smallest intensity of the process noise, a limit that keeps its logarithm finite.
const LEAST: f64 = 1e-300;

/// Recorded motion at n instants, with errors that are to be estimated.
#[derive(Clone, Copy, Debug)]
pub struct Record<'a> {
    /// Instants, s, not decreasing; shape (n,).
    pub time: &'a [f64],
    /// Positions, m or rad; NaN for a missing reading.
    pub position: &'a [f64],
    /// Relative standard errors of the positions: factors of the standard error in
    /// [`ReadingErrors`].
    pub position_shape: &'a [f64],
    /// Smallest variance of a position, from the step of an encoder, m^2 (or rad^2).
    pub position_floor: f64,
    /// Velocities, m/s or rad/s; NaN for a missing reading.
    pub velocity: &'a [f64],
    /// Relative standard errors of the velocities.
    pub velocity_shape: &'a [f64],
    /// Smallest variance of a velocity, (m/s)^2.
    pub velocity_floor: f64,
    /// Relative standard error up to which a velocity is assigned instead of measured.
    ///
    /// Assigned velocities are not used in the estimate of the variance of the velocities.
    pub assigned: f64,
    /// Measured linear functions of the motion, one for each instant; empty if there are none.
    pub linear: &'a [LinearReading],
    /// True for each step that has the same factor of the intensity as the previous step; empty if
    /// each step has its own.
    pub continues: &'a [bool],
}

/// Error variances of the readings of a motion, and the intensity of its process noise.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ReadingErrors {
    /// Variance of the positions, m^2 (or rad^2).
    pub position_variance: f64,
    /// Variance of the velocities, (m/s)^2 (or (rad/s)^2).
    pub velocity_variance: f64,
    /// Variance of the instants, s^2; it adds `v^2 stamp_variance` to the variance of the position.
    pub stamp_variance: f64,
    /// Intensity of the process noise of a motion of order N, (m/s^N)^2 s.
    pub intensity: f64,
    /// Time delay of the velocities, s.
    pub velocity_delay: f64,
}

/// Largest numbers of EM passes of [`estimate`].
#[derive(Clone, Copy, Debug)]
pub struct Passes {
    /// First passes, in which the factors of the intensity are constant.
    pub normal: usize,
    /// Further passes with Student-t process noise, in which the factor of the intensity in each
    /// step is estimated.
    pub robust: usize,
}

/// Quantities that [`estimate`] holds at their start values.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Known {
    /// None: error variances of the readings and intensity are estimated.
    Nothing,
    /// The intensity.
    Intensity,
    /// Error variances of the readings and the intensity; only the factors of the intensity are
    /// estimated.
    Everything,
}

/// Error variances of the positions and of the velocities; infinite where a reading is missing.
#[derive(Clone, Debug, Default)]
struct Variances {
    position: Vec<f64>,
    velocity: Vec<f64>,
}

impl Record<'_> {
    fn variances(&self, errors: &ReadingErrors, speed: &[f64], out: &mut Variances) {
        let of = |value: f64, variance: f64| {
            if value.is_finite() {
                variance
            } else {
                f64::INFINITY
            }
        };
        let positions = self.position.iter().zip(self.position_shape).zip(speed);
        out.position.clear();
        out.position.extend(positions.map(|((&y, shape), v)| {
            of(
                y,
                errors.position_variance * shape * shape + errors.stamp_variance * v * v,
            )
        }));
        let velocities = self.velocity.iter().zip(self.velocity_shape);
        out.velocity.clear();
        out.velocity
            .extend(velocities.map(|(&y, shape)| of(y, errors.velocity_variance * shape * shape)));
    }

    fn readings<'a>(&'a self, errors: &ReadingErrors, variances: &'a Variances) -> Readings<'a> {
        Readings {
            time: self.time,
            position: self.position,
            position_variance: &variances.position,
            velocity: self.velocity,
            velocity_variance: &variances.velocity,
            velocity_delay: errors.velocity_delay,
            linear: self.linear,
        }
    }

    /// Ranges of adjacent steps that share a factor of the intensity.
    fn intervals(&self, steps: usize) -> impl Iterator<Item = Range<usize>> + '_ {
        let mut first = 0;
        (1..=steps).filter_map(move |end| {
            if self.continues.get(end).is_some_and(|same| *same) {
                return None;
            }
            let interval = first..end;
            first = end;
            Some(interval)
        })
    }

    /// Calls `using` with the readings, including their error variances, and the intensity of each
    /// step.
    ///
    /// # Arguments
    /// * `corners`: factor of the intensity in each of the n - 1 steps.
    /// * `speed`: a velocity at each instant, for the effect of the errors of the time stamps.
    pub fn with<T>(
        &self,
        errors: &ReadingErrors,
        corners: &[f64],
        speed: &[f64],
        using: impl FnOnce(&Readings, &[f64]) -> T,
    ) -> T {
        let mut variances = Variances::default();
        self.variances(errors, speed, &mut variances);
        let intensity: Vec<f64> = corners.iter().map(|c| c * errors.intensity).collect();
        using(&self.readings(errors, &variances), &intensity)
    }
}

/// Estimates the errors of the readings and the factor of the intensity in each step, from start
/// values.
///
/// The process noise of the motion follows a t distribution: a normal distribution whose intensity
/// `q c[k]` in step k has a factor `c[k]` with an inverse gamma distribution. EM maximises the
/// likelihood over q and the variances of the readings.
///
/// # Arguments
/// * `corners`: start values of the factors, n - 1.
/// * `known`: quantities that keep their start values.
///
/// # Sources
/// Shumway & Stoffer (1982) (EM for state-space models); Lange, Little & Taylor (1989) (EM for the
/// t distribution).
#[must_use]
pub fn estimate<const N: usize>(
    record: &Record,
    start: ReadingErrors,
    mut corners: Vec<f64>,
    passes: Passes,
    known: Known,
) -> (ReadingErrors, Vec<f64>) {
    let n = record.time.len();
    if n < 2 || corners.len() != n - 1 {
        return (start, corners);
    }
    let mut errors = start;
    let mut expected = Expectations::<N>::new(n);
    for pass in 0..passes.normal + passes.robust {
        expected.update(record, &errors, &corners);
        if pass >= passes.normal {
            for steps in record.intervals(corners.len()) {
                let corner = factor::<N>(&expected.disturbance[steps.clone()], errors.intensity);
                corners[steps].fill(corner);
            }
        }
        if known == Known::Everything {
            continue;
        }
        let previous = errors;
        errors = expected.maximised(record, &errors, &corners);
        if known == Known::Intensity {
            errors.intensity = start.intensity;
        }
        let change = |of: fn(&ReadingErrors) -> f64| (of(&errors) / of(&previous)).ln().abs();
        let most = change(|e| e.intensity)
            .max(change(|e| e.position_variance))
            .max(change(|e| e.velocity_variance));
        if pass >= passes.normal + FEWEST && most < SETTLED {
            break;
        }
    }
    (errors, corners)
}

/// Variational lower bound of the log-likelihood, marginal over the factors of all steps.
///
/// With `w = 1 / c` the bound is `log p(y | E w) + sum(N / 2 (E log w - log E w) - KL)`. KL is the
/// Kullback-Leibler divergence of the posterior of w, a gamma distribution, from its prior. The
/// value is a bound at a fixed point of EM, and approximately a bound before.
///
/// # Sources
/// Bishop, *Pattern Recognition and Machine Learning* (2006), section 10.1.
#[must_use]
pub fn lower_bound<const N: usize>(
    record: &Record,
    errors: &ReadingErrors,
    corners: &[f64],
    speed: &[f64],
) -> f64 {
    let mut forward = Forward::<N>::default();
    let prior = 0.5 * f64::from(FREEDOM);
    record.with(errors, corners, speed, |readings, intensity| {
        forward.pass(readings, intensity);
        let mut disturbances = vec![f64::NAN; corners.len()];
        forward.backward(readings, intensity, |k, _, _, disturbance| {
            disturbances[k] = disturbance;
        });
        let mut bound = forward.log_likelihood;
        for steps in record.intervals(corners.len()) {
            let (square, count) = total::<N>(&disturbances[steps], errors.intensity);
            if count > 0 {
                let half = 0.5 * f64::from(count);
                let (shape, rate) = (prior + half, prior + 0.5 * square);
                let (ln_gamma, digamma) = gamma_of_half(FREEDOM + count);
                bound += half * (digamma - shape.ln()) - half * digamma + ln_gamma
                    - gamma_of_half(FREEDOM).0
                    - prior * (rate / prior).ln()
                    - shape * (prior - rate) / rate;
            }
        }
        bound
    })
}

/// Sum of the squared disturbances in an interval of steps, relative to the intensity, and the
/// number of components of the disturbances.
///
/// Steps of zero length have no disturbance.
fn total<const N: usize>(disturbance: &[f64], intensity: f64) -> (f64, u32) {
    let finite = disturbance.iter().filter(|d| d.is_finite());
    finite.fold((0.0, 0), |(sum, count), d| {
        (sum + d / intensity, count + N as u32)
    })
}

/// Factor of the intensity of an interval: reciprocal of the posterior mean of the precision `1 /
/// c`.
fn factor<const N: usize>(disturbance: &[f64], intensity: f64) -> f64 {
    let (square, count) = total::<N>(disturbance, intensity);
    let freedom = f64::from(FREEDOM);
    if count == 0 || !square.is_finite() {
        return 1.0;
    }
    (freedom + square) / (freedom + f64::from(count))
}

/// Logarithm of the gamma function and its derivative (digamma function) at n / 2, n > 0, by
/// recurrence.
fn gamma_of_half(n: u32) -> (f64, f64) {
    const EULER: f64 = 0.577_215_664_901_532_9;
    let (mut x, mut ln_gamma, mut digamma) = if n.is_multiple_of(2) {
        (1.0, 0.0, -EULER)
    } else {
        let half = 0.5 * core::f64::consts::PI.ln();
        (0.5, half, -EULER - 2.0 * core::f64::consts::LN_2)
    };
    while x < 0.5 * f64::from(n) {
        ln_gamma += f64::ln(x);
        digamma += 1.0 / x;
        x += 1.0;
    }
    (ln_gamma, digamma)
}

/// Posterior expectations for the maximisation step of EM; later passes reuse the memory of the
/// first.
struct Expectations<const N: usize> {
    forward: Forward<N>,
    variances: Variances,
    intensity: Vec<f64>,
    /// Posterior mean of the velocity at each instant, m/s or rad/s.
    speed: Vec<f64>,
    /// Expected squared errors of the position readings and of the velocity readings.
    squares: [Vec<f64>; 2],
    /// Expected squared disturbance of each step.
    disturbance: Vec<f64>,
}

impl<const N: usize> Expectations<N> {
    fn new(n: usize) -> Self {
        Self {
            forward: Forward::default(),
            variances: Variances::default(),
            intensity: Vec::new(),
            speed: vec![0.0; n],
            squares: [vec![0.0; n], vec![0.0; n]],
            disturbance: vec![f64::NAN; n - 1],
        }
    }

    fn update(&mut self, record: &Record, errors: &ReadingErrors, corners: &[f64]) {
        record.variances(errors, &self.speed, &mut self.variances);
        self.intensity.clear();
        self.intensity
            .extend(corners.iter().map(|c| c * errors.intensity));
        let readings = record.readings(errors, &self.variances);
        self.forward.pass(&readings, &self.intensity);
        let (forward, unit) = (&self.forward, self.forward.time.unit);
        let rows = forward.time.rows::<N>(&readings);
        let (speed, squares, disturbances) =
            (&mut self.speed, &mut self.squares, &mut self.disturbance);
        let mut keep = |k: usize, adjoint: &Adjoint<N>| {
            let (mean, covariance) = &forward.filtered[k];
            let mean = mean + covariance * adjoint.state;
            speed[k] = mean[1] / unit;
            let values = [readings.position[k], readings.velocity[k] * unit];
            for ((row, value), square) in rows.iter().zip(values).zip(squares.iter_mut()) {
                let spread = covariance * row;
                let variance = row.dot(&spread) - spread.dot(&(adjoint.square * spread));
                square[k] = (value - row.dot(&mean)).powi(2) + variance.max(0.0);
            }
            squares[1][k] /= unit * unit;
        };
        keep(record.time.len() - 1, &Adjoint::last());
        forward.backward(&readings, &self.intensity, |k, _, adjoint, disturbance| {
            disturbances[k] = disturbance;
            keep(k, adjoint);
        });
    }

    /// Returns the error variances and the intensity that maximise the expected likelihood.
    fn maximised(&self, record: &Record, errors: &ReadingErrors, corners: &[f64]) -> ReadingErrors {
        let mut found = *errors;
        let steps = self.disturbance.iter().zip(corners);
        let intensity = mean(steps.map(|(square, corner)| square / corner)) / N as f64;
        found.intensity = intensity.max(LEAST);
        // Expected squares of the two errors that contribute to each residual of the position.
        let (mut weights, mut of_position, mut of_stamp) = (0.0, 0.0, 0.0);
        for (k, y) in record.position.iter().enumerate() {
            if y.is_finite() {
                let weight = record.position_shape[k].powi(-2);
                let own = errors.position_variance / weight;
                let by_stamp = errors.stamp_variance * self.speed[k].powi(2);
                let total = own + by_stamp;
                let excess = (self.squares[0][k] - total) / (total * total);
                weights += weight;
                of_position += weight * own * excess;
                of_stamp += weight * by_stamp * excess;
            }
        }
        if weights > 0.0 {
            let position = errors.position_variance * (1.0 + of_position / weights);
            found.position_variance = position.max(record.position_floor);
            found.stamp_variance = errors.stamp_variance * (1.0 + of_stamp / weights);
        }
        let shapes = record.velocity_shape.iter().zip(record.velocity);
        let read = shapes.zip(&self.squares[1]);
        let velocity = mean(
            read.filter(|((shape, y), _)| y.is_finite() && **shape > record.assigned)
                .map(|((shape, _), square)| square / (shape * shape)),
        );
        if velocity.is_finite() {
            found.velocity_variance = velocity.max(record.velocity_floor);
        }
        found
    }
}

/// Mean of the finite values; NaN if there are none.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values
        .filter(|x| x.is_finite())
        .fold((0.0, 0.0), |(sum, count), x| (sum + x, count + 1.0));
    sum / count
}
