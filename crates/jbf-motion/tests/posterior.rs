//! Tests of the smoother and the whitening against dense linear algebra, and of their invariances.

use jbf_motion::{
    estimate, smooth, ErrorChain, Known, LinearReading, Passes, ReadingErrors, Readings, Smoothed,
};
use nalgebra::{DMatrix, DVector, SMatrix, Vector3};

const SAMPLES: usize = 9;
const INF: f64 = f64::INFINITY;

/// Record with uneven instants, one of them repeated, and some missing readings.
struct Record {
    time: Vec<f64>,
    position: Vec<f64>,
    position_variance: Vec<f64>,
    velocity: Vec<f64>,
    velocity_variance: Vec<f64>,
    intensity: Vec<f64>,
    delay: f64,
    linear: Vec<LinearReading>,
}

impl Record {
    fn new() -> Self {
        let noise = [0.3, -1.1, 0.7, 0.2, -0.4, 1.3, -0.9, 0.1, 0.5];
        let time: Vec<f64> = vec![0.0, 0.1, 0.25, 0.3, 0.3, 0.45, 0.5, 0.65, 0.7];
        let position = (0..SAMPLES)
            .map(|k| (3.0 * time[k]).sin() + 1e-3 * noise[k])
            .collect();
        let velocity = (0..SAMPLES)
            .map(|k| 3.0 * (3.0 * time[k]).cos() + 1e-2 * noise[SAMPLES - 1 - k])
            .collect();
        let mut record = Self {
            time,
            position,
            position_variance: vec![1e-6; SAMPLES],
            velocity,
            velocity_variance: vec![1e-4; SAMPLES],
            intensity: vec![50.0, 80.0, 5.0, 5.0, 2000.0, 60.0, 30.0, 10.0],
            delay: 0.02,
            linear: Vec::new(),
        };
        record.position_variance[2] = INF;
        record.velocity_variance[5] = INF;
        record.position_variance[6] = 9e-6;
        record
    }

    /// Adds readings of a force `2 a + 0.5 v - p + e` at all instants except one.
    fn with_forces(mut self) -> Self {
        let reading = |k: usize| LinearReading {
            row: Vector3::new(-1.0, 0.5, 2.0),
            value: -19.0 * self.position[k] + 0.5 * self.velocity[k] + 0.1 * k as f64,
            variance: if k == 4 { INF } else { 0.25 },
        };
        self.linear = (0..SAMPLES).map(reading).collect();
        self
    }

    fn smooth<const N: usize>(&self) -> Smoothed<N> {
        smooth(
            &Readings {
                time: &self.time,
                position: &self.position,
                position_variance: &self.position_variance,
                velocity: &self.velocity,
                velocity_variance: &self.velocity_variance,
                velocity_delay: self.delay,
                linear: &self.linear,
            },
            &self.intensity,
        )
    }
}

/// Posterior mean and covariance of all states by dense normal equations with a flat prior.
fn dense<const N: usize>(record: &Record) -> (DVector<f64>, DMatrix<f64>) {
    let mut information = DMatrix::zeros(N * SAMPLES, N * SAMPLES);
    let mut right = DVector::zeros(N * SAMPLES);
    let mut add = |row: DVector<f64>, value: f64, variance: f64| {
        if variance.is_finite() {
            information += &row * row.transpose() / variance;
            right += row * (value / variance);
        }
    };
    for k in 0..SAMPLES {
        let mut row = DVector::zeros(N * SAMPLES);
        row[N * k] = 1.0;
        add(row, record.position[k], record.position_variance[k]);
        let mut row = DVector::zeros(N * SAMPLES);
        row[N * k + 1] = 1.0;
        row[N * k + 2] = -record.delay;
        if N > 3 {
            row[N * k + 3] = record.delay.powi(2) / 2.0;
        }
        add(row, record.velocity[k], record.velocity_variance[k]);
        if let Some(reading) = record.linear.get(k) {
            let mut row = DVector::zeros(N * SAMPLES);
            for i in 0..3 {
                row[N * k + i] = reading.row[i];
            }
            add(row, reading.value, reading.variance);
        }
    }
    for k in 0..SAMPLES - 1 {
        let h = record.time[k + 1] - record.time[k];
        let factorial = |n: usize| (1..=n).map(|i| i as f64).product::<f64>();
        let power = |n: usize| h.powi(n as i32) / factorial(n);
        let f = SMatrix::<f64, N, N>::from_fn(|i, j| if j < i { 0.0 } else { power(j - i) });
        // The covariance of the repeated integrals of white noise, by definition.
        let moment = |i: usize, j: usize| power(i) * power(j) * h / (i + j + 1) as f64;
        let q = SMatrix::<f64, N, N>::from_fn(|i, j| moment(N - 1 - i, N - 1 - j))
            * record.intensity[k];
        let inverse = if h > 0.0 {
            q.try_inverse().expect("a step")
        } else {
            SMatrix::identity() * 1e10
        };
        let mut difference = DMatrix::zeros(N, N * SAMPLES);
        difference.view_mut((0, N * k), (N, N)).copy_from(&(-f));
        difference
            .view_mut((0, N * (k + 1)), (N, N))
            .copy_from(&SMatrix::<f64, N, N>::identity());
        let w = DMatrix::from_fn(N, N, |i, j| inverse[(i, j)]);
        information += difference.transpose() * w * difference;
    }
    let covariance = information.try_inverse().expect("enough readings");
    (&covariance * right, covariance)
}

#[test]
fn posterior_equals_dense_least_squares_for_uneven_steps_and_missing_readings() {
    fn of_order<const N: usize>(record: &Record) {
        let found = record.smooth::<N>();
        let (mean, covariance) = dense::<N>(record);
        for k in 0..SAMPLES {
            for i in 0..N {
                let sd = covariance[(N * k + i, N * k + i)].sqrt();
                let off = found.mean[k][i] - mean[N * k + i];
                assert!(off.abs() < 2e-3 * sd, "{k} {i}: {off} of {sd}");
                for j in 0..N {
                    let other = covariance[(N * k + j, N * k + j)].sqrt();
                    let off = found.covariance[k][(i, j)] - covariance[(N * k + i, N * k + j)];
                    assert!(off.abs() < 2e-3 * sd * other, "{k} {i} {j}");
                }
            }
        }
    }
    for record in [Record::new(), Record::new().with_forces()] {
        of_order::<3>(&record);
        of_order::<4>(&record);
    }
}

#[test]
fn disturbance_is_the_derivative_of_the_likelihood_by_the_intensity() {
    fn of_order<const N: usize>() {
        let record = Record::new();
        let found = record.smooth::<N>();
        for k in (0..SAMPLES - 1).filter(|k| record.time[k + 1] > record.time[*k]) {
            let likelihood = |factor: f64| {
                let mut other = Record::new();
                other.intensity[k] *= factor;
                other.smooth::<N>().log_likelihood
            };
            let slope = (likelihood(1.001) - likelihood(0.999)) / 0.002;
            let expected = 0.5 * (found.disturbance[k] / record.intensity[k] - N as f64);
            assert!(
                (slope - expected).abs() < 1e-4 * (1.0 + expected.abs()),
                "{k}"
            );
        }
        assert!(found.disturbance[3].is_nan());
    }
    of_order::<3>();
    of_order::<4>();
}

#[test]
fn whitened_columns_have_the_scalar_products_of_the_dense_covariance() {
    fn of_order<const N: usize>() {
        let record = Record::new();
        let found = record.smooth::<N>();
        let (_, covariance) = dense::<N>(&record);
        let sensitivity: Vec<Vector3<f64>> = (0..SAMPLES)
            .map(|k| Vector3::new(0.2, -0.5 + 0.1 * k as f64, 0.3))
            .collect();
        let mut weight = vec![1e-3_f64.sqrt().recip(); SAMPLES];
        weight[4] = 0.0;
        let kept: Vec<usize> = (0..SAMPLES).filter(|k| *k != 4).collect();
        let rows = DMatrix::from_fn(SAMPLES, N * SAMPLES, |k, j| {
            if j / N == k {
                *sensitivity[k].get(j % N).unwrap_or(&0.0)
            } else {
                0.0
            }
        });
        let full =
            &rows * covariance * rows.transpose() + DMatrix::identity(SAMPLES, SAMPLES) * 1e-3;
        let part = full.select_rows(&kept).select_columns(&kept);
        const WIDTH: usize = 15;
        let columns = DMatrix::from_fn(SAMPLES, WIDTH, |k, j| {
            (1.3 * k as f64 + 2.0 * j as f64).sin()
        });
        let mut flat: Vec<f64> = columns.transpose().iter().copied().collect();
        let chain = ErrorChain::new(&found.covariance, &found.gain);
        let filter = chain.filter(&sensitivity, &weight);
        filter.whiten(WIDTH, &mut flat);
        let white = DMatrix::from_row_slice(SAMPLES, WIDTH, &flat);
        let few = columns.select_rows(&kept);
        let expected = few.transpose() * part.clone().try_inverse().expect("regular") * &few;
        assert!((white.transpose() * &white - &expected).norm() < 1e-3 * expected.norm());
        assert!((filter.log_determinant - part.determinant().ln()).abs() < 1e-3);
        assert!(white.row(4).iter().all(|value| *value == 0.0));
    }
    of_order::<3>();
    of_order::<4>();
}

#[test]
fn motion_backward_in_time_has_the_same_posterior_with_negative_speeds() {
    fn of_order<const N: usize>() {
        let record = Record::new();
        let mut back = Record::new();
        back.time = record.time.iter().rev().map(|t| 0.7 - t).collect();
        back.position.reverse();
        back.position_variance.reverse();
        back.velocity = record.velocity.iter().rev().map(|v| -v).collect();
        back.velocity_variance.reverse();
        back.intensity.reverse();
        back.delay = -record.delay;
        let (one, other) = (record.smooth::<N>(), back.smooth::<N>());
        for k in 0..SAMPLES {
            let (a, b) = (one.mean[k], other.mean[SAMPLES - 1 - k]);
            for (i, sign) in [1.0, -1.0, 1.0, -1.0].into_iter().take(N).enumerate() {
                let sd = one.covariance[k][(i, i)].sqrt();
                assert!((a[i] - sign * b[i]).abs() < 2e-3 * sd);
            }
        }
    }
    of_order::<3>();
    of_order::<4>();
}

#[test]
fn posterior_in_milliseconds_is_the_same_motion() {
    fn of_order<const N: usize>() {
        let record = Record::new();
        let mut fine = Record::new();
        let per = 1e3_f64;
        fine.time.iter_mut().for_each(|t| *t *= per);
        fine.velocity.iter_mut().for_each(|v| *v /= per);
        fine.velocity_variance
            .iter_mut()
            .for_each(|v| *v /= per * per);
        fine.intensity
            .iter_mut()
            .for_each(|q| *q /= per.powi(2 * N as i32 - 1));
        fine.delay *= per;
        let (one, other) = (record.smooth::<N>(), fine.smooth::<N>());
        for k in 0..SAMPLES {
            for i in 0..N {
                let value = other.mean[k][i] * per.powi(i as i32);
                let sd = one.covariance[k][(i, i)].sqrt();
                assert!((value - one.mean[k][i]).abs() < 1e-6 * sd, "{k} {i}");
            }
        }
    }
    of_order::<3>();
    of_order::<4>();
}

#[test]
fn motion_is_finite_with_one_reading_or_none() {
    fn of_order<const N: usize>() {
        for variance in [1e-4, INF] {
            let one = smooth::<N>(
                &Readings {
                    time: &[0.0],
                    position: &[2.0],
                    position_variance: &[variance],
                    velocity: &[f64::NAN],
                    velocity_variance: &[INF],
                    velocity_delay: 0.0,
                    linear: &[],
                },
                &[],
            );
            assert!(one.mean[0].iter().all(|value| value.is_finite()));
        }
    }
    of_order::<3>();
    of_order::<4>();
}

#[test]
fn motion_between_exact_velocity_readings_is_recovered_at_fine_steps() {
    fn of_order<const N: usize>() {
        let n = 401;
        let time: Vec<f64> = (0..n).map(|k| 0.0025 * k as f64).collect();
        let velocity: Vec<f64> = time.iter().map(|t| 0.1 + 0.03 * (3.0 * t).sin()).collect();
        let read = |k: usize| k.is_multiple_of(8);
        let variance: Vec<f64> = (0..n).map(|k| if read(k) { 1e-14 } else { INF }).collect();
        let found: Smoothed<N> = smooth(
            &Readings {
                time: &time,
                position: &vec![f64::NAN; n],
                position_variance: &vec![INF; n],
                velocity: &velocity,
                velocity_variance: &variance,
                velocity_delay: 0.0,
                linear: &[],
            },
            &vec![1e-2; n - 1],
        );
        for (k, mean) in found.mean.iter().enumerate() {
            assert!((mean[1] - velocity[k]).abs() < 1e-4, "{N} {k}");
        }
    }
    of_order::<3>();
    of_order::<4>();
}

#[test]
fn steps_divided_between_readings_have_the_same_factors_if_each_keeps_one() {
    fn of_order<const N: usize>() {
        let n = 60;
        let times: Vec<f64> = (0..n).map(|k| 0.01 * k as f64).collect();
        let corner = |t: f64| 20.0 * (t - 0.305).max(0.0).powi(2);
        let noise = |k: usize| 1e-5 * ((7 * k % 11) as f64 - 5.0);
        let factors = |parts: usize| {
            let steps = parts * (n - 1);
            let time: Vec<f64> = (0..=steps)
                .map(|i| 0.01 * i as f64 / parts as f64)
                .collect();
            let read = |i: usize| match i % parts {
                0 => corner(times[i / parts]) + noise(i / parts),
                _ => f64::NAN,
            };
            let position: Vec<f64> = (0..=steps).map(read).collect();
            let nothing = vec![f64::NAN; steps + 1];
            let ones = vec![1.0; steps + 1];
            let continues: Vec<bool> = (0..steps).map(|i| i % parts > 0).collect();
            let record = jbf_motion::Record {
                time: &time,
                position: &position,
                position_shape: &ones,
                position_floor: 1e-12,
                velocity: &nothing,
                velocity_shape: &ones,
                velocity_floor: 1e-12,
                assigned: 0.0,
                linear: &[],
                continues: &continues,
            };
            let errors = ReadingErrors {
                position_variance: 1e-9,
                velocity_variance: 1.0,
                stamp_variance: 0.0,
                intensity: 1.0,
                velocity_delay: 0.0,
            };
            let passes = Passes {
                normal: 0,
                robust: 3000,
            };
            let start = vec![1.0; steps];
            let (_, found) = estimate::<N>(&record, errors, start, passes, Known::Everything);
            found.into_iter().step_by(parts).collect::<Vec<_>>()
        };
        for (whole, divided) in factors(1).iter().zip(factors(3)) {
            assert!((whole - divided).abs() < 1e-3 * whole, "{whole} {divided}");
        }
    }
    of_order::<3>();
    of_order::<4>();
}
