//! Macro that generates the catalogue of laws, and the selection of a law by name.
//!
//! The list in `law/mod.rs` is its input.

/// Implements [`Named`](super::Named) for a law in newtons with `Parameters`.
macro_rules! named_law {
    ($Owner:ident $info:expr) => {
        impl<T: $crate::real::Real> $crate::law::Named<T> for $Owner<T> {
            const INFO: $crate::law::Info =
                $info.rust_type(stringify!($Owner)).parameters(PARAMETERS);

            fn build(
                _bearing: Option<&$crate::bearing::Bearing>,
                _load_n: Option<f64>,
                values: &[T],
                _clock: $crate::clock::Clock,
            ) -> Result<Self, $crate::error::Error> {
                Parameters::of(values).map(Self::with_parameters)
            }
        }
    };
}

macro_rules! laws {
    ($($module:ident::$Type:ident),* $(,)?) => {
        /// Descriptions of all laws; the first is the default law.
        pub const CATALOGUE: &[Info] = &[$(<$module::$Type<f64> as Named<f64>>::INFO,)*];

        /// Creates the law `name` and passes it to `visitor`, which is compiled for the type of
        /// each law.
        ///
        /// # Errors
        /// As [`Named::build`]; an unknown name is reported as the parameter `law`.
        pub fn with_law<T: Real, V: Visitor<T>>(
            name: &str,
            bearing: Option<&Bearing>,
            load_n: Option<f64>,
            values: &[T],
            clock: Clock,
            visitor: V,
        ) -> Result<V::Output, Error> {
            $(if name == <$module::$Type<T> as Named<T>>::INFO.name {
                let law = <$module::$Type<T> as Named<T>>::build(bearing, load_n, values, clock)?;
                return Ok(visitor.visit(law));
            })*
            Err(Error::UnknownLaw)
        }

        /// Computes the steady friction (N) of the law `name` at speeds (m/s, not zero) into `out`.
        ///
        /// # Errors
        /// As [`Named::build`] and [`SteadyCurve::steady_n`].
        pub fn steady_n(
            name: &str,
            bearing: Option<&Bearing>,
            load_n: Option<f64>,
            values: &[f64],
            clock: Clock,
            velocity_m_s: &[f64],
            out: &mut [f64],
        ) -> Result<(), Error> {
            $(if name == <$module::$Type<f64> as Named<f64>>::INFO.name {
                let law =
                    <$module::$Type<f64> as Named<f64>>::build(bearing, load_n, values, clock)?;
                for (f, &v) in out.iter_mut().zip(velocity_m_s) {
                    *f = law.steady_n(v)?;
                }
                return Ok(());
            })*
            Err(Error::UnknownLaw)
        }
    };
}

pub(crate) use {laws, named_law};
