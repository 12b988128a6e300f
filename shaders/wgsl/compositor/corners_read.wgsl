// Uses: compositor/tiles. Fills: chunk_corners.
// The values at the corners of a chunk's cells where there are more of them than a workgroup's memory holds: each pixel
// reads them from the cell.

fn load_corners(place: u32, cell: u32) {}

fn corners_in_chunk(place: u32, cell: u32) -> Corners {
    return corners_of_values(tetrahedron(cell));
}
