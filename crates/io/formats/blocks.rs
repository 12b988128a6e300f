//! Blocks of a data set: element blocks, zones, cell zones, parts, leaves of a tree. Their names, the selection of some, and the cell
//! array [`BLOCK`] that holds the number of each cell's block.
//!
//! A format gives the names of all blocks ([`Dataset::blocks`]) and for each piece the numbers of those that its cells are of
//! ([`CellBlocks`]). It leaves out what [`selected`] says is not requested. Numbers are those of the file, whatever is selected.

use super::contents::{
    BLOCK, CellBlocks, Compute, Dataset, Encoding, NumberedPiece, Piece, PieceArray, Stored,
};
use super::numbers::NumberType;
use super::request::{ArraySelection, Request, list};
use super::source::Source;
use std::collections::BTreeMap;
use std::sync::Arc;
use voltet_core::grid::{Association, Cells};
use voltet_core::progress::refuse_beyond_memory;
use voltet_core::{Error, Result, agreeing, counted};

/// Name under which a cell array of the file itself is read that is called [`BLOCK`].
const OWN_BLOCK: &str = "block (of the file)";

/// For each block: true if one of the words names it. A word is a name, that of a group of blocks, or either with `*` for any letters.
///
/// # Errors
/// A word that names none, with the nearest name.
pub fn blocks_named(blocks: &[String], words: &[String]) -> Result<Vec<bool>> {
    let mut is_named = vec![false; blocks.len()];
    for word in words {
        let mut is_found = false;
        for (named, _) in
            is_named.iter_mut().zip(blocks).filter(|(_, name)| fits(word.as_bytes(), name.as_bytes()))
        {
            (*named, is_found) = (true, true);
        }
        if !is_found {
            return Err(unknown(blocks, word));
        }
    }
    Ok(is_named)
}

fn unknown(blocks: &[String], word: &str) -> Error {
    if blocks.is_empty() {
        return Error::run("the data have no blocks")
            .got(format_args!("'{word}'"))
            .expected("a file with blocks, such as .vtm or Exodus, or no names of blocks");
    }
    let error = Error::run("there is no such block").got(format_args!("'{word}'"));
    error.not_among(word, blocks.iter().map(String::as_str))
}

/// True if a text, or a part of it that ends before a `/`, is a pattern's, in which `*` stands for any letters.
fn fits(pattern: &[u8], text: &[u8]) -> bool {
    let (mut p, mut t) = (0, 0);
    // Places after the last `*` and of the text that it stands for so far.
    let mut star: Option<(usize, usize)> = None;
    loop {
        let is_end = p == pattern.len() && (t == text.len() || text[t] == b'/');
        if is_end {
            return true;
        }
        if pattern.get(p) == Some(&b'*') {
            p += 1;
            star = Some((p, t));
        } else if t < text.len() && pattern.get(p) == Some(&text[t]) {
            (p, t) = (p + 1, t + 1);
        } else {
            let Some((after, from)) = star.filter(|&(_, from)| from < text.len()) else { return false };
            star = Some((after, from + 1));
            (p, t) = (after, from + 1);
        }
    }
}

/// For each block: true if it is read.
///
/// Errors: the request names one that the file lacks.
pub(super) fn selected(blocks: &[String], request: &Request) -> Result<Vec<bool>> {
    match request.blocks.is_empty() {
        true => Ok(vec![true; blocks.len()]),
        false => blocks_named(blocks, &request.blocks),
    }
}

/// Adds the cell array [`BLOCK`] to the pieces of a file with blocks.
///
/// Errors: blocks are requested of a file without.
pub(super) fn number_cells(dataset: &mut Dataset, request: &Request, source: &Arc<Source>) -> Result<()> {
    if dataset.blocks.is_empty() {
        return request.blocks.first().map_or(Ok(()), |word| Err(unknown(&dataset.blocks, word)));
    }
    let mut has_own = false;
    for piece in &mut dataset.pieces {
        let cell_arrays = piece.arrays.iter_mut().filter(|array| array.association == Association::Cell);
        for own in cell_arrays.filter(|array| array.stored.name == BLOCK) {
            own.stored.name = OWN_BLOCK.to_owned();
            has_own = true;
        }
        piece.arrays.push(block_array(piece, source));
    }
    if has_own {
        let has_points = |piece: &Piece| piece.array(Association::Point, BLOCK).is_some();
        if dataset.active_scalars.as_deref() == Some(BLOCK) && !dataset.pieces.iter().any(has_points) {
            dataset.active_scalars = Some(OWN_BLOCK.to_owned());
        }
        dataset.warnings.push(format!(
            "The file's own cell array '{BLOCK}' is read as '{OWN_BLOCK}'; '{BLOCK}' holds the number of each cell's block."
        ));
    }
    Ok(())
}

fn block_array(piece: &Piece, source: &Arc<Source>) -> PieceArray {
    let runs = match piece.blocks.clone() {
        CellBlocks::One(block) => vec![(block, piece.cell_count)],
        CellBlocks::Runs(runs) => runs,
        CellBlocks::Each { numbers, .. } => return numbers_of(piece, source, numbers),
    };
    let count: u64 = runs.iter().fold(0, |sum, run| sum.saturating_add(run.1));
    let compute: Compute = Arc::new(move |meter| {
        refuse_beyond_memory(meter.progress(), || counted(count, "cell"), count.saturating_mul(8))?;
        let numbers =
            runs.iter().flat_map(|&(block, count)| std::iter::repeat_n(block as f64, count as usize));
        Ok(numbers.collect())
    });
    numbers_of(piece, source, compute)
}

fn numbers_of(piece: &Piece, source: &Arc<Source>, compute: Compute) -> PieceArray {
    let stored = Stored::of_f64(source, BLOCK, 1, piece.cell_count, Encoding::Computed(compute));
    PieceArray::new(Association::Cell, Stored { number_type: NumberType::U32, ..stored })
}

/// A piece with its cells, or with what is known of them.
pub(super) type PieceWith<'a, T> = (NumberedPiece<'a>, T);

/// Leaves out the pieces of a data set of blocks that no picture of volumes can show: those whose cells, by which `has_volume` decides,
/// have no volume, and those without one of the arrays. Gives sentences that name them.
///
/// Errors: none is left.
pub(super) fn drawn_pieces<'a, T>(
    dataset: &Dataset,
    pieces: Vec<PieceWith<'a, T>>,
    has_volume: impl Fn(&T) -> bool,
    choices: &[ArraySelection],
) -> Result<(Vec<PieceWith<'a, T>>, Vec<String>)> {
    if !dataset.has_blocks {
        return Ok((pieces, blocks_without_values(dataset, choices, OMISSION)));
    }
    let (volumes, flat): (Vec<_>, Vec<_>) = pieces.into_iter().partition(|piece| has_volume(&piece.1));
    let flat = flat.iter().map(|((_, piece), _)| name(dataset, piece));
    let mut sentences = Vec::from_iter(left_out("Blocks without cells of three dimensions", flat));
    let mut left = volumes;
    for choice in choices {
        let has_array =
            |((_, piece), _): &PieceWith<T>| piece.array(choice.association, &choice.name).is_some();
        let (with, without): (Vec<_>, Vec<_>) = left.into_iter().partition(has_array);
        let without: Vec<&Piece> = without.into_iter().map(|((_, piece), _)| piece).collect();
        if with.is_empty() {
            return Err(no_block_has(dataset, choice, &without));
        }
        if !without.is_empty() {
            let names = without.iter().map(|piece| name(dataset, piece));
            sentences.push(lacking(&choice.name, names, OMISSION));
        }
        left = with;
    }
    sentences.extend(blocks_without_values(dataset, choices, OMISSION));
    Ok((left, sentences))
}

/// Sentences that name the blocks for whose cells or points a chosen array has no values, where such blocks are kept.
pub(super) fn blocks_to_fill(dataset: &Dataset, choices: &[ArraySelection]) -> Vec<String> {
    let mut sentences = blocks_without_values(dataset, choices, FILLING);
    for choice in choices.iter().filter(|_| dataset.has_blocks) {
        let lacks =
            |piece: &&Piece| piece.cell_count > 0 && piece.array(choice.association, &choice.name).is_none();
        let mut without: Vec<&str> =
            dataset.pieces.iter().filter(lacks).map(|piece| name(dataset, piece)).collect();
        // Pieces of a block follow each other.
        without.dedup();
        if !without.is_empty() {
            sentences.push(lacking(&choice.name, without.into_iter(), FILLING));
        }
    }
    sentences
}

/// A sentence about parts of a file that have no cells to be written: structured grids without thickness, and points alone.
pub(super) fn blocks_without_cells(
    dataset: &Dataset,
    pieces: &[NumberedPiece],
    cells: &[Cells],
) -> Option<String> {
    let flat = pieces.iter().zip(cells).filter(|(_, cells)| cells.count() == 0).map(|(piece, _)| piece.1);
    let points = dataset.pieces.iter().filter(|piece| piece.cell_count == 0 && piece.point_count > 0);
    let parts: Vec<&Piece> = flat.chain(points).collect();
    let names: Vec<&str> =
        parts.iter().map(|piece| name(dataset, piece)).filter(|name| !name.is_empty()).collect();
    (!parts.is_empty()).then(|| {
        let are = agreeing(&parts.len(), "is left out", "are left out");
        let named =
            if names.is_empty() { String::new() } else { format!(": {}", list(names.iter().copied())) };
        let what = "without thickness, or of points alone,";
        format!("{} {what} {are}{named}.", counted(parts.len(), "part"))
    })
}

fn name<'a>(dataset: &'a Dataset, piece: &Piece) -> &'a str {
    let number = match &piece.blocks {
        CellBlocks::One(block) => *block,
        CellBlocks::Runs(runs) => runs.first().map_or(0, |run| run.0),
        CellBlocks::Each { grid, .. } => grid.unwrap_or(0),
    };
    dataset.blocks.get(number).map_or("", String::as_str)
}

/// "Zones are left out: 'a', 'b'."; `None` without names.
pub(super) fn left_out<'a>(what: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let names = list(names);
    (!names.is_empty()).then(|| format!("{what} are left out: {names}."))
}

/// "A block of surfaces is left out: 'a'."; `None` without names.
pub(super) fn blocks_left_out<'a>(what: &str, names: impl IntoIterator<Item = &'a str>) -> Option<String> {
    let names: Vec<&str> = names.into_iter().collect();
    match names.len() {
        1 => Some(format!("A block {what} is left out: {}.", list(names))),
        _ => left_out(&format!("Blocks {what}"), names),
    }
}

/// Consequence for a block without an array, and for several: "is left out".
type Consequence = [&'static str; 2];
const OMISSION: Consequence = ["is left out", "are left out"];
const FILLING: Consequence = ["has nan there", "have nan there"];

fn lacking<'a>(array: &str, blocks: impl Iterator<Item = &'a str>, [of_one, of_many]: Consequence) -> String {
    let blocks: Vec<&str> = blocks.collect();
    let (are, names) =
        (agreeing(&blocks.len(), "A block lacks", "Blocks lack"), list(blocks.iter().copied()));
    format!("{are} the array '{array}' and {}: {names}.", agreeing(&blocks.len(), of_one, of_many))
}

/// Sentences about the blocks within pieces for whose cells a chosen array has no values.
fn blocks_without_values(
    dataset: &Dataset,
    choices: &[ArraySelection],
    consequence: Consequence,
) -> Vec<String> {
    let mut lacks = BTreeMap::<&str, Vec<usize>>::new();
    for choice in choices {
        for piece in &dataset.pieces {
            let own = piece.arrays_of(choice.association).filter(|array| array.stored.name == choice.name);
            own.for_each(|array| lacks.entry(&choice.name).or_default().extend(&array.blocks_without));
        }
    }
    let names = |mut numbers: Vec<usize>| {
        numbers.sort_unstable();
        numbers.dedup();
        numbers.into_iter().filter_map(|number| dataset.blocks.get(number).map(String::as_str))
    };
    lacks
        .into_iter()
        .filter(|(_, blocks)| !blocks.is_empty())
        .map(|(array, blocks)| lacking(array, names(blocks), consequence))
        .collect()
}

fn no_block_has(dataset: &Dataset, choice: &ArraySelection, blocks: &[&Piece]) -> Error {
    let names = blocks.iter().flat_map(|piece| piece.arrays_of(choice.association));
    let names: Vec<&str> =
        names.map(|array| array.stored.name.as_str()).filter(|name| *name != BLOCK).collect();
    let error = Error::run(format!("no block with a volume has the array '{}'", choice.name))
        .got(format_args!("the blocks {}", list(blocks.iter().map(|piece| name(dataset, piece)))));
    if names.is_empty() { error } else { error.expected(format_args!("one of {}", list(names))) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn words_name_blocks_groups_and_patterns() {
        let blocks: Vec<String> =
            ["fluid/rotor", "fluid/stator", "solid", "a*b", "fluid 2"].map(str::to_owned).to_vec();
        let named = |words: &[&str]| {
            let words: Vec<String> = words.iter().map(|word| word.to_string()).collect();
            let is_named = blocks_named(&blocks, &words).unwrap();
            (0..blocks.len()).filter(|&block| is_named[block]).collect::<Vec<_>>()
        };
        assert_eq!(named(&["solid"]), [2]);
        assert_eq!(named(&["fluid"]), [0, 1]);
        assert_eq!(named(&["fluid/*"]), [0, 1]);
        assert_eq!(named(&["*tor", "a*b"]), [0, 1, 3]);
        assert_eq!(named(&["fluid*"]), [0, 1, 4]);
        assert_eq!(named(&["*"]), [0, 1, 2, 3, 4]);
        assert_eq!(named(&["*o*o*"]), [0]);
        let error = blocks_named(&blocks, &["fluid/roter".into()]).unwrap_err().to_string();
        assert!(error.contains("no such block") && error.contains("'fluid/rotor', the nearest"), "{error}");
        let none = blocks_named(&[], &["a".into()]).unwrap_err().to_string();
        assert!(none.contains("have no blocks"), "{none}");
    }
}
