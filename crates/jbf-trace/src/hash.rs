//! FNV-1a hash (Fowler, Noll & Vo), 64 bits: small, and any changed bit changes the hash.

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
    /// Single precision is widened, which keeps every bit of a finite number.
    pub fn take<T: Real>(&mut self, number: T) {
        for byte in number.value().to_bits().to_le_bytes() {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }
}
