//! Gains of the discrete-time observer of the plant.

/// Computes the observer gains for angle, speed and disturbance that place the poles of the
/// discrete-time observer.
///
/// Two poles are at `p`. The third is at the pole of the plant, or at `p` if that is faster. The
/// gains follow from Ackermann's formula; the angle is measured after each step. With a pole slower
/// than that of the plant, the first gain would be negative, and the estimates would diverge while
/// the observer is at rest.
pub(super) fn poles(keep: f64, gain: f64, dt_s: f64, p: f64) -> [f64; 3] {
    let h = 0.5 * dt_s;
    // Prediction: x + h (v + v'), v' = keep v - gain d, d.
    let (a12, a13) = (h * (1.0 + keep), -h * gain);
    // Rows C A, C A^2, C A^3 of the observability matrix, A = [1 a12 a13; 0 keep -gain; 0 0 1],
    // solved for (0, 0, 1).
    let next = |r: [f64; 3]| {
        [
            r[0],
            r[0] * a12 + r[1] * keep,
            r[0] * a13 - r[1] * gain + r[2],
        ]
    };
    let r1 = [1.0, a12, a13];
    let r2 = next(r1);
    let r3 = next(r2);
    // The first entry of each row is 1: its elimination leaves two equations.
    let (b1, c1) = (r2[1] - r1[1], r2[2] - r1[2]);
    let (b2, c2) = (r3[1] - r2[1], r3[2] - r2[2]);
    let determinant = b1 * c2 - b2 * c1;
    let (q1, q2) = (-c1 / determinant, b1 / determinant);
    let q0 = -(r1[1] * q1 + r1[2] * q2);
    // phi(A) q with phi(A) = (A - p)^2 (A - own), one factor at a time.
    let less = |p: f64, q: [f64; 3]| {
        [
            (1.0 - p) * q[0] + a12 * q[1] + a13 * q[2],
            (keep - p) * q[1] - gain * q[2],
            (1.0 - p) * q[2],
        ]
    };
    less(p, less(p, less(p.min(keep), [q0, q1, q2])))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Errors of angle, speed and disturbance after one step of the corrected observer.
    fn next(keep: f64, gain: f64, dt_s: f64, correct: [f64; 3], e: [f64; 3]) -> [f64; 3] {
        let h = 0.5 * dt_s;
        let predicted = [
            e[0] + h * (1.0 + keep) * e[1] - h * gain * e[2],
            keep * e[1] - gain * e[2],
            e[2],
        ];
        core::array::from_fn(|i| predicted[i] - correct[i] * predicted[0])
    }

    /// Value of the polynomial with these roots at the matrix `A` of a step, times `e`; zero by the
    /// Cayley-Hamilton theorem.
    fn left(roots: [f64; 3], step: impl Fn([f64; 3]) -> [f64; 3], e: [f64; 3]) -> f64 {
        let [a, b, c] = roots;
        let (one, two) = (step(e), step(step(e)));
        let three = step(two);
        let worst = (0..3).map(|i| {
            (three[i] - (a + b + c) * two[i] + (a * b + b * c + c * a) * one[i] - a * b * c * e[i])
                .abs()
        });
        worst.fold(0.0, f64::max)
    }

    #[test]
    fn observer_error_decays_at_the_rate_of_its_poles() {
        let dt_s = 0.002;
        for (damping, bandwidth) in [(135.0, 60.0), (135.0, 300.0), (10.0, 60.0)] {
            let keep = libm::exp(-damping * dt_s);
            let gain = 457.0 / damping * (1.0 - keep);
            let p = libm::exp(-bandwidth * dt_s);
            let correct = poles(keep, gain, dt_s, p);
            for e in [[1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]] {
                let step = |e| next(keep, gain, dt_s, correct, e);
                let rest = left([p, p, p.min(keep)], step, e);
                assert!(rest < 1e-10, "{damping} {bandwidth}: {rest}");
            }
        }
    }
}
