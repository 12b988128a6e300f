/*
 * A reader, a grid filter and an image filter, damaged at random by their parameter `seed`; 0: not at all. What they give is then
 * either as it would be undamaged, or wrong in a way that can be seen: not written, out of range, not finite, beyond the end by a
 * little, or contradictory.
 */
#include "drawn.h"
#include "voltet_plugin.h"

#include <math.h>
#include <stddef.h>
#include <string.h>

/* Whether this call is damaged: not with seed 0. */
static int begin(const voltet_values *values, uint64_t salt) {
    state = (uint64_t)values->integers[0] * 1000003u + salt;
    return values->integers[0] != 0;
}

static uint64_t odd_number(void) {
    static const uint64_t numbers[] = {0, 1, 3, 4, 6, 7, 63, 4096, 4097, UINT32_MAX, UINT64_C(1) << 32, UINT64_C(1) << 62, UINT64_MAX};
    return below(4) ? numbers[below(sizeof numbers / sizeof *numbers)] : draw();
}

static char noise[256];

static const void *odd_address(void) {
    switch (below(4)) {
    case 0: return NULL;
    case 1: return noise + below(sizeof noise);
    case 2: return (const void *)(uintptr_t)draw();
    default: return (const void *)(uintptr_t)(8 * below(4096));
    }
}

static void damage_head(voltet_grid_head *head, voltet_array_head *arrays) {
    for (uint64_t times = 1 + below(2); times > 0; times--) switch (below(15)) {
        case 0: head->size = (uint32_t)odd_number(); break;
        case 1: head->flags = (uint32_t)odd_number(); break;
        case 2: head->point_count = odd_number(); break;
        case 3: head->cell_count = odd_number(); break;
        case 4: head->connectivity_count = odd_number(); break;
        case 5: head->array_count = (uint32_t)odd_number(); break;
        case 6: head->step_count = (uint32_t)odd_number(); break;
        case 7: head->arrays = odd_address(); break;
        case 8: head->scalar = odd_address(); break;
        case 9: head->times = odd_address(); break;
        case 10: head->format = odd_address(); break;
        case 11: arrays[below(2)].size = (uint32_t)odd_number(); break;
        case 12: arrays[below(2)].component_count = (uint32_t)odd_number(); break;
        case 13: arrays[below(2)].name = odd_address(); break;
        default: arrays[below(2)].on_cells = (uint32_t)odd_number(); break;
        }
}

static int32_t finish(int damaged, const voltet_host *host) {
    if (!damaged || below(3)) return VOLTET_OK;
    switch (below(4)) {
    case 0: host->error(host, noise + below(sizeof noise)); break;
    case 1: host->error(host, odd_address()); break;
    case 2: host->fallback(host, odd_address(), draw()); break;
    default: host->progress(host, below(2) ? NAN : 1e300); break;
    }
    return below(2) ? VOLTET_OK : (int32_t)draw();
}

/* `count` numbers of `size` bytes each, fewer or a little more than that where damaged. Within the guard behind every buffer. */
static uint64_t about(uint64_t count, int damaged) {
    if (!damaged || below(3)) return count;
    return below(2) ? count - below(count + 1) : count + 1 + below(16);
}

static const double points[15] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
static const uint32_t cells[8] = {0, 1, 2, 3, 1, 2, 3, 4};
static const double scalar[5] = {0, 1, 2, 3, 4};

static int32_t inspect(const voltet_reading *reading, const voltet_host *host) {
    const int damaged = begin(reading->values, 1) && below(2);
    voltet_array_head arrays[2] = {
        {.size = sizeof(voltet_array_head), .component_count = 1, .name = "s"},
        {.size = sizeof(voltet_array_head), .component_count = 1, .name = "t", .on_cells = 1},
    };
    voltet_grid_head head = {.size = sizeof head, .point_count = 5, .cell_count = 2, .connectivity_count = 8,
                             .array_count = 2, .arrays = arrays};
    if (damaged) damage_head(&head, arrays);
    for (uint64_t times = damaged && below(4) == 0 ? below(3) : 1; times > 0; times--) reading->describe(reading, &head);
    return finish(damaged, host);
}

/* As much as fits: a plug-in that is damaged otherwise still knows how large its buffers are. */
static void put(void *to, const void *from, uint64_t count, uint64_t size, uint64_t room) {
    static char many[16 * 64];
    if (count > room + 16) count = room + 16;
    if (!to || count * size > sizeof many) return;
    memset(many, 1, sizeof many);
    memcpy(many, from, (count < room ? count : room) * size);
    memcpy(to, many, count * size);
}

static int32_t read(const voltet_reading *reading, const voltet_host *host) {
    const voltet_grid_buffers *b = reading->buffers;
    const int damaged = begin(reading->values, 2) && below(2);
    const uint8_t types[2] = {10, 10};
    const int64_t offsets[3] = {0, 4, 8};
    const double t[2] = {0, 1};
    /* Another size than it has: what there is of it. */
    const int same = b->point_count == 5 && b->cell_count == 2 && b->connectivity_count == 8;
    if (!same) return finish(damaged, host);
    put(b->points, points, about(5, damaged), 24, 5);
    put(b->types, types, about(2, damaged), 1, 2);
    put(b->offsets, offsets, about(3, damaged), 8, 3);
    put(b->connectivity_u32, cells, about(8, damaged), 4, 8);
    if (b->array_count > 0) put(b->arrays[0], scalar, about(5, damaged), 8, 5);
    if (b->array_count > 1) put(b->arrays[1], t, about(2, damaged), 8, 2);
    if (damaged && b->points) switch (below(5)) {
        case 0: b->connectivity_u32[below(8)] = 5 + (uint32_t)below(UINT32_MAX - 5); break;
        case 1: b->offsets[below(3)] = (int64_t)odd_number() | 16; break;
        case 2: b->types[below(2)] = (uint8_t)(11 + below(245)); break;
        default: break;
        }
    return finish(damaged, host);
}

static int32_t filter_grid(const voltet_grid_call *call, const voltet_host *host) {
    const int damaged = begin(call->values, 3);
    voltet_array_head arrays[2] = {
        {.size = sizeof(voltet_array_head), .component_count = 1, .name = call->scalar},
        {.size = sizeof(voltet_array_head), .component_count = 3, .name = "v"},
    };
    voltet_grid_head head = {.size = sizeof head, .flags = VOLTET_TETRAHEDRA, .point_count = 5, .cell_count = 2,
                             .array_count = 2, .arrays = arrays};
    voltet_grid_buffers buffers = {.size = sizeof buffers};
    if (damaged && below(2)) damage_head(&head, arrays);
    if (damaged && below(16) == 0) buffers.size = (uint32_t)odd_number();
    const int32_t code = call->begin(call, &head, damaged && below(16) == 0 ? NULL : &buffers);
    if (damaged && below(16) == 0) call->begin(call, &head, &buffers);
    if (code != VOLTET_OK) return below(2) ? code : finish(damaged, host);
    if (buffers.point_count != 5 || buffers.cell_count != 2) return finish(damaged, host);
    const double v[15] = {0};
    put(buffers.points, points, about(5, damaged), 24, 5);
    put(buffers.tetrahedra, cells, about(2, damaged), 16, 2);
    for (uint32_t i = 0; i < buffers.array_count && i < 2; i++) put(buffers.arrays[i], i ? v : scalar, about(i ? 15 : 5, damaged), 8, i ? 15 : 5);
    if (damaged) switch (below(5)) {
        case 0: if (buffers.points) buffers.points[below(15)] = below(2) ? NAN : -INFINITY; break;
        case 1: if (buffers.tetrahedra) buffers.tetrahedra[below(8)] = 5 + (uint32_t)below(UINT32_MAX - 5); break;
        default: break;
        }
    return finish(damaged, host);
}

static int32_t filter_image(const voltet_image_call *call, const voltet_host *host) {
    static const float wrong[] = {NAN, INFINITY, -INFINITY};
    const int damaged = begin(call->values, 4);
    const uint64_t count = 4 * call->width * call->height, filled = about(count, damaged);
    memcpy(call->filtered, call->rgba, 4 * (filled < count ? filled : count));
    for (uint64_t i = count; i < filled; i++) call->filtered[i] = 1;
    for (uint64_t times = damaged ? below(3) : 0; times > 0; times--) call->filtered[below(count)] = wrong[below(3)];
    if (damaged && below(4) == 0) call->filtered[4 * below(count / 4) + 3] = 2;
    return finish(damaged, host);
}

static const voltet_parameter parameters[] = {{.size = sizeof(voltet_parameter), .type = VOLTET_INTEGER, .name = "seed", .help = "of the damage"}};

static const voltet_plugin *init(const char *path, const voltet_host *host) {
    static const voltet_plugin plugin = {.size = sizeof plugin, .name = "random nodes", .version = "1"};
    (void)path, (void)host;
    for (size_t i = 0; i < sizeof noise; i++) noise[i] = (char)draw();
    return &plugin;
}

#define WORD "random"
#define SUMMARY "Damaged."
#include "nodes.h"
