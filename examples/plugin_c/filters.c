/*
 * Two grid filters, c-threshold and c-warp, and an image filter, c-tone, in one library.
 *
 *     cc -std=c99 -O2 -shared -fPIC -I../../include -o filters.so filters.c -lm
 */
#include "voltet_plugin.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* ---- A grid filter that leaves cells out: c-threshold ------------------------------------------------------------------------ */

static int is_kept(const voltet_grid_call *call, uint64_t cell) {
    const double *scalar = call->carried[0].values;
    for (int k = 0; k < 4; k++) {
        const double s = scalar[call->tetrahedra[4 * cell + k]];
        if (!(s >= call->values->numbers[0] && s <= call->values->numbers[1])) return 0;
    }
    return 1;
}

static int32_t threshold(const voltet_grid_call *call, const voltet_host *host) {
    if (!call->scalar) {
        host->error(host, "the grid carries no scalar");
        return VOLTET_ERROR;
    }
    uint64_t kept = 0;
    for (uint64_t cell = 0; cell < call->cell_count; cell++) kept += (uint64_t)is_kept(call, cell);
    const voltet_grid_head head = {.size = sizeof head, .flags = VOLTET_TETRAHEDRA | VOLTET_SAME_POINTS, .cell_count = kept};
    voltet_grid_buffers buffers = {.size = sizeof buffers};
    const int32_t code = call->begin(call, &head, &buffers);
    if (code != VOLTET_OK) return code;
    uint32_t *to = buffers.tetrahedra;
    for (uint64_t cell = 0; cell < call->cell_count; cell++)
        if (is_kept(call, cell)) {
            memcpy(to, call->tetrahedra + 4 * cell, 4 * sizeof *to);
            to += 4;
        }
    return VOLTET_OK;
}

static const voltet_parameter threshold_parameters[] = {
    {.size = sizeof(voltet_parameter), .type = VOLTET_NUMBER, .name = "least", .unit = "units of s",
     .help = "cells with a smaller value are left out", .number = 0},
    {.size = sizeof(voltet_parameter), .type = VOLTET_NUMBER, .name = "most", .unit = "units of s",
     .help = "cells with a greater value are left out", .number = 1},
};

/* ---- A grid filter that moves points and adds an array: c-warp ----------------------------------------------------------------- */

static int32_t warp(const voltet_grid_call *call, const voltet_host *host) {
    const double *by = call->arrays[0], factor = call->values->numbers[1];
    const voltet_array_head length = {.size = sizeof length, .component_count = 1, .name = "way"};
    const voltet_array_head scalar = {.size = sizeof scalar, .component_count = 1, .name = call->scalar};
    const voltet_array_head heads[] = {length, scalar};
    const voltet_grid_head head = {
        .size = sizeof head,
        .flags = VOLTET_SAME_CELLS,
        .point_count = call->point_count,
        .array_count = call->scalar ? 2 : 1,
        .arrays = heads,
    };
    voltet_grid_buffers buffers = {.size = sizeof buffers};
    const int32_t code = call->begin(call, &head, &buffers);
    if (code != VOLTET_OK) return code;
    for (uint64_t p = 0; p < call->point_count; p++) {
        const double *d = by + 3 * p;
        for (int k = 0; k < 3; k++) buffers.points[3 * p + k] = call->points[3 * p + k] + factor * d[k];
        buffers.arrays[0][p] = fabs(factor) * sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
    }
    if (call->scalar) memcpy(buffers.arrays[1], call->carried[0].values, call->point_count * sizeof(double));
    (void)host;
    return VOLTET_OK;
}

static const voltet_parameter warp_parameters[] = {
    {.size = sizeof(voltet_parameter), .type = VOLTET_POINT_ARRAY, .name = "by", .help = "the array of vectors by which points move",
     .flags = VOLTET_REQUIRED, .length = 3},
    {.size = sizeof(voltet_parameter), .type = VOLTET_NUMBER, .name = "factor", .help = "the factor on them", .number = 1},
};
static const char *const made[] = {"way"};

static const voltet_grid_filter grid_filters[] = {
    {
        .size = sizeof(voltet_grid_filter),
        .name = "c-threshold",
        .summary = "Leaves out cells with a value outside of a range.",
        .parameter_count = 2,
        .parameters = threshold_parameters,
        .filter = threshold,
    },
    {
        .size = sizeof(voltet_grid_filter),
        .name = "c-warp",
        .summary = "Moves points by vectors; the array way says how far.",
        .parameter_count = 2,
        .made_count = 1,
        .parameters = warp_parameters,
        .filter = warp,
        .made = made,
    },
};

/* ---- The image filter: c-tone ------------------------------------------------------------------------------------------------ */

/* Rows from `first` to `end` - 1. */
static void tone_rows(void *user, uint64_t first, uint64_t end, uint32_t thread) {
    const voltet_image_call *call = user;
    const double power = call->values->numbers[0];
    (void)thread;
    for (uint64_t i = first * call->width; i < end * call->width; i++) {
        const float *from = call->rgba + 4 * i;
        float *to = call->filtered + 4 * i;
        const double opacity = from[3];
        for (int k = 0; k < 3; k++) to[k] = opacity > 0 ? (float)(opacity * pow(fmax(from[k] / opacity, 0), power)) : 0;
        to[3] = from[3];
    }
}

static int32_t tone(const voltet_image_call *call, const voltet_host *host) {
    return host->parallel_for(host, call->height, 0, tone_rows, (void *)(uintptr_t)call);
}

static const voltet_parameter tone_parameters[] = {{
    .size = sizeof(voltet_parameter),
    .type = VOLTET_NUMBER,
    .name = "power",
    .help = "each colour becomes its power by this; 1 leaves the picture",
    .min = 0.1,
    .max = 10,
    .number = 1,
}};

static const voltet_image_filter image_filter = {
    .size = sizeof image_filter,
    .name = "c-tone",
    .summary = "Brightens or darkens by a power, and leaves opacity.",
    .parameter_count = 1,
    .parameters = tone_parameters,
    .filter = tone,
};

/* ---- The library ------------------------------------------------------------------------------------------------------------- */

static uint32_t one(void) { return 1; }
static uint32_t two(void) { return 2; }
static const voltet_grid_filter *grid_filter_at(uint32_t place) { return place < 2 ? &grid_filters[place] : NULL; }
static const voltet_image_filter *image_filter_at(uint32_t place) { return place == 0 ? &image_filter : NULL; }

static const voltet_grid_factory grids = {.size = sizeof grids, .filter_count = two, .filter = grid_filter_at};
static const voltet_image_factory images = {.size = sizeof images, .filter_count = one, .filter = image_filter_at};

static const voltet_plugin *init(const char *path, const voltet_host *host) {
    static const voltet_plugin plugin = {.size = sizeof plugin, .name = "filters in C", .version = "1.0.0"};
    (void)path;
    (void)host;
    return &plugin;
}

static const void *get_factory(const char *kind) {
    if (strcmp(kind, VOLTET_GRID_FILTERS) == 0) return &grids;
    if (strcmp(kind, VOLTET_IMAGE_FILTERS) == 0) return &images;
    return NULL;
}

const voltet_entry voltet_plugin_entry = {
    .size = sizeof voltet_plugin_entry,
    .major = VOLTET_PLUGIN_MAJOR,
    .minor = VOLTET_PLUGIN_MINOR,
    .patch = VOLTET_PLUGIN_PATCH,
    .init = init,
    .get_factory = get_factory,
};
