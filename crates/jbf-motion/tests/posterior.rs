//! The smoother and the whitening against dense linear algebra, and their invariances.

use jbf_motion::{smooth, whiten, Readings, Smoothed};
use nalgebra::{DMatrix, DVector, Matrix3};

const N: usize = 9;
const INF: f64 = f64::INFINITY;

/// Uneven instants, one of them repeated, and readings of which some are missing.
struct Record {
    time: Vec<f64>,
    position: Vec<f64>,
    position_variance: Vec<f64>,
    velocity: Vec<f64>,
    velocity_variance: Vec<f64>,
    jerk: Vec<f64>,
    delay: f64,
}

impl Record {
    fn new() -> Self {
        let noise = [0.3, -1.1, 0.7, 0.2, -0.4, 1.3, -0.9, 0.1, 0.5];
        let time: Vec<f64> = vec![0.0, 0.1, 0.25, 0.3, 0.3, 0.45, 0.5, 0.65, 0.7];
        let position = (0..N)
            .map(|k| (3.0 * time[k]).sin() + 1e-3 * noise[k])
            .collect();
        let velocity = (0..N)
            .map(|k| 3.0 * (3.0 * time[k]).cos() + 1e-2 * noise[N - 1 - k])
            .collect();
        let mut record = Self {
            time,
            position,
            position_variance: vec![1e-6; N],
            velocity,
            velocity_variance: vec![1e-4; N],
            jerk: vec![50.0, 80.0, 5.0, 5.0, 2000.0, 60.0, 30.0, 10.0],
            delay: 0.02,
        };
        record.position_variance[2] = INF;
        record.velocity_variance[5] = INF;
        record.position_variance[6] = 9e-6;
        record
    }

    fn smooth(&self) -> Smoothed {
        smooth(
            &Readings {
                time: &self.time,
                position: &self.position,
                position_variance: &self.position_variance,
                velocity: &self.velocity,
                velocity_variance: &self.velocity_variance,
                velocity_delay: self.delay,
            },
            &self.jerk,
        )
    }
}

/// Posterior mean and covariance of all states by dense normal equations with a flat prior.
fn dense(record: &Record) -> (DVector<f64>, DMatrix<f64>) {
    let mut information = DMatrix::zeros(3 * N, 3 * N);
    let mut right = DVector::zeros(3 * N);
    let mut add = |row: DVector<f64>, value: f64, variance: f64| {
        if variance.is_finite() {
            information += &row * row.transpose() / variance;
            right += row * (value / variance);
        }
    };
    for k in 0..N {
        let mut row = DVector::zeros(3 * N);
        row[3 * k] = 1.0;
        add(row, record.position[k], record.position_variance[k]);
        let mut row = DVector::zeros(3 * N);
        row[3 * k + 1] = 1.0;
        row[3 * k + 2] = -record.delay;
        add(row, record.velocity[k], record.velocity_variance[k]);
    }
    for k in 0..N - 1 {
        let h = record.time[k + 1] - record.time[k];
        let f = Matrix3::new(1.0, h, h * h / 2.0, 0.0, 1.0, h, 0.0, 0.0, 1.0);
        // The covariance of the triple integral of white noise, by its definition.
        let moment = |i: i32, j: i32| {
            let factorial = |n: i32| (1..=n).map(f64::from).product::<f64>();
            h.powi(i + j + 1) / (f64::from(i + j + 1) * factorial(i) * factorial(j))
        };
        let q = Matrix3::from_fn(|i, j| moment(2 - i as i32, 2 - j as i32)) * record.jerk[k];
        let inverse = if h > 0.0 {
            q.try_inverse().expect("a step")
        } else {
            Matrix3::identity() * 1e10
        };
        let mut difference = DMatrix::zeros(3, 3 * N);
        difference.view_mut((0, 3 * k), (3, 3)).copy_from(&(-f));
        difference
            .view_mut((0, 3 * k + 3), (3, 3))
            .copy_from(&Matrix3::identity());
        let w = DMatrix::from_fn(3, 3, |i, j| inverse[(i, j)]);
        information += difference.transpose() * w * difference;
    }
    let covariance = information.try_inverse().expect("enough readings");
    (&covariance * right, covariance)
}

#[test]
fn posterior_equals_dense_least_squares_for_uneven_steps_and_missing_readings() {
    let record = Record::new();
    let found = record.smooth();
    let (mean, covariance) = dense(&record);
    for k in 0..N {
        for i in 0..3 {
            let sd = covariance[(3 * k + i, 3 * k + i)].sqrt();
            let off = found.mean[k][i] - mean[3 * k + i];
            assert!(off.abs() < 2e-3 * sd, "{k} {i}: {off} of {sd}");
            for j in 0..3 {
                let other = covariance[(3 * k + j, 3 * k + j)].sqrt();
                let off = found.covariance[k][i][j] - covariance[(3 * k + i, 3 * k + j)];
                assert!(off.abs() < 2e-3 * sd * other, "{k} {i} {j}");
            }
        }
    }
}

#[test]
fn disturbance_is_the_derivative_of_the_likelihood_by_the_jerk() {
    let record = Record::new();
    let found = record.smooth();
    for k in (0..N - 1).filter(|k| record.time[k + 1] > record.time[*k]) {
        let likelihood = |factor: f64| {
            let mut other = Record::new();
            other.jerk[k] *= factor;
            other.smooth().log_likelihood
        };
        let slope = (likelihood(1.001) - likelihood(0.999)) / 0.002;
        let expected = 0.5 * (found.disturbance[k] / record.jerk[k] - 3.0);
        assert!(
            (slope - expected).abs() < 1e-4 * (1.0 + expected.abs()),
            "{k}"
        );
    }
    assert!(found.disturbance[3].is_nan());
}

#[test]
fn whitened_columns_have_the_scalar_products_of_the_dense_covariance() {
    let record = Record::new();
    let found = record.smooth();
    let (_, covariance) = dense(&record);
    let sensitivity: Vec<[f64; 3]> = (0..N).map(|k| [0.2, -0.5 + 0.1 * k as f64, 0.3]).collect();
    let mut variance = vec![1e-3; N];
    variance[4] = INF;
    let kept: Vec<usize> = (0..N).filter(|k| *k != 4).collect();
    let rows = DMatrix::from_fn(N, 3 * N, |k, j| {
        if j / 3 == k {
            sensitivity[k][j % 3]
        } else {
            0.0
        }
    });
    let full = &rows * covariance * rows.transpose() + DMatrix::identity(N, N) * 1e-3;
    let part = full.select_rows(&kept).select_columns(&kept);
    let columns = DMatrix::from_fn(N, 2, |k, j| (1.3 * k as f64 + 2.0 * j as f64).sin());
    let mut flat: Vec<f64> = columns.transpose().iter().copied().collect();
    let log_determinant = whiten(
        &found.covariance,
        &found.gain,
        &sensitivity,
        &variance,
        2,
        &mut flat,
    );
    let white = DMatrix::from_row_slice(N, 2, &flat);
    let few = columns.select_rows(&kept);
    let expected = few.transpose() * part.clone().try_inverse().expect("regular") * &few;
    assert!((white.transpose() * &white - &expected).norm() < 1e-3 * expected.norm());
    assert!((log_determinant - part.determinant().ln()).abs() < 1e-3);
    assert!(white.row(4).iter().all(|value| *value == 0.0));
}

#[test]
fn motion_backward_in_time_has_the_same_posterior_with_negative_speeds() {
    let record = Record::new();
    let mut back = Record::new();
    back.time = record.time.iter().rev().map(|t| 0.7 - t).collect();
    back.position.reverse();
    back.position_variance.reverse();
    back.velocity = record.velocity.iter().rev().map(|v| -v).collect();
    back.velocity_variance.reverse();
    back.jerk.reverse();
    back.delay = -record.delay;
    let (one, other) = (record.smooth(), back.smooth());
    for k in 0..N {
        let (a, b) = (one.mean[k], other.mean[N - 1 - k]);
        for (i, sign) in [1.0, -1.0, 1.0].into_iter().enumerate() {
            let sd = one.covariance[k][i][i].sqrt();
            assert!((a[i] - sign * b[i]).abs() < 2e-3 * sd);
        }
    }
}

#[test]
fn posterior_in_milliseconds_is_the_same_motion() {
    let record = Record::new();
    let mut fine = Record::new();
    let per = 1e3_f64;
    fine.time.iter_mut().for_each(|t| *t *= per);
    fine.velocity.iter_mut().for_each(|v| *v /= per);
    fine.velocity_variance
        .iter_mut()
        .for_each(|v| *v /= per * per);
    fine.jerk.iter_mut().for_each(|q| *q /= per.powi(5));
    fine.delay *= per;
    let (one, other) = (record.smooth(), fine.smooth());
    for k in 0..N {
        for i in 0..3 {
            let value = other.mean[k][i] * per.powi(i as i32);
            assert!((value - one.mean[k][i]).abs() < 1e-9 * one.mean[k][i].abs().max(1.0));
        }
    }
}

#[test]
fn one_reading_and_no_reading_give_a_finite_motion() {
    for variance in [1e-4, INF] {
        let one = smooth(
            &Readings {
                time: &[0.0],
                position: &[2.0],
                position_variance: &[variance],
                velocity: &[f64::NAN],
                velocity_variance: &[INF],
                velocity_delay: 0.0,
            },
            &[],
        );
        assert!(one.mean[0].iter().all(|value| value.is_finite()));
    }
}
