/*
 * simple-cells: a reader of a format of one's own, which is this text:
 *
 *     cells 1                          how a file begins
 *     points 8                         how many points,
 *     cells 2 12                       how many cells, and how many numbers of points they have in all
 *     steps 2 0.0 0.5                  how many steps, and the time of each
 *     arrays 1                         how many arrays, and of each the name, where it sits, the numbers of a tuple
 *     heat points 1
 *     0 0 0  1 0 0 ...                 x, y and z of each point
 *     12 8  0 1 3 2 4 5 7 6            of each cell VTK's type, how many points it has, and which
 *     ...
 *     300 310 ...                      the values of each array, of the first step, of the second, ...
 *
 *     cc -std=c99 -O2 -shared -fPIC -I../../include -o reader.so reader.c
 */
#include "voltet_plugin.h"

#include <inttypes.h>
#include <math.h>
#include <stdio.h>
#include <string.h>

static int32_t fail(const voltet_host *host, const char *text) {
    host->error(host, text);
    return VOLTET_ERROR;
}

#define ARRAYS 16
#define STEPS 1024

typedef struct {
    uint64_t points, cells, connectivity;
    unsigned steps, arrays;
    double times[STEPS];
    char names[ARRAYS][65];
    voltet_array_head heads[ARRAYS];
} header;

/* Reads the header; gives what is wrong with it, or NULL. The host refuses what contradicts itself. */
static const char *read_header(FILE *file, header *h) {
    char where[65];
    if (fscanf(file, "cells 1 points %" SCNu64 " cells %" SCNu64 " %" SCNu64 " steps %u", &h->points, &h->cells, &h->connectivity,
               &h->steps) != 4)
        return "the header is not 'cells 1', points, cells, steps";
    if (h->steps > STEPS) return "there are more than 1024 steps";
    for (unsigned k = 0; k < h->steps; k++)
        if (fscanf(file, "%lf", &h->times[k]) != 1) return "a time is missing";
    if (fscanf(file, " arrays %u", &h->arrays) != 1 || h->arrays > ARRAYS) return "there are no or more than 16 arrays";
    for (unsigned i = 0; i < h->arrays; i++) {
        voltet_array_head *head = &h->heads[i];
        memset(head, 0, sizeof *head);
        head->size = sizeof *head;
        head->name = h->names[i];
        if (fscanf(file, "%64s %64s %u", h->names[i], where, &head->component_count) != 3) return "an array is not described";
        head->on_cells = strcmp(where, "cells") == 0;
    }
    return NULL;
}

/* Opens the file and reads its header; NULL, with the error said, where that fails. */
static FILE *open_file(const voltet_reading *reading, const voltet_host *host, header *h) {
    FILE *file = fopen(reading->path, "r");
    if (!file) {
        fail(host, "the file cannot be opened");
        return NULL;
    }
    const char *wrong = read_header(file, h);
    if (!wrong) return file;
    fail(host, wrong);
    fclose(file);
    return NULL;
}

static int32_t inspect(const voltet_reading *reading, const voltet_host *host) {
    header h;
    FILE *file = open_file(reading, host, &h);
    if (!file) return VOLTET_ERROR;
    fclose(file);
    const voltet_grid_head head = {
        .size = sizeof head,
        .point_count = h.points,
        .cell_count = h.cells,
        .connectivity_count = h.connectivity,
        .array_count = h.arrays,
        .step_count = h.steps,
        .arrays = h.heads,
        .scalar = h.arrays > 0 ? h.names[0] : NULL,
        .times = h.times,
        .format = "simple cells, text",
    };
    return reading->describe(reading, &head);
}

/* `count` numbers, times `factor`; passed over where `to` is NULL. */
static int read_numbers(FILE *file, double *to, uint64_t count, double factor) {
    for (uint64_t i = 0; i < count; i++) {
        double x;
        if (fscanf(file, "%lf", &x) != 1) return 0;
        if (to) to[i] = factor * x;
    }
    return 1;
}

static int32_t read_cells(FILE *file, const voltet_grid_buffers *b, const header *h, const voltet_host *host) {
    uint64_t end = 0;
    if (b->offsets) b->offsets[0] = 0;
    for (uint64_t cell = 0; cell < h->cells; cell++) {
        unsigned type, count;
        if (fscanf(file, "%u %u", &type, &count) != 2) return fail(host, "a cell is missing");
        if (count > h->connectivity - end) return fail(host, "the cells have more points than the header says");
        for (unsigned k = 0; k < count; k++) {
            uint32_t point;
            if (fscanf(file, "%u", &point) != 1) return fail(host, "a cell ends early");
            if (b->connectivity_u32) b->connectivity_u32[end + k] = point;
        }
        end += count;
        if (b->types) b->types[cell] = (uint8_t)type;
        if (b->offsets) b->offsets[cell + 1] = (int64_t)end;
        if (cell % 1024 == 0) {
            host->progress(host, (double)cell / (double)h->cells);
            if (host->cancelled(host)) return VOLTET_CANCELLED;
        }
    }
    return VOLTET_OK;
}

static int32_t read(const voltet_reading *reading, const voltet_host *host) {
    const voltet_grid_buffers *b = reading->buffers;
    header h;
    FILE *file = open_file(reading, host, &h);
    if (!file) return VOLTET_ERROR;
    int32_t code = VOLTET_OK;
    if (h.points != b->point_count || h.cells != b->cell_count || h.connectivity != b->connectivity_count ||
        h.arrays != b->array_count)
        code = fail(host, "the file has changed since it was looked at");
    if (code == VOLTET_OK && !read_numbers(file, b->points, 3 * h.points, reading->values->numbers[0]))
        code = fail(host, "a coordinate is missing");
    if (code == VOLTET_OK) code = read_cells(file, b, &h, host);
    for (uint64_t step = 0; step <= reading->step && code == VOLTET_OK; step++)
        for (unsigned i = 0; i < h.arrays && code == VOLTET_OK; i++) {
            const uint64_t tuples = h.heads[i].on_cells ? h.cells : h.points;
            double *to = step == reading->step ? b->arrays[i] : NULL;
            if (!read_numbers(file, to, tuples * h.heads[i].component_count, 1)) code = fail(host, "a value is missing");
        }
    fclose(file);
    return code;
}

static const voltet_parameter reader_parameters[] = {{
    .size = sizeof(voltet_parameter),
    .type = VOLTET_NUMBER,
    .name = "scale",
    .help = "the factor on positions",
    .flags = VOLTET_EXCLUSIVE_MIN,
    .max = INFINITY,
    .number = 1,
}};
static const char *const extensions[] = {"cells"};

static const voltet_reader reader = {
    .size = sizeof reader,
    .name = "simple-cells",
    .summary = "Reads a text of points, cells and arrays, with time steps.",
    .parameter_count = 1,
    .extension_count = 1,
    .parameters = reader_parameters,
    .inspect = inspect,
    .read = read,
    .extensions = extensions,
    .magic = (const uint8_t *)"cells 1",
    .magic_length = 7,
};

static uint32_t one(void) { return 1; }
static const voltet_reader *reader_at(uint32_t place) { return place == 0 ? &reader : NULL; }
static const voltet_reader_factory readers = {.size = sizeof readers, .reader_count = one, .reader = reader_at};

static const voltet_plugin *init(const char *path, const voltet_host *host) {
    static const voltet_plugin plugin = {.size = sizeof plugin, .name = "simple cells in C", .version = "1.0.0"};
    (void)path;
    (void)host;
    return &plugin;
}

static const void *get_factory(const char *kind) { return strcmp(kind, VOLTET_READERS) == 0 ? &readers : NULL; }

const voltet_entry voltet_plugin_entry = {
    .size = sizeof voltet_plugin_entry,
    .major = VOLTET_PLUGIN_MAJOR,
    .minor = VOLTET_PLUGIN_MINOR,
    .patch = VOLTET_PLUGIN_PATCH,
    .init = init,
    .get_factory = get_factory,
};
