//! Tests of rising static friction and frictional memory in the seven-parameter model.

use super::support::{along, moving};

const K_T: f64 = 1e6;
const F_C: f64 = 5.0;
const F_S: f64 = 4.0;
const V_S: f64 = 0.005;
const TAU_L: f64 = 0.05;
const GAMMA: f64 = 1.5;
const VALUES: [f64; 7] = [K_T, F_C, 0.0, F_S, V_S, TAU_L, GAMMA];

/// Largest force after a rest of `rest_s` between two sliding motions, N.
fn breakaway(rest_s: f64) -> f64 {
    let (dt, stop) = (1e-3, 1.0);
    let speed = |t: f64| {
        if t < stop {
            0.05
        } else if t < stop + rest_s {
            0.0
        } else {
            1e-4 * ((t - stop - rest_s) / 0.02).min(1.0)
        }
    };
    let steps = ((stop + rest_s + 0.5) / dt) as u32;
    let force = along::<f64>("seven_parameter", &VALUES, dt, steps, |t| {
        moving(t, speed(t), 0.0)
    });
    let after = ((stop + rest_s) / dt) as usize;
    force[after..].iter().fold(0.0, |m: f64, &f| m.max(f))
}

/// The breakaway force rises with the duration t of the rest as `F_c + F_sa + (F_inf - F_sa) t/(t +
/// gamma)`.
///
/// Hardly any Stribeck friction remains at a stop from a speed well above v_s.
#[test]
fn breakaway_rises_with_the_duration_of_a_rest() {
    let arrival = F_S / (1.0 + (0.05 / V_S).powi(2));
    let mut last = 0.0;
    for rest in [0.2, 0.5, 1.5, 5.0, 50.0] {
        let peak = breakaway(rest);
        let t2 = rest + 0.02; // deflection up to breakaway takes some ms more
        let expected = F_C + arrival + (F_S - arrival) * t2 / (t2 + GAMMA);
        assert!(peak > last);
        assert!(
            (peak - expected).abs() < 0.12,
            "{rest} s: {peak} {expected}"
        );
        last = peak;
    }
}

/// After a jump from a low to a high speed, friction falls `tau_L` later, exact to the sample.
#[test]
fn friction_drops_after_the_delay_if_the_speed_jumps() {
    for dt in [1e-4, 1e-3, 2e-3] {
        let jump = 0.5;
        let at = |t: f64| moving::<f64>(t, if t < jump - 1e-9 { 1e-3 } else { 0.1 }, 0.0);
        let force = along::<f64>("seven_parameter", &VALUES, dt, (0.7 / dt) as u32, at);
        let slow = F_C + F_S / (1.0 + (1e-3 / V_S).powi(2));
        let fast = F_C + F_S / (1.0 + (0.1 / V_S).powi(2));
        for (i, f) in force.iter().enumerate() {
            let t = dt * i as f64;
            // Two points of the delay line around the jump: one step, or a sixtieth of tau_L.
            let blur = 2.0 * dt.max(TAU_L / 60.0);
            if t < jump + TAU_L - blur {
                assert!((f - slow).abs() < 1e-9, "dt {dt}, {t} s: {f} {slow}");
            } else if t > jump + TAU_L + blur {
                assert!((f - fast).abs() < 1e-9, "dt {dt}, {t} s: {f} {fast}");
            }
        }
    }
}

/// Before breakaway, the contact is a linear spring.
#[test]
fn contact_is_a_spring_before_breakaway() {
    let force = along::<f64>("seven_parameter", &VALUES, 1e-3, 200, |t| {
        moving(t, if t > 0.0 { 1e-5 } else { 0.0 }, 0.0)
    });
    for (i, f) in force.iter().enumerate().skip(1) {
        let way = 1e-5 * 1e-3 * (i as f64 - 0.5);
        assert!((f - K_T * way).abs() < 1e-9, "{i}: {f}");
    }
}
