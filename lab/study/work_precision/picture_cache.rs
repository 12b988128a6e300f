//! Reference pictures as bytes, whole or as far as a stopped one got, with a hash that tells damage.

use voltet_core::picture::Picture;
use voltet_nodes::files::Fnv;
use voltet_optics::trace::{TILE_PIXELS, Tiles};

/// First bytes of a kept picture. The number changes with the format, and with the referee's meaning of a scene.
const MAGIC: &[u8; 16] = b"voltet picture 1";

/// First bytes of a picture that was stopped.
const MAGIC_TILES: &[u8; 16] = b"voltet tiles   1";

pub(super) fn encode(picture: &Picture, seconds: f64) -> Vec<u8> {
    let mut bytes = MAGIC.to_vec();
    [picture.width as u64, picture.height as u64].iter().for_each(|n| bytes.extend(n.to_le_bytes()));
    bytes.extend(seconds.to_le_bytes());
    picture.rgba.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    checked(bytes)
}

/// With a hash of the content behind it.
fn checked(mut bytes: Vec<u8>) -> Vec<u8> {
    let mut check = Fnv::default();
    check.bytes(&bytes);
    bytes.extend(check.0.to_le_bytes());
    bytes
}

/// The content behind the first bytes; `None` for what is damaged or something else.
fn content<'a>(bytes: &'a [u8], magic: &[u8; 16]) -> Option<&'a [u8]> {
    let (content, check) = bytes.split_at_checked(bytes.len().checked_sub(16)?)?;
    let mut found = Fnv::default();
    found.bytes(content);
    content.strip_prefix(magic).filter(|_| check == found.0.to_le_bytes())
}

/// The picture and its seconds; `None` for what is damaged, of another size or another version.
pub(super) fn decode(bytes: &[u8], [width, height]: [usize; 2]) -> Option<(Picture, f64)> {
    let (head, pixels) = content(bytes, MAGIC)?.split_first_chunk::<24>()?;
    let number = |k: usize| <[u8; 8]>::try_from(&head[8 * k..8 * k + 8]).ok();
    let size = [u64::from_le_bytes(number(0)?), u64::from_le_bytes(number(1)?)];
    let sound = size == [width as u64, height as u64] && pixels.len() == 16 * width * height;
    let rgba = || pixels.chunks_exact(16).map(pixel).collect();
    Some((sound.then(|| Picture { width, height, rgba: rgba() })?, f64::from_le_bytes(number(2)?)))
}

fn pixel(bytes: &[u8]) -> [f32; 4] {
    std::array::from_fn(|k| f32::from_le_bytes(std::array::from_fn(|byte| bytes[4 * k + byte])))
}

/// The tiles that are drawn, and the seconds that they took.
pub(super) fn encode_tiles(tiles: &Tiles, seconds: f64) -> Vec<u8> {
    let mut bytes = MAGIC_TILES.to_vec();
    bytes.extend(seconds.to_le_bytes());
    for (tile, pixels) in tiles {
        bytes.extend(tile.to_le_bytes());
        pixels.iter().flatten().for_each(|x| bytes.extend(x.to_le_bytes()));
    }
    checked(bytes)
}

/// Tiles read back; `None` for what is damaged.
pub(super) fn decode_tiles(bytes: &[u8]) -> Option<(Tiles, f64)> {
    let (seconds, tiles) = content(bytes, MAGIC_TILES)?.split_first_chunk::<8>()?;
    let each = tiles.chunks_exact(4 + 16 * TILE_PIXELS);
    let whole = each.remainder().is_empty();
    let tiles = each.map(|bytes| {
        let (number, pixels) = bytes.split_at(4);
        let number = u32::from_le_bytes([number[0], number[1], number[2], number[3]]);
        (number, pixels.chunks_exact(16).map(pixel).collect())
    });
    whole.then(|| (tiles.collect(), f64::from_le_bytes(*seconds)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_kept_picture_reads_back_and_a_damaged_one_does_not() {
        let picture = Picture { width: 2, height: 1, rgba: vec![[0.1, 2.5, 1e-20, 1.0], [0.0; 4]] };
        let bytes = encode(&picture, 3.5);
        assert_eq!(decode(&bytes, [2, 1]), Some((picture, 3.5)));
        assert_eq!(decode(&bytes, [1, 2]), None);
        for (place, _) in bytes.iter().enumerate() {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert_eq!(decode(&damaged, [2, 1]), None, "byte {place}");
            assert_eq!(decode(&bytes[..place], [2, 1]), None, "cut at {place}");
        }
    }

    #[test]
    fn tiles_read_back_and_damaged_ones_do_not() {
        let pixels = |x: f32| vec![[x, 0.5, 1e-20, 1.0]; TILE_PIXELS];
        let tiles = Tiles::from([(0, pixels(0.25)), (7, pixels(3.5))]);
        let bytes = encode_tiles(&tiles, 2.5);
        assert_eq!(decode_tiles(&bytes), Some((tiles, 2.5)));
        assert_eq!(decode(&bytes, [16, 16]), None);
        for place in [0, 20, 30, 5000, bytes.len() - 1] {
            let mut damaged = bytes.clone();
            damaged[place] ^= 1;
            assert_eq!(decode_tiles(&damaged), None, "byte {place}");
            assert_eq!(decode_tiles(&bytes[..place]), None, "cut at {place}");
        }
    }
}
