//! Prediction of friction readings along records, with derivatives with respect to the parameters,
//! for laws and effects that are selected by name at run time.
//!
//! ```
//! use jbf_core::{law, run::Record, Clock};
//! use jbf_predict::Model;
//!
//! let coulomb = law::CATALOGUE.iter().find(|info| info.name == "coulomb").unwrap();
//! let model = Model {
//!     law: coulomb,
//!     bearing: None,
//!     load_n: None,
//!     clock: Clock::Journal,
//!     effects: &[],
//!     max_step_s: 0.02,
//! };
//! let record = Record {
//!     time_s: &[0.0, 0.1, 0.2],
//!     velocity_m_s: &[0.1, 0.2, 0.3],
//!     acceleration_m_s2: &[1.0, 1.0, 1.0],
//!     angle_rad: &[0.0, 0.015, 0.04],
//!     weight_offset_rad: None,
//!     load_n: &[1.0, 1.0, 1.0],
//!     temperature_c: None,
//! };
//! let parameters = vec![5.0; coulomb.parameters.len()];
//! let (readings, derivatives) = model.derivatives(&parameters, &[0], &record, None)?;
//! assert_eq!(readings, model.readings(&parameters, &record, None)?);
//! assert_eq!(derivatives.len(), 3);
//! # Ok::<(), jbf_core::Error>(())
//! ```

mod model;
mod outlined;
mod passes;
mod run;

pub use model::{FilmPath, Model};
pub use passes::parameter_passes;
