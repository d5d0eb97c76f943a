//! FNV-1a hash (Fowler, Noll & Vo) of 64 bits, which changes with any bit of the input.

use jbf_core::Real;

/// Hash of a sequence of numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Hash(pub u64);

impl Default for Hash {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Hash {
    /// Adds a number to the hash.
    ///
    /// A number in single precision is converted to double precision, which is exact for a finite
    /// number.
    pub fn take<T: Real>(&mut self, number: T) {
        for byte in number.value().to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
