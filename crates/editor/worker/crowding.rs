//! Coarse pictures on a device that holds or sorts so many cells of a tile and no more: the fewer pixels a picture has, the more cells lie in each
//! of its tiles.

use super::request::{Change, RenderRequest};
use std::collections::BTreeMap;
use voltet_core::Result;
use voltet_core::error::ErrorKind;

/// Greatest divisors of the sides of pictures that are worth a try, by their nodes, each with the request for which a coarser picture was too
/// crowded. They hold while a hand moves, and are forgotten with another size, other nodes or another engine.
#[derive(Debug, Default)]
pub(crate) struct Crowding(BTreeMap<String, (RenderRequest, u32)>);

impl Crowding {
    /// The picture whose sides are divided by the first divisor, or by the greatest one that is worth a try; where a tile of it is too crowded
    /// for a device, one of twice the resolution, and so on up to the second divisor, in which a tile has the fewest cells. `draw`: draws
    /// with a divisor. Errors: those of `draw`; that of a crowded tile where the finest picture has one.
    pub fn finer_where_crowded<T>(
        &mut self,
        wanted: &RenderRequest,
        [first, finest]: [u32; 2],
        mut draw: impl FnMut(u32) -> Result<T>,
    ) -> Result<T> {
        let mut divisor = first.min(self.coarsest(wanted).unwrap_or(first)).max(finest);
        loop {
            match draw(divisor) {
                Err(error) if error.kind == ErrorKind::CrowdedTile && divisor > finest => {
                    divisor = (divisor / 2).max(finest);
                    self.0.insert(wanted.node.clone(), (wanted.clone(), divisor));
                }
                drawn => return drawn,
            }
        }
    }

    fn coarsest(&self, wanted: &RenderRequest) -> Option<u32> {
        let (of, divisor) = self.0.get(&wanted.node)?;
        let holds = of.pixels() == wanted.pixels() && Change::between(of, wanted).moves;
        holds.then_some(*divisor)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use voltet_core::Error;
    use voltet_graph::pipeline::Pipeline;

    fn wanted(change: [&str; 2]) -> RenderRequest {
        let text = include_str!("../ui_tests/scene.toml");
        assert!(text.contains(change[0]), "{}", change[0]);
        let nodes = Pipeline::parse(&text.replacen(change[0], change[1], 1)).unwrap().nodes;
        RenderRequest { coarse_first: true, ..RenderRequest::of_picture(nodes) }
    }

    /// Divisors that are tried where a device holds pictures from `held` on alone.
    fn tried(
        crowding: &mut Crowding,
        wanted: &RenderRequest,
        range: [u32; 2],
        held: u32,
    ) -> (Vec<u32>, bool) {
        let mut all = Vec::new();
        let drawn = crowding.finer_where_crowded(wanted, range, |divisor| {
            all.push(divisor);
            let crowded = || Error::new(ErrorKind::CrowdedTile, "a tile is crowded");
            if divisor > held { Err(crowded()) } else { Ok(()) }
        });
        (all, drawn.is_ok())
    }

    #[test]
    fn divisors_in_vain_are_tried_once_for_each_size_and_pipeline() {
        let mut crowding = Crowding::default();
        let same = wanted(["", ""]);
        assert_eq!(tried(&mut crowding, &same, [8, 1], 1), (vec![8, 4, 2, 1], true));
        // Whatever was drawn meanwhile, and while a hand moves the view.
        for moved in [same.clone(), wanted(["eye = [-28.0", "eye = [-29.0"])] {
            assert_eq!(tried(&mut crowding, &moved, [8, 1], 1), (vec![1], true));
        }
        for other in [
            wanted(["size = [160", "size = [320"]),
            RenderRequest { size: Some([64, 48]), ..same.clone() },
            wanted(["engine = \"cpu\"", "engine = \"auto\""]),
        ] {
            assert_eq!(tried(&mut crowding, &other, [8, 1], 4), (vec![8, 4], true));
        }
    }

    #[test]
    fn no_picture_is_finer_than_is_allowed() {
        let mut crowding = Crowding::default();
        let same = wanted(["", ""]);
        assert_eq!(tried(&mut crowding, &same, [13, 4], 1), (vec![13, 6, 4], false));
        assert_eq!(tried(&mut crowding, &same, [13, 4], 4), (vec![4], true));
    }
}
