//! Detection of encoder faults.
//!
//! A fault is an unchanged counter under a voltage that certainly moves the shaft, an observer that
//! infers rotation without a count, or a jump of the counter.

use super::Status;
use crate::encoder;
use crate::real::Real;

/// Largest exponent of the duration of a fault that the compensator's observer infers.
///
/// The duration is at most `2^LONGEST_DOUBT` times [`FaultDetector::patience`].
const LONGEST_DOUBT: u32 = 7;

/// Parameters of the detection of encoder faults.
#[derive(Clone, Copy, Debug)]
pub(super) struct FaultDetector<T> {
    /// Voltage that certainly moves the shaft, V.
    pub(super) moving_v: T,
    /// Number of steps after which an unchanged counter is frozen, and after which a loop with a
    /// repaired encoder resumes compensation.
    pub(super) patience: u32,
}

/// Counters of the detection of encoder faults, in steps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct State {
    /// Steps without a count under a voltage that moves the shaft.
    pushed: u32,
    /// Remaining steps of a fault that the compensator's observer inferred.
    doubt: u32,
    /// Number of faults that the compensator's observer inferred since the last count.
    doubts: u32,
    /// Remaining steps in which the encoder is considered faulty.
    blind: u32,
}

impl<T: Real> FaultDetector<T> {
    /// Checks a sample; returns the status flags, and true if the encoder is considered faulty.
    ///
    /// The encoder is considered faulty during a fault and for [`FaultDetector::patience`] steps after it.
    #[inline]
    pub(super) fn step(
        &self,
        state: &mut State,
        sample: &encoder::Sample<T>,
        applied_v: T,
        doubted: bool,
        target: Status,
    ) -> (Status, bool) {
        let mut status = target;
        if sample.jumped {
            status |= Status::JUMPED;
        }
        if self.frozen(state, sample, applied_v, doubted) {
            status |= Status::FROZEN;
        }
        let unsound = Status::FROZEN | Status::JUMPED | Status::NOT_FINITE;
        if status.has(unsound) {
            state.blind = self.patience;
        } else {
            state.blind = state.blind.saturating_sub(1);
        }
        (status, state.blind > 0)
    }

    #[inline]
    fn frozen(
        &self,
        state: &mut State,
        sample: &encoder::Sample<T>,
        applied_v: T,
        doubted: bool,
    ) -> bool {
        if sample.still == 0 {
            state.pushed = 0;
        } else if applied_v.abs() >= self.moving_v {
            state.pushed = state.pushed.saturating_add(1);
        } else if state.pushed < self.patience {
            // Once frozen, only a count shows that the encoder works again.
            state.pushed = 0;
        }
        if sample.still == 0 {
            (state.doubt, state.doubts) = (0, 0);
        } else if doubted {
            // A doubt may be wrong, and the control law alone may be too weak to disprove it.
            // Compensation is therefore tried again after a time that doubles.
            state.doubt = self.patience << state.doubts.min(LONGEST_DOUBT);
            state.doubts = state.doubts.saturating_add(1);
        } else {
            state.doubt = state.doubt.saturating_sub(1);
        }
        state.pushed >= self.patience || state.doubt > 0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const DETECTOR: FaultDetector<f64> = FaultDetector {
        moving_v: 1.0,
        patience: 3,
    };

    fn sample(still: u32, jumped: bool) -> encoder::Sample<f64> {
        encoder::Sample {
            moved_rad: 0.0,
            jumped,
            still,
        }
    }

    /// Number of steps until the loop resumes compensation, if no further fault occurs.
    fn blind_for(state: &mut State, still: u32) -> u32 {
        (0..10_000)
            .take_while(|_| {
                DETECTOR
                    .step(state, &sample(still, false), 0.0, false, Status::OK)
                    .1
            })
            .count() as u32
    }

    #[test]
    fn encoder_without_counts_is_reported_frozen_if_the_voltage_should_move_the_shaft() {
        let mut state = State::default();
        for step in 1..=2 {
            let (status, blind) =
                DETECTOR.step(&mut state, &sample(step, false), 1.0, false, Status::OK);
            assert!(status == Status::OK && !blind);
        }
        let (status, blind) = DETECTOR.step(&mut state, &sample(3, false), 1.0, false, Status::OK);
        assert!(status == Status::FROZEN && blind);
        // A voltage that does not move the shaft proves nothing; a count does.
        let (status, _) = DETECTOR.step(&mut state, &sample(4, false), 0.0, false, Status::OK);
        assert!(status == Status::FROZEN);
        let (status, blind) = DETECTOR.step(&mut state, &sample(0, false), 0.0, false, Status::OK);
        assert!(status == Status::OK && blind);
        assert_eq!(blind_for(&mut state, 0), 1);
    }

    #[test]
    fn constant_counter_is_accepted_below_the_moving_voltage() {
        let mut state = State::default();
        for step in 1..100 {
            let (status, _) =
                DETECTOR.step(&mut state, &sample(step, false), 0.99, false, Status::OK);
            assert!(status == Status::OK);
        }
    }

    #[test]
    fn encoder_is_faulty_for_the_patience_after_a_jump_or_an_invalid_target() {
        for (jumped, target) in [(true, Status::OK), (false, Status::NOT_FINITE)] {
            let mut state = State::default();
            let (status, blind) = DETECTOR.step(&mut state, &sample(0, jumped), 0.0, false, target);
            assert!(blind && status.has(Status::JUMPED) == jumped && status.has(target) != jumped);
            assert_eq!(blind_for(&mut state, 0), 2);
        }
    }

    #[test]
    fn inferred_fault_lasts_twice_as_long_each_time_until_the_counter_changes() {
        let mut state = State::default();
        let mut lasted = [0; 3];
        for time in &mut lasted {
            DETECTOR.step(&mut state, &sample(9, false), 0.0, true, Status::OK);
            *time = blind_for(&mut state, 9);
        }
        assert_eq!(lasted, [3 - 1 + 2, 6 - 1 + 2, 12 - 1 + 2]);
        DETECTOR.step(&mut state, &sample(0, false), 0.0, false, Status::OK);
        DETECTOR.step(&mut state, &sample(9, false), 0.0, true, Status::OK);
        assert_eq!(blind_for(&mut state, 9), 3 - 1 + 2);
    }
}
