// Velocity control of a brushless motor with SimpleFOC, and compensation of its friction by jbf-c.
//
// As an Arduino sketch: rename the file to .ino, and link the static library of jbf-c for the
// processor (README.md). The parameters of the friction are placeholders; `jbf export MODEL --c
// model.h` writes those of a recorded joint.
#include <SimpleFOC.h>

#include "jbf.h"

const float VOLTS_PER_N_M = 8.0f;

BLDCMotor motor(7);  // pole pairs
BLDCDriver3PWM driver(9, 5, 6, 8);
MagneticSensorI2C sensor(AS5600_I2C);

jbf_lugre_f32 friction;
jbf_lugre_f32_state friction_state;
jbf_motion_f32 motion = {};  // forces refer to a radius of 1 m: N m and rad/s for N and m/s
bool compensated = false;
float target_rad_s = 0.0f;
unsigned long last_us = 0;

void setup() {
  sensor.init();
  motor.linkSensor(&sensor);
  driver.voltage_power_supply = 12;
  driver.init();
  motor.linkDriver(&driver);
  motor.controller = MotionControlType::torque;
  motor.torque_controller = TorqueControlType::voltage;
  motor.PID_velocity.P = 0.5f;
  motor.PID_velocity.I = 0.0f;
  motor.init();
  motor.initFOC();

  // F_c, F_s (N m), v_s (rad/s), sigma_0 (N m/rad), sigma_1 (N m s/rad), v_d (rad/s), F_v (N m s/rad)
  const double parameters[] = {0.10, 0.14, 0.5, 20.0, 0.05, 1.0, 0.002};
  jbf_error error;
  compensated = jbf_lugre_f32_init(&friction, nullptr, 1.0, parameters, 7, JBF_CLOCK_JOURNAL,
                                   &error) == JBF_OK;
  motion.load_n = 1.0f;
  motion.temperature_c = NAN;  // not measured
  if (compensated) {
    jbf_lugre_f32_start(&friction, &friction_state, &motion);
  }
  last_us = micros();
}

void loop() {
  motor.loopFOC();
  const unsigned long now_us = micros();
  const float dt_s = 1e-6f * static_cast<float>(now_us - last_us);
  if (dt_s < 1e-3f) {
    return;
  }
  last_us = now_us;

  float volts = motor.PID_velocity(target_rad_s - motor.shaft_velocity);
  if (compensated) {
    motion.time_s += dt_s;
    motion.velocity_m_s = target_rad_s;
    volts += VOLTS_PER_N_M * jbf_lugre_f32_step(&friction, &friction_state, &motion, dt_s);
  }
  motor.move(volts);
}
