//! A hash that stays the same from build to build, for keys of files and for telling damage.

/// FNV-1a of 128 bits (Fowler, Noll, Vo; RFC 9923).
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Fnv(pub u128);

impl Default for Fnv {
    fn default() -> Self {
        Fnv(0x6c62_272e_07bb_0142_62b8_2175_6295_c58d)
    }
}

impl Fnv {
    /// Takes in bytes.
    pub fn bytes(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u128::from(byte)).wrapping_mul(0x0000_0000_0100_0000_0000_0000_0000_013b);
        }
    }

    /// Takes in a text with its length, so that two texts are not one.
    pub fn text(&mut self, text: &str) {
        self.bytes(&(text.len() as u64).to_le_bytes());
        self.bytes(text.as_bytes());
    }

    /// Takes in numbers, bit by bit.
    pub fn numbers(&mut self, numbers: &[f64]) {
        numbers.iter().for_each(|x| self.bytes(&x.to_bits().to_le_bytes()));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_hash_is_the_published_one() {
        // RFC 9923 gives the value for no input (the basis) and for "a".
        let mut hash = Fnv::default();
        hash.bytes(b"a");
        assert_eq!(hash.0, 0xd228_cb69_6f1a_8caf_7891_2b70_4e4a_8964);
    }
}
