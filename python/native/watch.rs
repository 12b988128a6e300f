//! Watched arrays: changes of their bytes, piece by piece.

use crate::memory::Lent;
use rayon::prelude::*;

/// The bytes of a piece.
const TOGETHER: usize = 1 << 18;

/// The bytes of an array, and a fingerprint of every piece of them as it was.
pub struct Watched {
    memory: Lent<u8>,
    prints: Vec<u64>,
}

impl Watched {
    /// As the bytes are now; on all cores.
    pub fn new(memory: Lent<u8>) -> Watched {
        let prints = memory.values().par_chunks(TOGETHER).map(fingerprint).collect();
        Watched { memory, prints }
    }

    /// The pieces.
    pub fn pieces(&self) -> impl Iterator<Item = Piece<'_>> {
        let pieces = self.memory.values().chunks(TOGETHER).zip(&self.prints);
        pieces.map(|(bytes, &print)| Piece { bytes, print })
    }
}

/// Bytes, and their former fingerprint.
pub struct Piece<'a> {
    bytes: &'a [u8],
    print: u64,
}

impl Piece<'_> {
    /// True if the bytes have changed.
    pub fn is_changed(&self) -> bool {
        fingerprint(self.bytes) != self.print
    }
}

/// True if any piece has changed; on all cores.
pub fn any_changed(pieces: &[Piece<'_>]) -> bool {
    pieces.par_iter().any(Piece::is_changed)
}

/// A number made of all bytes: other bytes have another, but for chance. Eight lanes of 64-bit words, each multiplied by an odd
/// number, so that the memory is what it waits for.
fn fingerprint(bytes: &[u8]) -> u64 {
    let (words, rest) = bytes.as_chunks::<64>();
    let mut lanes: [u64; 8] = std::array::from_fn(|i| (i as u64 + 1).wrapping_mul(MULTIPLIER) | 1);
    for word in words {
        for (lane, eight) in lanes.iter_mut().zip(word.as_chunks::<8>().0) {
            *lane = (*lane ^ u64::from_le_bytes(*eight)).wrapping_mul(MULTIPLIER).rotate_left(29);
        }
    }
    for &byte in rest {
        lanes[0] = (lanes[0] ^ u64::from(byte)).wrapping_mul(MULTIPLIER);
    }
    lanes.iter().fold(0, |sum, &lane| (sum ^ lane ^ (lane >> 32)).wrapping_mul(MULTIPLIER))
}

/// Multiplier of Steele and Vigna (2021), for 64 bits.
const MULTIPLIER: u64 = 0xd134_2543_de82_ef95;
