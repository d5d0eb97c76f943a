//! Builders: settings begin with what they cannot do without, and `with_NAME` gives the rest. A
//! field more is then no break for those who do not know it.

/// `with_NAME` for fields of a struct: `with_output_v => output_v: f64`.
macro_rules! with_fields {
    ($($method:ident => $field:ident: $t:ty),* $(,)?) => {
        $(
            #[doc = concat!("The same with another `", stringify!($field), "`.")]
            #[must_use]
            pub const fn $method(mut self, $field: $t) -> Self {
                self.$field = $field;
                self
            }
        )*
    };
}

pub(crate) use with_fields;
