//! C interface of `jbf-core`, for firmware in C; `include/jbf.h` documents its functions.
//!
//! Every law has its own functions in single and in double precision, so that a linker keeps only
//! those that are called. The C program provides the memory of models and states. Nothing is
//! allocated, and a step cannot panic. `jbf export MODEL --c model.h` writes the calls that build a
//! fitted model.
#![cfg_attr(not(feature = "std"), no_std)]
// The requirements on pointers are stated once, in the header.
#![allow(clippy::missing_safety_doc)]

mod model;
mod types;

pub use types::{CBearing, CError, CMotion, CRecord, NAME, NULL, OK, PARAMETER};

use core::ffi::c_char;
use core::mem::{align_of, size_of};
use jbf_core::{chain::State, law, Chain};

/// Satisfies the compiler's requirement of a panic handler; no step and no constructor can panic.
#[cfg(not(feature = "std"))]
#[panic_handler]
fn panic(_info: &core::panic::PanicInfo<'_>) -> ! {
    loop {
        core::hint::spin_loop();
    }
}

/// Size of the memory of a law in C: name, number type, and the sizes of a model and a state in the
/// header, in 64-bit words.
pub type Size = (&'static str, &'static str, usize, usize);

macro_rules! laws {
    ($($module:ident::$Type:ident, $kind:ident,
       $init:ident $effect:ident $start:ident $step:ident $predict:ident,
       $model_words:literal, $state_words:literal;)*) => {
        /// Sizes of all pairs of a law and a number type, as declared in the header.
        pub const SIZES: &[Size] =
            &[$((stringify!($module), stringify!($kind), $model_words, $state_words),)*];
        $(
            const _: () = {
                type Model = Chain<$kind, law::$module::$Type<$kind>>;
                type Changes = State<
                    $kind,
                    <law::$module::$Type<$kind> as law::Law<$kind>>::State,
                >;
                assert!(size_of::<Model>() <= 8 * $model_words);
                assert!(size_of::<Changes>() <= 8 * $state_words);
                assert!(align_of::<Model>() <= 8 && align_of::<Changes>() <= 8);
            };

            /// Builds the law; see `jbf_LAW_TYPE_init` in `jbf.h`.
            ///
            /// # Safety
            /// Each pointer must be null, or valid as `jbf.h` requires.
            #[no_mangle]
            pub unsafe extern "C" fn $init(
                model: *mut Chain<$kind, law::$module::$Type<$kind>>,
                bearing: *const CBearing,
                load_n: f64,
                parameters: *const f64,
                count: usize,
                clock: i32,
                error: *mut CError,
            ) -> i32 {
                model::init(model, bearing, load_n, (parameters, count), clock, error)
            }

            /// Adds an effect to a model; see `jbf_LAW_TYPE_effect` in `jbf.h`.
            ///
            /// # Safety
            /// Each pointer must be null, or valid as `jbf.h` requires.
            #[no_mangle]
            pub unsafe extern "C" fn $effect(
                model: *mut Chain<$kind, law::$module::$Type<$kind>>,
                name: *const c_char,
                parameters: *const f64,
                count: usize,
                error: *mut CError,
            ) -> i32 {
                model::effect(model, name, (parameters, count), error)
            }

            /// Sets the state of a model at the first sample; see `jbf_LAW_TYPE_start` in `jbf.h`.
            ///
            /// # Safety
            /// Each pointer must be null, or valid as `jbf.h` requires.
            #[no_mangle]
            pub unsafe extern "C" fn $start(
                model: *const Chain<$kind, law::$module::$Type<$kind>>,
                state: *mut State<$kind, <law::$module::$Type<$kind> as law::Law<$kind>>::State>,
                motion: *const CMotion<$kind>,
            ) -> $kind {
                model::start(model, state, motion)
            }

            /// Advances a model by one step; see `jbf_LAW_TYPE_step` in `jbf.h`.
            ///
            /// # Safety
            /// Each pointer must be null, or valid as `jbf.h` requires.
            #[no_mangle]
            pub unsafe extern "C" fn $step(
                model: *const Chain<$kind, law::$module::$Type<$kind>>,
                state: *mut State<$kind, <law::$module::$Type<$kind> as law::Law<$kind>>::State>,
                motion: *const CMotion<$kind>,
                dt_s: $kind,
            ) -> $kind {
                model::step(model, state, motion, dt_s)
            }

            /// Predicts the friction along a whole record; see `jbf_LAW_TYPE_predict` in `jbf.h`.
            ///
            /// # Safety
            /// Each pointer must be null, or valid as `jbf.h` requires.
            #[no_mangle]
            pub unsafe extern "C" fn $predict(
                model: *const Chain<$kind, law::$module::$Type<$kind>>,
                record: *const CRecord,
                max_step_s: f64,
                out_n: *mut $kind,
            ) -> i32 {
                model::whole(model, record, max_step_s, out_n)
            }
        )*
    };
}

// The sizes are those of `include/jbf.h`; a test compares them.
laws! {
    journal::Journal, f32,
        jbf_journal_f32_init jbf_journal_f32_effect jbf_journal_f32_start jbf_journal_f32_step jbf_journal_f32_predict,
        96, 128;
    journal::Journal, f64,
        jbf_journal_f64_init jbf_journal_f64_effect jbf_journal_f64_start jbf_journal_f64_step jbf_journal_f64_predict,
        192, 256;
    journal_full::JournalFull, f32,
        jbf_journal_full_f32_init jbf_journal_full_f32_effect jbf_journal_full_f32_start jbf_journal_full_f32_step jbf_journal_full_f32_predict,
        96, 128;
    journal_full::JournalFull, f64,
        jbf_journal_full_f64_init jbf_journal_full_f64_effect jbf_journal_full_f64_start jbf_journal_full_f64_step jbf_journal_full_f64_predict,
        192, 256;
    coulomb::Coulomb, f32,
        jbf_coulomb_f32_init jbf_coulomb_f32_effect jbf_coulomb_f32_start jbf_coulomb_f32_step jbf_coulomb_f32_predict,
        96, 128;
    coulomb::Coulomb, f64,
        jbf_coulomb_f64_init jbf_coulomb_f64_effect jbf_coulomb_f64_start jbf_coulomb_f64_step jbf_coulomb_f64_predict,
        192, 256;
    stribeck::Stribeck, f32,
        jbf_stribeck_f32_init jbf_stribeck_f32_effect jbf_stribeck_f32_start jbf_stribeck_f32_step jbf_stribeck_f32_predict,
        96, 128;
    stribeck::Stribeck, f64,
        jbf_stribeck_f64_init jbf_stribeck_f64_effect jbf_stribeck_f64_start jbf_stribeck_f64_step jbf_stribeck_f64_predict,
        192, 256;
    seven_parameter::SevenParameter, f32,
        jbf_seven_parameter_f32_init jbf_seven_parameter_f32_effect jbf_seven_parameter_f32_start jbf_seven_parameter_f32_step jbf_seven_parameter_f32_predict,
        96, 192;
    seven_parameter::SevenParameter, f64,
        jbf_seven_parameter_f64_init jbf_seven_parameter_f64_effect jbf_seven_parameter_f64_start jbf_seven_parameter_f64_step jbf_seven_parameter_f64_predict,
        192, 384;
    dahl::Dahl, f32,
        jbf_dahl_f32_init jbf_dahl_f32_effect jbf_dahl_f32_start jbf_dahl_f32_step jbf_dahl_f32_predict,
        96, 128;
    dahl::Dahl, f64,
        jbf_dahl_f64_init jbf_dahl_f64_effect jbf_dahl_f64_start jbf_dahl_f64_step jbf_dahl_f64_predict,
        192, 256;
    lugre::LuGre, f32,
        jbf_lugre_f32_init jbf_lugre_f32_effect jbf_lugre_f32_start jbf_lugre_f32_step jbf_lugre_f32_predict,
        96, 128;
    lugre::LuGre, f64,
        jbf_lugre_f64_init jbf_lugre_f64_effect jbf_lugre_f64_start jbf_lugre_f64_step jbf_lugre_f64_predict,
        192, 256;
    maxwell_slip::MaxwellSlip, f32,
        jbf_maxwell_slip_f32_init jbf_maxwell_slip_f32_effect jbf_maxwell_slip_f32_start jbf_maxwell_slip_f32_step jbf_maxwell_slip_f32_predict,
        96, 128;
    maxwell_slip::MaxwellSlip, f64,
        jbf_maxwell_slip_f64_init jbf_maxwell_slip_f64_effect jbf_maxwell_slip_f64_start jbf_maxwell_slip_f64_step jbf_maxwell_slip_f64_predict,
        192, 256;
    elasto_plastic::ElastoPlastic, f32,
        jbf_elasto_plastic_f32_init jbf_elasto_plastic_f32_effect jbf_elasto_plastic_f32_start jbf_elasto_plastic_f32_step jbf_elasto_plastic_f32_predict,
        96, 128;
    elasto_plastic::ElastoPlastic, f64,
        jbf_elasto_plastic_f64_init jbf_elasto_plastic_f64_effect jbf_elasto_plastic_f64_start jbf_elasto_plastic_f64_step jbf_elasto_plastic_f64_predict,
        192, 256;
    rate_and_state::RateAndState, f32,
        jbf_rate_and_state_f32_init jbf_rate_and_state_f32_effect jbf_rate_and_state_f32_start jbf_rate_and_state_f32_step jbf_rate_and_state_f32_predict,
        96, 128;
    rate_and_state::RateAndState, f64,
        jbf_rate_and_state_f64_init jbf_rate_and_state_f64_effect jbf_rate_and_state_f64_start jbf_rate_and_state_f64_step jbf_rate_and_state_f64_predict,
        192, 256;
}
