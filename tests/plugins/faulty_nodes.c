/*
 * A reader, a grid filter and an image filter that do wrong what their parameter `fault` names; "none": nothing. The reader gives
 * two tetrahedra whatever is in the file; the grid filter gives its input's grid with all positions and values anew.
 */
#include "voltet_plugin.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define IS(text) (strcmp(fault, text) == 0)
#define FAULT(values) const char *fault = (values)->texts[0]

static int32_t finish(const char *fault, const voltet_host *host) {
    if (IS("error")) {
        host->error(host, "line 7 is torn");
        return VOLTET_ERROR;
    }
    if (IS("mute")) return 77;
    if (IS("stopped")) return VOLTET_CANCELLED;
    if (IS("notes")) host->fallback(host, "rounded to what the file holds", 3);
    if (IS("crash")) abort();
    if (IS("exit")) exit(3);
    if (IS("quiet exit")) _Exit(0);
    if (IS("prints")) puts("a plug-in prints"), fflush(stdout);
    while (IS("endless")) {
    }
    return VOLTET_OK;
}

static int32_t inspect(const voltet_reading *reading, const voltet_host *host) {
    FAULT(reading->values);
    voltet_array_head arrays[2] = {
        {.size = sizeof(voltet_array_head), .component_count = 1, .name = "s"},
        {.size = sizeof(voltet_array_head), .component_count = 1, .name = "t", .on_cells = 1},
    };
    double times[2] = {0, 1};
    voltet_grid_head head = {.size = sizeof head, .point_count = 5, .cell_count = 2, .connectivity_count = 8,
                             .array_count = 2, .arrays = arrays};
    if (IS("huge")) head.point_count = UINT64_C(1) << 40;
    if (IS("much")) head.point_count = UINT32_MAX;
    if (IS("many")) head.array_count = 1u << 30;
    if (IS("twins")) arrays[1].name = "s", arrays[1].on_cells = 0;
    if (IS("nowhere")) arrays[1].on_cells = 7;
    if (IS("empty")) arrays[0].component_count = 0;
    if (IS("nameless")) arrays[0].name = NULL;
    if (IS("unknown")) head.scalar = "u";
    if (IS("flags")) head.flags = 64;
    if (IS("shared")) head.flags = VOLTET_SAME_POINTS, head.point_count = 0;
    if (IS("small")) head.size = 8;
    if (IS("wild")) head.arrays = (const voltet_array_head *)(uintptr_t)0x1234560;
    if (IS("backwards") || IS("not a time")) head.step_count = 2, head.times = times, times[0] = IS("backwards") ? 2 : NAN;
    if (IS("steps")) head.step_count = 2;
    if (IS("path")) ((char *)reading->path)[0] = 'A';
    if (IS("silent")) return VOLTET_OK;
    if (IS("inspect")) return finish("error", host);
    int32_t code = reading->describe(reading, &head);
    if (IS("twice")) code = reading->describe(reading, &head);
    return IS("ignored") ? VOLTET_OK : code;
}

static int32_t read(const voltet_reading *reading, const voltet_host *host) {
    FAULT(reading->values);
    const voltet_grid_buffers *b = reading->buffers;
    static const double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
    static const uint32_t cells[] = {0, 1, 2, 3, 1, 2, 3, 4};
    if (b->points) {
        memcpy(b->points, points, sizeof points);
        memcpy(b->connectivity_u32, cells, sizeof cells);
        for (int i = 0; i < 2; i++) b->types[i] = 10, b->offsets[i + 1] = 4 * (i + 1);
        b->offsets[0] = 0;
        if (IS("first")) b->offsets[0] = 1;
        if (IS("order")) b->offsets[1] = 9;
        if (IS("last")) b->offsets[2] = 7;
        if (IS("far")) b->connectivity_u32[6] = 5;
        if (IS("polyhedron")) b->types[1] = 42;
        if (IS("type")) b->types[1] = 200;
        if (IS("hexahedron")) b->types[1] = 12;
        if (IS("not finite")) b->points[0] = NAN;
        if (IS("beyond points")) b->points[15] = 1;
        if (IS("beyond types")) b->types[2] = 10;
        if (IS("beyond offsets")) b->offsets[3] = 8;
        if (IS("beyond cells")) b->connectivity_u32[8] = 1;
    }
    for (int i = 0; b->arrays[0] && i < 5 - IS("few"); i++) b->arrays[0][i] = i;
    if (b->arrays[0] && IS("beyond array")) b->arrays[0][5] = 1;
    if (b->arrays[0] && IS("value")) b->arrays[0][4] = INFINITY;
    for (int i = 0; b->arrays[1] && i < 2; i++) b->arrays[1][i] = i;
    return finish(fault, host);
}

static int32_t filter_grid(const voltet_grid_call *call, const voltet_host *host) {
    FAULT(call->values);
    voltet_array_head arrays[2] = {
        {.size = sizeof(voltet_array_head), .component_count = 1, .name = call->scalar},
        {.size = sizeof(voltet_array_head), .component_count = 3, .name = "v"},
    };
    voltet_grid_head head = {.size = sizeof head, .flags = VOLTET_TETRAHEDRA, .point_count = call->point_count,
                             .cell_count = call->cell_count, .array_count = 2, .arrays = arrays};
    voltet_grid_buffers buffers = {.size = sizeof buffers};
    if (IS("input points")) ((double *)call->points)[0] = 7;
    if (IS("input cells")) ((uint32_t *)call->tetrahedra)[7] = 0;
    if (IS("input arrays")) ((double *)call->carried[0].values)[4] = -1;
    if (IS("input names")) ((char *)call->scalar)[0] = 'z';
    if (IS("silent")) return VOLTET_OK;
    if (IS("counts")) head.flags |= VOLTET_SAME_CELLS;
    if (IS("points")) head.flags |= VOLTET_SAME_POINTS;
    if (IS("fewer")) head.flags = VOLTET_SAME_CELLS, head.cell_count = 0, head.point_count -= 1;
    if (IS("other")) arrays[0].name = "other";
    if (IS("vector")) head.scalar = "v";
    if (IS("nothing")) head.cell_count = 0;
    /* Nothing wrong: the grid as it is, with another scalar. */
    if (IS("kept")) {
        arrays[0].name = head.scalar = "w";
        head.flags = VOLTET_SAME_POINTS | VOLTET_SAME_CELLS, head.point_count = head.cell_count = 0;
    }
    if (IS("much")) head.cell_count = UINT32_MAX, arrays[1].on_cells = 1, arrays[1].component_count = 1024;
    int32_t code = call->begin(call, &head, IS("null") ? NULL : &buffers);
    if (IS("twice")) code = call->begin(call, &head, &buffers);
    if (code != VOLTET_OK) return code;
    if (buffers.points) memcpy(buffers.points, call->points, 24 * call->point_count);
    if (buffers.tetrahedra) memcpy(buffers.tetrahedra, call->tetrahedra, 16 * head.cell_count);
    memcpy(buffers.arrays[0], call->carried[0].values, 8 * call->point_count);
    memset(buffers.arrays[1], 0, 24 * call->point_count);
    if (IS("not finite")) buffers.points[3] = INFINITY;
    if (IS("far")) buffers.tetrahedra[5] = (uint32_t)call->point_count;
    if (IS("few")) buffers.tetrahedra[3] = UINT32_MAX;
    if (IS("beyond")) buffers.tetrahedra[4 * head.cell_count] = 0;
    return finish(fault, host);
}

static int32_t filter_image(const voltet_image_call *call, const voltet_host *host) {
    FAULT(call->values);
    const uint64_t count = call->width * call->height;
    memcpy(call->filtered, call->rgba, 16 * (count - 3 * (uint64_t)IS("few")));
    if (IS("not finite")) call->filtered[9] = NAN;
    if (IS("input")) ((float *)call->rgba)[4 * count - 1] = 2;
    if (IS("opaque")) call->filtered[7] = 1.5f;
    if (IS("beyond")) call->filtered[4 * count + 2] = 0;
    return finish(fault, host);
}

static const voltet_parameter parameters[] = {
    {.size = sizeof(voltet_parameter), .type = VOLTET_TEXT, .name = "fault", .help = "what it does wrong", .text = "none"},
};

static const voltet_plugin *init(const char *path, const voltet_host *host) {
    static const voltet_plugin plugin = {.size = sizeof plugin, .name = "faulty nodes", .version = "1"};
    (void)path, (void)host;
    return &plugin;
}

#define WORD "faulty"
#define SUMMARY "Does something wrong."
#include "nodes.h"
