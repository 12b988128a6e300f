// Uses: compositor/tiles. Fills: chunk_corners.
// The values at the corners of a chunk's cells, read once for all pixels of a tile.

var<workgroup> chunk_corners: array<array<vec4f, CHUNK>, VALUE_COUNT>;

fn load_corners(place: u32, cell: u32) {
    var corners = corners_of_values(tetrahedron(cell));
    for (var i = 0u; i < VALUE_COUNT; i++) {
        chunk_corners[i][place] = corners[i];
    }
}

fn corners_in_chunk(place: u32, cell: u32) -> Corners {
    var corners = Corners();
    for (var i = 0u; i < VALUE_COUNT; i++) {
        corners[i] = chunk_corners[i][place];
    }
    return corners;
}
