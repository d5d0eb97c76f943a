//! Direct implementation of the journal law without inertia from the equations of Cohn (1998), for
//! comparison only.
//!
//! It uses polar coordinates, the film integrals as printed, and `libm`.

use jbf_core::law::journal::{Journal, Parameters};
use jbf_core::{Bearing, Clock, Error};

const PI: f32 = core::f32::consts::PI;

/// Constants and state of the model.
#[derive(Clone, Copy)]
pub struct Plain {
    load_number: f32,
    eps_tr: f32,
    p: Parameters<f32>,
    viscous: f32,
    eps: f32,
    phi: f32,
}

impl Plain {
    /// Creates the model with the parameters of Table 4.2 at 104 N.
    ///
    /// # Errors
    /// None: the numbers are valid.
    pub fn new() -> Result<Self, Error> {
        let p = Parameters {
            f_m: 0.26_f32,
            u_tr_m_s: 0.06,
            k0: 7.5e5,
            gamma: 33.0,
        };
        let law = Journal::<f32>::new(&Bearing::THESIS, 104.0, &p, Clock::Thesis)?;
        let (loaded, b) = (law.nominal(), Bearing::THESIS);
        let ratio = b.radius_m * b.clearance_m / (b.length_m * b.length_m);
        Ok(Self {
            load_number: loaded.load_number,
            eps_tr: loaded.eps_tr,
            p,
            viscous: p.gamma * ratio as f32 * 2.0 * PI,
            eps: loaded.eps_tr,
            phi: 0.15,
        })
    }

    /// Advances by an Euler step, and returns the friction coefficient before the step.
    pub fn step(&mut self, velocity_m_s: f32, dt: f32) -> f32 {
        let (e, phi, fb) = (self.eps, self.phi, self.load_number);
        let ub = libm::fabsf(velocity_m_s) / self.p.u_tr_m_s;
        let d = 1.0 - e * e;
        let j11 = PI / 2.0 / libm::powf(d, 1.5);
        let j12 = -2.0 * e / libm::powf(d, 2.0);
        let j22 = PI / 2.0 * (1.0 + 2.0 * e * e) / libm::powf(d, 2.5);
        let touch = e - self.eps_tr;
        let load = if touch > 0.0 {
            self.p.k0 * touch * touch
        } else {
            0.0
        };
        let direction = if velocity_m_s > 0.0 { 1.0 } else { -1.0 };
        let friction =
            (self.p.f_m * load * direction + self.viscous * ub * direction / libm::sqrtf(d)) / fb;
        let push = fb * libm::cosf(phi) - load + fb * j12 / j11 * libm::sinf(phi);
        let eps_rate = push / (j22 - j12 * j12 / j11);
        let phi_rate = (j11 * e * ub / 2.0 - j12 * eps_rate - fb * libm::sinf(phi)) / (j11 * e);
        self.eps = e + dt * eps_rate;
        self.phi = phi + dt * phi_rate;
        friction
    }
}
