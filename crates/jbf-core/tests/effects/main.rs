//! The effects, over the whole catalogue where a rule holds for all, and against closed forms
//! one by one.

#[path = "../common/mod.rs"]
mod common;

mod backlash;
mod coulomb_drag;
mod derivatives;
mod drive_compliance;
mod finite;
mod load_dependence;
mod null;
mod position_ripple;
mod presliding;
mod sensor_lag;
mod symmetry;
mod thermal_thinning;
mod time_delay;
mod together;
