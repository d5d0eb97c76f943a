//! Tests of the laws in newtons: rules for all laws of the catalogue, and a closed form for each.

#[path = "../common/mod.rs"]
mod common;

mod closed_forms;
mod derivatives;
mod elasto_plastic;
mod energy;
mod finite;
mod limits;
mod maxwell_slip;
mod needs;
mod rate_and_state;
mod seven_parameter;
mod steps;
mod support;
mod symmetry;
