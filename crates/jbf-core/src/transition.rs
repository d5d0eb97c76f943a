//! Transition eccentricity eps_tr, at which asperity contact begins, equation (3.20) of Cohn
//! (1998).

use crate::real::Real;
use crate::root::sqrt;
use core::f64::consts::PI;

/// Solves `4 Fb^2 = eps^2 [ pi^2 / (4 d^3) + 4 eps^2 / d^4 ]`, `d = 1 - eps^2`, for eps.
///
/// In the unknown d this is the polynomial `(1 - d)(4 - a d) = 4 Fb^2 d^4` with `a = 4 - pi^2 / 4`.
/// The left side falls and the right side rises on (0, 1), so there is one root, which Newton steps
/// inside a shrinking bracket find. `load_number` must be positive; derivatives with respect to it
/// are propagated.
pub fn transition_eccentricity<T: Real>(load_number: T) -> T {
    let a = 4.0 - PI * PI / 4.0;
    let fb = load_number.value();
    let g = 4.0 * fb * fb;
    let (mut low, mut high) = (0.0_f64, 1.0_f64);
    // The root of 4 = g d^4 is the limit of heavy load, and a good start value everywhere.
    let mut d = sqrt(sqrt(4.0 / (g + 4.0)));
    let mut slope = -1.0;
    for _ in 0..80 {
        let d3 = d * d * d;
        let h = (1.0 - d) * (4.0 - a * d) - g * d3 * d;
        slope = -(4.0 - a * d) - a * (1.0 - d) - 4.0 * g * d3;
        if h > 0.0 {
            low = d;
        } else {
            high = d;
        }
        let next = d - h / slope;
        let next = if next > low && next < high {
            next
        } else {
            0.5 * (low + high)
        };
        if libm::fabs(next - d) <= 1e-16 * d {
            break;
        }
        d = next;
    }
    let d4 = T::of(d * d * d * d);
    let fixed = (1.0 - d) * (4.0 - a * d);
    let residual = T::of(fixed) - T::of(4.0) * load_number * load_number * d4;
    let root = T::implicit(d, residual, slope);
    (T::ONE - root).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Dual;

    /// Transition eccentricities of Tables 4.2 to 4.5 of Cohn (1998) equal values computed
    /// independently from their load numbers.
    #[test]
    fn transition_eccentricity_matches_the_four_tables() {
        let reference = [
            (323.5151161660348, 0.9723504945734831),
            (311.6943715368912, 0.9718339551301634),
            (388.21813939924175, 0.9747476360505023),
        ];
        for (fb, eps_tr) in reference {
            let got: f64 = transition_eccentricity(fb);
            assert!((got - eps_tr).abs() < 1e-12, "{got} {eps_tr}");
        }
    }

    #[test]
    fn transition_eccentricity_solves_its_equation_for_any_load_number() {
        for power in -40..60 {
            let fb = libm::pow(10.0, f64::from(power) / 10.0);
            let e: f64 = transition_eccentricity(fb);
            let d = (1.0 - e) * (1.0 + e);
            let right = e * e * (PI * PI / (4.0 * d * d * d) + 4.0 * e * e / (d * d * d * d));
            assert!((right / (4.0 * fb * fb) - 1.0).abs() < 1e-8, "{fb}");
        }
    }

    #[test]
    fn derivative_of_the_transition_eccentricity_matches_a_difference() {
        let fb = 323.5;
        let d = transition_eccentricity(Dual::<1>::parameter(fb, 0));
        let h = 1e-3;
        let difference =
            (transition_eccentricity(fb + h) - transition_eccentricity(fb - h)) / (2.0 * h);
        assert!((d.slope[0] / difference - 1.0).abs() < 1e-6);
    }
}
