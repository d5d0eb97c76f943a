//! Tests that the excitation of the loops contains all demanding conditions, so that a time budget
//! with it is a worst case.

use jbf_core::compensator::Compensator;
use jbf_core::controller::{Controller, Status};
use jbf_trace::loops::{each, LoopVisitor};
use jbf_trace::{asked, Shaft, LOOP_STEPS};

struct Look;

impl LoopVisitor<f32> for Look {
    fn visit<C: Compensator<f32>>(
        &mut self,
        name: &'static str,
        controller: &Controller<f32, C>,
        position: bool,
    ) {
        let (mut state, mut shaft) = (controller.start(), Shaft::default());
        let (mut reversals, mut before, mut seen) = (0, 0.0_f32, Status::OK);
        let mut crawl = 0.0_f32;
        for step in 0..LOOP_STEPS {
            let (target, level_v) = asked(step, position);
            let parts = controller.step(&mut state, shaft.counter(step), &target);
            assert!(parts.output_v.abs() <= 10.0, "{name}");
            shaft.push(parts.output_v, level_v);
            reversals += u32::from(parts.velocity_rad_s * before < 0.0);
            before = parts.velocity_rad_s;
            seen |= parts.status;
            if (3200..4000).contains(&step) {
                crawl = crawl.max(parts.velocity_rad_s.abs());
            }
        }
        assert!(reversals > 30, "{name}: {reversals} reversals");
        for flag in [Status::FROZEN, Status::JUMPED, Status::FALLBACK] {
            assert!(seen.has(flag), "{name}: {seen:?}");
        }
        assert!(position || seen.has(Status::SATURATED), "{name}: {seen:?}");
        assert!(position || crawl < 1.0, "{name}: {crawl} rad/s");
    }
}

#[test]
fn every_loop_trace_contains_reversals_saturation_and_encoder_faults() {
    each(&mut Look).expect("every loop can be built");
}
