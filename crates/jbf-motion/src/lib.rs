//! Fixed-interval smoothing of a recorded motion.
//!
//! The state x of a motion of order N is the position and its first N - 1 derivatives. Its N-th
//! derivative is white noise of intensity q, which may differ from step to step:
//!
//! ```text
//! x[k+1] = F(h) x[k] + w[k],   w[k] ~ N(0, q[k] Q(h)),   h = t[k+1] - t[k] >= 0
//! ```
//!
//! In a motion of order 3, the jerk is noise, and the acceleration jumps where q is large. In a
//! motion of order 4, the snap is noise, and the acceleration is smooth.
//!
//! [`estimate`] estimates the variances of the readings and the intensity of each step by
//! expectation-maximisation. [`smooth`] returns the posterior mean and covariance of the state at
//! each sample, the log-likelihood of the readings and the squared disturbance of each step.
//! [`ErrorChain::filter`] turns residuals that contain a linear function of the motion's errors
//! into independent ones.
//!
//! Sources: Bar-Shalom, Li & Kirubarajan, *Estimation with Applications to Tracking and Navigation*
//! (2001), section 6.2 (order 3); Rauch, Tung & Striebel (1965) (smoother); de Jong (1989), Durbin
//! & Koopman, *Time Series Analysis by State Space Methods* (2012), section 4.5 (disturbances).

mod estimation;
mod model;
mod smoother;
mod whitening;

pub use estimation::{estimate, lower_bound, Known, Passes, ReadingErrors, Record};
pub use smoother::{log_likelihood, smooth, LinearReading, Readings, Smoothed};
pub use whitening::{ErrorChain, WhiteningFilter};
