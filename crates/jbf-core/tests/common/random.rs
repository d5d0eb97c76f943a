//! Small random number generator with a seed, so that a failure can be repeated: xorshift64* (Vigna
//! 2016).

/// State of the random number generator.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9e37_79b9_7f4a_7c15) | 1)
    }

    /// Draws a number with a uniform distribution in [0, 1).
    pub fn unit(&mut self) -> f64 {
        self.0 ^= self.0 >> 12;
        self.0 ^= self.0 << 25;
        self.0 ^= self.0 >> 27;
        let bits = self.0.wrapping_mul(0x2545_f491_4f6c_dd1d) >> 11;
        bits as f64 / (1u64 << 53) as f64
    }

    pub fn uniform(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// Draws a number whose logarithm has a uniform distribution between two limits.
    pub fn log_uniform(&mut self, low: f64, high: f64) -> f64 {
        (low.ln() + (high / low).ln() * self.unit())
            .exp()
            .clamp(low, high)
    }

    pub fn chance(&mut self, probability: f64) -> bool {
        self.unit() < probability
    }

    /// Draws a value within the bounds of a parameter, with a uniform logarithm if the bounds allow
    /// it.
    pub fn parameter(&mut self, p: &jbf_core::effect::Parameter) -> f64 {
        if p.lower < 0.0 {
            self.uniform(p.lower, p.upper)
        } else {
            self.log_uniform(p.lower.max(1e-12 * p.upper), p.upper)
        }
    }
}
