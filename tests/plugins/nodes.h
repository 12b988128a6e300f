/*
 * A plug-in of one reader, one grid filter and one image filter, as the file that ends with this line defines their functions, its
 * one parameter, `init`, and the words WORD, which begins all names, and SUMMARY.
 */
static const char *const extensions[] = {WORD};

#define COMMON .summary = SUMMARY, .parameter_count = 1, .parameters = parameters
static const voltet_reader reader = {.size = sizeof reader, .name = WORD "-reader", COMMON, .inspect = inspect, .read = read,
                                     .extensions = extensions, .extension_count = 1};
static const voltet_grid_filter grid = {.size = sizeof grid, .name = WORD "-grid", COMMON, .filter = filter_grid};
static const voltet_image_filter image = {.size = sizeof image, .name = WORD "-image", COMMON, .filter = filter_image};

static uint32_t one(void) { return 1; }
static const voltet_reader *reader_at(uint32_t place) { return place ? NULL : &reader; }
static const voltet_grid_filter *grid_at(uint32_t place) { return place ? NULL : &grid; }
static const voltet_image_filter *image_at(uint32_t place) { return place ? NULL : &image; }
static const voltet_reader_factory readers = {.size = sizeof readers, .reader_count = one, .reader = reader_at};
static const voltet_grid_factory grids = {.size = sizeof grids, .filter_count = one, .filter = grid_at};
static const voltet_image_factory images = {.size = sizeof images, .filter_count = one, .filter = image_at};

static const void *get_factory(const char *kind) {
    if (strcmp(kind, VOLTET_READERS) == 0) return &readers;
    if (strcmp(kind, VOLTET_GRID_FILTERS) == 0) return &grids;
    return strcmp(kind, VOLTET_IMAGE_FILTERS) == 0 ? &images : NULL;
}

const voltet_entry voltet_plugin_entry = {.size = sizeof voltet_plugin_entry, .major = VOLTET_PLUGIN_MAJOR,
                                          .minor = VOLTET_PLUGIN_MINOR, .init = init, .get_factory = get_factory};
