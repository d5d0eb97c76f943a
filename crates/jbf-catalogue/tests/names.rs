//! Tests of the names of start values and bounds.

use jbf_catalogue::{Bound, Start};

/// The names of start rules and bounds in files and in Python are unique.
#[test]
fn start_rules_and_bounds_have_their_names_in_files() {
    let names = [
        (Start::Catalogue, "catalogue"),
        (Start::Kinetic, "kinetic"),
        (Start::Breakaway, "breakaway"),
        (Start::BreakawayExcess, "breakaway_excess"),
        (Start::Viscous, "viscous"),
        (Start::StribeckSpeed, "stribeck_speed"),
        (Start::UsualSpeed, "usual_speed"),
        (Start::Slowness, "slowness"),
        (Start::Stiffness, "stiffness"),
        (Start::Damping, "damping"),
        (Start::Drag, "drag"),
        (Start::Mass, "mass"),
        (Start::Pitch, "pitch"),
        (Start::RipplePitch, "ripple_pitch"),
        (Start::RunTime, "run_time"),
        (Start::ReferenceTemperature, "reference_temperature"),
        (Start::CellPlay, "cell_play"),
        (Start::CellCubic, "cell_cubic"),
        (Start::StrokeMiddle, "stroke_middle"),
        (Start::StrokeHalf, "stroke_half"),
        (Start::Lateness, "lateness"),
        (Start::DrivePlay, "drive_play"),
        (Start::DriveStiffness, "drive_stiffness"),
        (Start::DriveInertia, "drive_inertia"),
        (Start::DriveDamping, "drive_damping"),
    ];
    for (start, name) in names {
        assert_eq!(start.name(), name);
    }
    assert_eq!(Bound::Catalogue.name(), "catalogue");
    assert_eq!(Bound::TransitionSpeed.name(), "transition_speed");
}
