//! Macro for the builder methods of types that hold settings.
//!
//! A constructor takes the required values, and `with_NAME` methods set the rest. A new field
//! therefore does not break existing callers.

/// Defines `with_NAME` setters for the fields of a struct: `with_output_v => output_v: f64`.
macro_rules! with_fields {
    ($($method:ident => $field:ident: $t:ty),* $(,)?) => {
        $(
            #[doc = concat!("Sets [`", stringify!($field), "`](Self::", stringify!($field), ").")]
            #[must_use]
            pub const fn $method(mut self, $field: $t) -> Self {
                self.$field = $field;
                self
            }
        )*
    };
}

pub(crate) use with_fields;
