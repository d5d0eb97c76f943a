//! Parallel evaluation of many parameter sets of the journal law: multiple starts of a fit, a
//! sweep, a set of samples.
//!
//! Neighbouring sets share a register, the instruction set (SSE2, AVX2, AVX-512) is selected at run
//! time, and blocks of sets are distributed to all cores. The result is identical bit for bit for
//! any number of threads and any instruction set. It equals that of [`jbf_core`] stepping one set
//! after the other: the physics is the same code, over a [`Lane`].
//!
//! ```
//! use jbf_batch::{Batch, Method, Speeds};
//! use jbf_core::{law::journal::{Journal, Parameters}, Bearing, Clock, Error};
//!
//! let laws = (0..100)
//!     .map(|i| {
//!         let parameters = Parameters { f_m: 0.2 + 0.001 * f64::from(i), ..Parameters::TABLE_4_2 };
//!         Journal::new(&Bearing::THESIS, 104.0, &parameters, Clock::Journal)
//!     })
//!     .collect::<Result<Vec<_>, Error>>()?;
//! let batch = Batch::new(laws, Method::Euler);
//! let speeds: Vec<f64> = (0..500).map(|i| 0.127 * (0.002 * f64::from(i)).sin()).collect();
//! let mut friction = vec![0.0; 500 * 100];
//! batch.friction(&mut batch.start(), &Speeds::Common(&speeds), 0.002, &mut friction);
//! assert!(friction.iter().all(|f| f.is_finite()));
//! # Ok::<(), Error>(())
//! ```
//!
//! [`film_paths`] integrates a few films, each along its own motion. [`film_path`] stores the states
//! of a film along a record.

#![deny(missing_docs)]

mod batch;
pub mod film_path;
mod film_paths;
mod lane;
mod part;
mod simd;
mod speeds;
mod trajectories;

pub use batch::{Batch, Films, Method};
pub use film_paths::film_paths;
pub use jbf_core::internals::Along;
pub use lane::{Float, Lane};
pub use simd::{Baseline, InstructionSet, Simd};
pub use speeds::Speeds;
pub use trajectories::follow_side_by_side;
