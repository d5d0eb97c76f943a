// Runs examples/simplefoc.cpp against the simulated motor: prints the RMS of the velocity error
// (rad/s) with and without compensation.
#include <cstdio>

#include "../../examples/simplefoc.cpp"

static double rms_error(bool with_compensation) {
  motor.shaft_velocity = 0.0f;
  motor.move(0.0f);
  compensated = compensated && with_compensation;
  double sum = 0.0;
  const int steps = 200000;
  for (int step = 0; step < steps; step++) {
    simulated_us += 50;
    target_rad_s = 3.0f * std::sin(2e-6f * static_cast<float>(simulated_us));
    loop();
    const double error = target_rad_s - motor.shaft_velocity;
    sum += error * error;
  }
  return std::sqrt(sum / steps);
}

int main() {
  setup();
  if (!compensated) {
    return 1;
  }
  const double with = rms_error(true);
  const double without = rms_error(false);
  std::printf("%g %g\n", with, without);
  return 0;
}
