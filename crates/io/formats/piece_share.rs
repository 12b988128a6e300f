//! Share of one of several processes in the pieces of a file, and what they send each other about these.

use serde::Serialize;
use serde::de::DeserializeOwned;
use std::collections::BTreeSet;
use voltet_core::grid::PointKeys;
use voltet_core::{Error, Result};
use voltet_graph::ranks::{OneRank, Ranks};

/// Pieces that this process reads; all of them where it is alone.
pub(super) struct Share<'a> {
    others: Option<(BTreeSet<usize>, &'a dyn Ranks)>,
}

impl<'a> Share<'a> {
    /// `share`: the pieces of this process, and all processes; `None`: there is one.
    pub fn new(share: Option<(&[usize], &'a dyn Ranks)>) -> Share<'a> {
        let several = share.filter(|(_, ranks)| ranks.count() > 1);
        Share { others: several.map(|(own, ranks)| (own.iter().copied().collect(), ranks)) }
    }

    /// True if there are no other processes.
    pub fn is_alone(&self) -> bool {
        self.others.is_none()
    }

    /// True if this process reads a piece.
    pub fn has(&self, piece: usize) -> bool {
        self.others.as_ref().is_none_or(|(own, _)| own.contains(&piece))
    }

    /// Keys of own pieces that another piece has, too.
    ///
    /// # Errors
    /// As [`Share::gather`].
    pub fn shared_keys(&self, own: Vec<(usize, PointKeys)>) -> Result<Vec<(usize, PointKeys)>> {
        let ranks = self.others.as_ref().map_or(&OneRank as &dyn Ranks, |others| others.1);
        let (numbers, mut keys): (Vec<usize>, Vec<PointKeys>) = own.into_iter().unzip();
        PointKeys::retain_shared(&mut keys, ranks.count(), &|to_each| ranks.exchange(to_each))?;
        Ok(numbers.into_iter().zip(keys).collect())
    }

    /// Values of all processes, this one's included.
    ///
    /// # Errors
    /// - another process ended, or sent what this one does not understand.
    pub fn gather<T: Serialize + DeserializeOwned>(&self, own: Vec<T>) -> Result<Vec<T>> {
        let Some((_, ranks)) = &self.others else { return Ok(own) };
        let bytes = to_bytes(&own)?;
        received(*ranks, vec![bytes; ranks.count()])
    }

    /// Values of own pieces with those of the pieces of others that `reaches` an own one: `reaches(from, to)` is true where the process
    /// with the pieces `to` needs the value of the piece `from`.
    ///
    /// # Errors
    /// As [`Share::gather`].
    pub fn exchange<T: Serialize + DeserializeOwned>(
        &self,
        own: Vec<(usize, T)>,
        reaches: impl Fn(usize, &BTreeSet<usize>) -> bool,
    ) -> Result<Vec<(usize, T)>> {
        let Some((pieces, ranks)) = &self.others else { return Ok(own) };
        let shares: Vec<(usize, BTreeSet<usize>)> = self.gather(vec![(ranks.rank(), pieces.clone())])?;
        let mut to_each = vec![Vec::new(); ranks.count()];
        for (rank, pieces) in shares.into_iter().filter(|(rank, _)| *rank != ranks.rank()) {
            let needed: Vec<&(usize, T)> = own.iter().filter(|(piece, _)| reaches(*piece, &pieces)).collect();
            to_each[rank] = to_bytes(&needed)?;
        }
        let mut all = received(*ranks, to_each)?;
        all.extend(own);
        Ok(all)
    }
}

fn to_bytes<T: Serialize>(values: &T) -> Result<Vec<u8>> {
    postcard::to_allocvec(values)
        .map_err(|error| Error::run("the borders of pieces cannot be sent to another process").got(error))
}

/// Values that each process sent, put together.
fn received<T: DeserializeOwned>(ranks: &dyn Ranks, to_each: Vec<Vec<u8>>) -> Result<Vec<T>> {
    let mut all = Vec::new();
    for bytes in ranks.exchange(to_each)?.iter().filter(|bytes| !bytes.is_empty()) {
        let broken = |error| {
            let error = Error::run("another process sent broken borders of pieces").got(error);
            error.expected("the program in one version on all processes")
        };
        all.extend(postcard::from_bytes::<Vec<T>>(bytes).map_err(broken)?);
    }
    Ok(all)
}
