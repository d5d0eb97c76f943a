// The part of SimpleFOC's interface that examples/simplefoc.cpp uses, with a simulated motor.
//
// The shaft has Coulomb friction of 0.1 N m with the static friction of 0.14 N m, an inertia of
// 1e-3 kg m^2, and a torque of one newton metre for 8 V.
#pragma once

#include <cmath>

inline unsigned long simulated_us = 0;
inline unsigned long micros() { return simulated_us; }

enum class MotionControlType { torque };
enum class TorqueControlType { voltage };
const int AS5600_I2C = 0;

struct MagneticSensorI2C {
  explicit MagneticSensorI2C(int) {}
  void init() {}
};

struct BLDCDriver3PWM {
  float voltage_power_supply = 0.0f;
  BLDCDriver3PWM(int, int, int, int) {}
  int init() { return 1; }
};

struct PIDController {
  float P = 0.0f, I = 0.0f;
  float operator()(float error) { return P * error; }
};

struct BLDCMotor {
  MotionControlType controller;
  TorqueControlType torque_controller;
  PIDController PID_velocity;
  float shaft_velocity = 0.0f;

  explicit BLDCMotor(int) {}
  void linkSensor(MagneticSensorI2C *) {}
  void linkDriver(BLDCDriver3PWM *) {}
  int init() { return 1; }
  int initFOC() { return 1; }
  void move(float volts) { volts_ = volts; }

  // Simulates 50 us of the shaft.
  void loopFOC() {
    const float torque = volts_ / 8.0f, dt_s = 50e-6f, inertia = 1e-3f;
    const float speed = std::fabs(shaft_velocity);
    if (speed == 0.0f && std::fabs(torque) <= 0.14f) {
      return;
    }
    const float ratio = speed / 0.5f;
    const float level = 0.10f + 0.04f * std::exp(-ratio * ratio) + 0.002f * speed;
    const float way = speed > 0.0f ? shaft_velocity : torque;
    const float next = shaft_velocity + dt_s / inertia * (torque - std::copysign(level, way));
    shaft_velocity = next * shaft_velocity < 0.0f ? 0.0f : next;
  }

 private:
  float volts_ = 0.0f;
};
