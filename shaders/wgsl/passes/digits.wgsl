// Uses: passes/key, passes/view. Fills: nothing. Asks for: tetrahedra, seen, bounds.
// What the passes of the sort of all cells share: a radix sort, eight bits of the key a round, least first, stable.
//
// A round counts the digits of each block of items (`count_digits`), turns each digit's counts into places
// (`place_digits`) and moves the items there (`move_digits`). The first round takes the cells themselves and leaves out
// those that cannot be seen, so that the list is gathered on the way. Memory follows the number of cells alone.

struct Round {
    // The digit's first bit.
    shift: u32,
    // 1 in the first round, whose items are the cells.
    from_cells: u32,
    // Room for so many items.
    capacity: u32,
    padding: u32,
}

@group(1) @binding(1) var<uniform> sort_round: Round;
// Number of the cell, and its key in bits that sort as numbers do.
@group(1) @binding(2) var<storage, read> unsorted: array<vec2u>;
// For each digit its items in all blocks, then the number of all items, then for each digit one number a block.
@group(1) @binding(3) var<storage, read_write> digit_counts: array<u32>;

// One invocation a digit, so many items one after the other.
const DIGITS = 256u;
const STEPS = 16u;
const ITEMS = DIGITS * STEPS;
const TOTAL = DIGITS;
const FIRST_ROW = DIGITS + 1u;

struct Item {
    // Number of the cell, and its key.
    entry: vec2u,
    is_there: bool,
}

// The farthest first. Of cells as far, the greater number first: seen from the front, cells come as they are numbered.
fn key_bits(cell: u32) -> u32 {
    let bits = bitcast<u32>(sort_key(cell));
    return select(~(bits | 0x80000000u), bits, (bits >> 31u) == 1u);
}

fn item_at(index: u32, count: u32) -> Item {
    if count <= index {
        return Item(vec2u(0u), false);
    }
    if sort_round.from_cells == 0u {
        return Item(unsorted[index], true);
    }
    let cell = count - 1u - index;
    if bounds_of(cell).y == 0u {
        return Item(vec2u(0u), false);
    }
    return Item(vec2u(cell, key_bits(cell)), true);
}

fn item_count() -> u32 {
    return select(min(digit_counts[TOTAL], sort_round.capacity), view.cell_count, sort_round.from_cells == 1u);
}

fn digit_of(item: Item) -> u32 {
    return (item.entry.y >> sort_round.shift) & (DIGITS - 1u);
}

fn block_count() -> u32 {
    return (sort_round.capacity + ITEMS - 1u) / ITEMS;
}

// Where a digit's number of a block stands.
fn row_place(digit: u32, block: u32) -> u32 {
    return FIRST_ROW + digit * block_count() + block;
}

// Number of a workgroup among those of a dispatch that may be folded into rows.
fn flat_block(group: vec3u, groups: vec3u) -> u32 {
    return group.x + group.y * groups.x;
}
