//! Host loop as in a ROS 2 node: each stamped measurement of a joint is answered by a torque
//! command with friction compensation.
//!
//! The messages have the fields of `sensor_msgs/JointState` that the loop needs, so the callback can
//! be moved into a node of `rclrs` or `r2r`. Here a simulated joint with gravity publishes them at
//! 1 kHz. Their time stamps jitter, a part of them is lost, and another part arrives twice. The
//! program prints the largest velocity error with and without the compensation.
//!
//! `cargo run --release -p jbf-core --example stamped_messages`

use jbf_core::chain::State;
use jbf_core::effect::gravity::{self, Gravity};
use jbf_core::law::lugre::{self, LuGre};
use jbf_core::{Chain, Error, Motion};

/// Friction and weight of the joint.
type Model = Chain<f64, LuGre<f64>, ((), Gravity<f64>)>;
type ModelState = State<f64, f64, ((), Gravity<f64>)>;

/// Measurement of the joint, as in `sensor_msgs/JointState`.
struct JointState {
    stamp_ns: i64,
    position_rad: f64,
    velocity_rad_s: f64,
}

/// Desired velocity, rad/s, at a time in s.
fn target_rad_s(time_s: f64) -> f64 {
    0.5 * time_s.sin()
}

/// Model of friction and weight of a joint; N m, because forces refer to a radius of 1 m.
fn joint_model() -> Result<Model, Error> {
    let friction = lugre::Parameters {
        f_c: 4.0,
        f_s: 5.0,
        v_s: 0.05,
        f_v: 3.0,
        ..Default::default()
    };
    let weight = gravity::Parameters {
        g: 3.0,
        theta_0_rad: 0.0,
    };
    Ok(Chain::new(LuGre::new(friction)?).with(Gravity::new(weight)?))
}

/// Velocity controller of the joint, the state of the node.
struct VelocityController {
    model: Model,
    /// State of the model, and the stamp of its first message; `None` before this message.
    run: Option<(ModelState, i64)>,
    gain_n_m_s: f64,
    compensated: bool,
}

impl VelocityController {
    /// Returns the torque, N m; `None` for a message that is not later than the previous one.
    fn on_joint_state(&mut self, message: &JointState) -> Option<f64> {
        let (state, first_ns) = self.run.get_or_insert_with(|| {
            let motion = Motion {
                angle_rad: message.position_rad,
                ..Motion::default()
            };
            (self.model.start(&motion), message.stamp_ns)
        });
        // Stamps relative to the first one: seconds since 1970 have no resolution of 1 ns in f64.
        let time_s = 1e-9 * (message.stamp_ns - *first_ns) as f64;
        let dt_s = time_s - state.motion.time_s;
        if dt_s < 0.0 || (dt_s == 0.0 && time_s > 0.0) {
            return None;
        }
        // The model follows the desired velocity and the measured angle.
        let target_rad_s = target_rad_s(time_s);
        let motion = Motion {
            time_s,
            velocity_m_s: target_rad_s,
            angle_rad: message.position_rad,
            ..Motion::default()
        };
        let predicted_n_m = self.model.step(state, &motion, dt_s);
        let feedforward_n_m = if self.compensated { predicted_n_m } else { 0.0 };
        Some(self.gain_n_m_s * (target_rad_s - message.velocity_rad_s) + feedforward_n_m)
    }
}

fn main() -> Result<(), Error> {
    const INERTIA_KG_M2: f64 = 0.2;
    const START_NS: i64 = 1_700_000_000_000_000_000;
    for compensated in [false, true] {
        let mut node = VelocityController {
            model: joint_model()?,
            run: None,
            gain_n_m_s: 20.0,
            compensated,
        };
        let joint = joint_model()?;
        let mut contact = joint.start(&Motion::default());
        let (mut angle_rad, mut velocity_rad_s, mut torque_n_m) = (0.0, 0.0, 0.0);
        let (mut answers, mut largest_rad_s) = (0, 0.0_f64);
        // The joint advances in steps of 0.1 ms; a message is due every tenth step.
        for step in 0..100_000_i64 {
            let time_s = 1e-4 * step as f64;
            let jitter = (step / 10 * 7) % 3;
            let lost = step / 10 % 50 == 17;
            if step % 10 == jitter && !lost {
                let message = JointState {
                    stamp_ns: START_NS + 100_000 * step,
                    position_rad: angle_rad,
                    velocity_rad_s,
                };
                let copies = if step / 10 % 40 == 3 { 2 } else { 1 };
                for command in (0..copies).filter_map(|_| node.on_joint_state(&message)) {
                    torque_n_m = command;
                    answers += 1;
                }
                largest_rad_s = largest_rad_s.max((target_rad_s(time_s) - velocity_rad_s).abs());
            }
            let motion = Motion {
                time_s,
                velocity_m_s: velocity_rad_s,
                angle_rad,
                ..Motion::default()
            };
            let resisting_n_m = joint.step(&mut contact, &motion, 1e-4);
            velocity_rad_s += 1e-4 * (torque_n_m - resisting_n_m) / INERTIA_KG_M2;
            angle_rad += 1e-4 * velocity_rad_s;
        }
        let label = if compensated { "with" } else { "without" };
        println!("{label} compensation: {largest_rad_s:.4} rad/s in {answers} commands");
    }
    Ok(())
}
