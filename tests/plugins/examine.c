/*
 * A filter that examines what it is given, and says what is not as the header promises. Its parameters are of every type; the
 * test sets them to what is written here. The grid's scalar is x, and its array "y" is y, "gradient" (1, 0, 0).
 */
#include "voltet_plugin.h"

#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const double standard[] = {1, 2, 3};
static const char *const words[] = {"first", "second", "third"};
static const char *const meanings[] = {"the first", "the second", "the third"};

static const voltet_parameter parameters[] = {
    {.size = sizeof(voltet_parameter), .type = VOLTET_BOOLEAN, .name = "flag", .help = "a flag"},
    {.size = sizeof(voltet_parameter), .type = VOLTET_INTEGER, .name = "whole", .unit = "m", .help = "a number", .flags = VOLTET_REQUIRED},
    {.size = sizeof(voltet_parameter),
     .type = VOLTET_NUMBER,
     .name = "number",
     .help = "a number",
     .flags = VOLTET_EXCLUSIVE_MIN | VOLTET_EXCLUSIVE_MAX,
     .min = 0,
     .max = 10,
     .number = 5},
    {.size = sizeof(voltet_parameter),
     .type = VOLTET_CHOICE,
     .name = "choice",
     .help = "a word",
     .text = "first",
     .word_count = 3,
     .words = words,
     .meanings = meanings},
    {.size = sizeof(voltet_parameter), .type = VOLTET_TEXT, .name = "text", .help = "a text", .text = "standard"},
    {.size = sizeof(voltet_parameter), .type = VOLTET_TEXT, .name = "nothing", .help = "a text", .unset = "none"},
    {.size = sizeof(voltet_parameter), .type = VOLTET_VECTOR, .name = "vector", .help = "three", .length = 3, .numbers = standard},
    {.size = sizeof(voltet_parameter), .type = VOLTET_VECTOR, .name = "list", .help = "any", .unset = "none", .min = -1, .max = INFINITY},
    {.size = sizeof(voltet_parameter), .type = VOLTET_POINT_ARRAY, .name = "one", .help = "an array", .length = 1, .unset = "none"},
    {.size = sizeof(voltet_parameter), .type = VOLTET_POINT_ARRAY, .name = "three", .help = "an array", .length = 3, .flags = VOLTET_REQUIRED},
    {.size = sizeof(voltet_parameter), .type = VOLTET_POINT_ARRAY, .name = "none", .help = "an array", .length = 1, .unset = "none"},
};

static char said[200];

/* Says where it is not so, and leaves the function. */
#define IS(what)                                                                                                              \
    do {                                                                                                                      \
        if (!(what)) {                                                                                                        \
            snprintf(said, sizeof said, "line %d: not %s", __LINE__, #what);                                                  \
            host->error(host, said);                                                                                          \
            return VOLTET_ERROR;                                                                                              \
        }                                                                                                                     \
    } while (0)

static int32_t values_are(const voltet_values *v, const voltet_host *host) {
    IS(v->size >= sizeof *v && v->count == 11);
    IS(v->integers[0] == 1 && v->integers[1] == -9007199254740993 && v->numbers[2] == 0.5 && v->integers[3] == 2);
    IS(v->numbers[1] == -9007199254740992.0);
    IS(!strcmp(v->texts[3], "third") && !strcmp(v->texts[4], "\xc3\xa9t\xc3\xa9") && !v->texts[5] && !v->texts[0]);
    IS(v->lengths[6] == 3 && v->vectors[6][0] == 1 && v->vectors[6][2] == 3);
    IS(v->lengths[7] == 2 && v->vectors[7][0] == -1 && v->vectors[7][1] == 1e300 && !v->vectors[0] && v->lengths[0] == 0);
    IS(!strcmp(v->texts[8], "y") && !strcmp(v->texts[9], "gradient") && !v->texts[10]);
    return VOLTET_OK;
}

static int32_t check(const voltet_values *v, const voltet_host *host) {
    return v->integers[0] ? values_are(v, host) : VOLTET_OK;
}

static int has(const uint32_t *items, uint64_t first, uint64_t end, uint32_t item) {
    while (first < end)
        if (items[first++] == item) return 1;
    return 0;
}

typedef struct {
    uint32_t *seen;
    uint32_t *by;
} counts;

static void count(void *user, uint64_t first, uint64_t end, uint32_t thread) {
    counts *c = user;
    for (uint64_t i = first; i < end; i++) c->seen[i]++;
    c->by[thread]++;
}

static int32_t gradient(const voltet_call *c, const voltet_host *host) {
    const int32_t code = values_are(c->values, host);
    if (code != VOLTET_OK) return code;
    IS(host->size >= sizeof *host && host->major == VOLTET_PLUGIN_MAJOR && host->thread_count > 0 && !strncmp(host->program, "voltet ", 7));
    IS(c->size >= sizeof *c && c->point_count == 64 && c->cell_count >= 5 * 27);
    IS(c->neighbour_starts[0] == 0 && c->cell_starts[0] == 0 && c->cell_starts[64] == 4 * c->cell_count);
    for (uint64_t i = 0; i < c->cell_count; i++) {
        const uint32_t *t = c->cells + 4 * i;
        IS(t[0] < t[1] && t[1] < t[2] && t[2] < t[3] && t[3] < 64);
        for (int a = 0; a < 4; a++) {
            IS(has(c->cells_of_points, c->cell_starts[t[a]], c->cell_starts[t[a] + 1], (uint32_t)i));
            for (int b = 0; b < 4; b++)
                IS((a != b) == has(c->neighbours, c->neighbour_starts[t[a]], c->neighbour_starts[t[a] + 1], t[b]));
        }
    }
    uint64_t edges = 0;
    for (uint64_t p = 0; p < 64; p++) {
        IS(c->scalar[p] == c->points[3 * p] && c->arrays[8][p] == c->points[3 * p + 1]);
        IS(c->arrays[9][3 * p] == 1 && c->arrays[9][3 * p + 2] == 0);
        for (uint64_t k = c->neighbour_starts[p]; k < c->neighbour_starts[p + 1]; k++, edges++) {
            IS(!has(c->neighbours, c->neighbour_starts[p], k, c->neighbours[k]));
            const uint32_t q = c->neighbours[k];
            IS(has(c->neighbours, c->neighbour_starts[q], c->neighbour_starts[q + 1], (uint32_t)p));
        }
        int outside = 0;
        for (int axis = 0; axis < 3; axis++) outside |= c->points[3 * p + axis] == 0 || c->points[3 * p + axis] == 1;
        IS(c->at_boundary[p] == outside);
        /* The neighbours, then theirs, each once. */
        const uint64_t ring = c->second_ring_starts[p], end = c->second_ring_starts[p + 1];
        const uint64_t degree = c->neighbour_starts[p + 1] - c->neighbour_starts[p];
        IS(end - ring > degree && !has(c->second_rings, ring, end, (uint32_t)p));
        for (uint64_t k = ring; k < end; k++) {
            const uint32_t q = c->second_rings[k];
            IS(!has(c->second_rings, ring, k, q));
            const int is_neighbour = has(c->neighbours, c->neighbour_starts[p], c->neighbour_starts[p + 1], q);
            IS(is_neighbour == (k < ring + degree));
            int near = 0;
            for (uint64_t i = c->neighbour_starts[p]; i < c->neighbour_starts[p + 1]; i++)
                near |= has(c->neighbours, c->neighbour_starts[c->neighbours[i]], c->neighbour_starts[c->neighbours[i] + 1], q);
            IS(near);
        }
        for (uint64_t i = c->neighbour_starts[p]; i < c->neighbour_starts[p + 1]; i++)
            for (uint64_t k = c->neighbour_starts[c->neighbours[i]]; k < c->neighbour_starts[c->neighbours[i] + 1]; k++)
                IS(c->neighbours[k] == p || has(c->second_rings, ring, end, c->neighbours[k]));
    }
    IS(edges == c->neighbour_starts[64] && !c->arrays[0] && !c->arrays[10]);
    /* Every number once, whatever the parts; those of a number beyond what memory holds are not run in one. */
    uint32_t seen[1000] = {0}, by[4096] = {0};
    counts both = {seen, by};
    const uint64_t chunks[] = {0, 1, 7, 1000, 100000, UINT64_MAX};
    IS(host->thread_count <= 4096);
    for (int i = 0; i < 6; i++) IS(host->parallel_for(host, 1000, chunks[i], count, &both) == VOLTET_OK);
    for (int i = 0; i < 1000; i++) IS(seen[i] == 6);
    for (uint32_t i = host->thread_count; i < 4096; i++) IS(by[i] == 0);
    IS(host->parallel_for(host, 0, 0, count, &both) == VOLTET_OK && !host->cancelled(host));
    for (uint64_t p = 0; p < 64; p++) memcpy(c->gradient + 3 * p, c->arrays[9] + 3 * p, 3 * sizeof(double));
    host->fallback(host, "two and three", 2);
    host->fallback(host, "two and three", 3);
    host->fallback(host, "never", 0);
    return VOLTET_OK;
}

static const voltet_gradient_filter examine = {
    .size = sizeof(voltet_gradient_filter),
    .needs = VOLTET_NEEDS_NEIGHBOURS | VOLTET_NEEDS_CELLS_OF_POINTS | VOLTET_NEEDS_BOUNDARY | VOLTET_NEEDS_SECOND_RINGS,
    .name = "examine",
    .summary = "Examines what it is given.",
    .parameter_count = 11,
    .parameters = parameters,
    .check = check,
    .gradient = gradient,
};

/* As if the header had grown since: the host reads what it knows. */
static const struct {
    voltet_plugin plugin;
    const char *later[2];
} plugin = {{.size = sizeof plugin, .name = "examine", .version = "\xc3\xa9"}, {"a", "b"}};

static uint32_t filter_count(void) { return 1; }
static const voltet_gradient_filter *filter(uint32_t place) { return place == 0 ? &examine : NULL; }
static const voltet_gradient_factory factory = {
    .size = sizeof(voltet_gradient_factory), .filter_count = filter_count, .filter = filter};

/* Says in a file beside the library what it was called with, and when it ends. */
static char log_path[4096];

static void note(const char *what) {
    FILE *log = fopen(log_path, "a");
    if (log) fprintf(log, "%s\n", what), fclose(log);
}

static const voltet_plugin *init(const char *path, const voltet_host *host) {
    (void)host;
    snprintf(log_path, sizeof log_path, "%.4000s.log", path);
    note("init");
    return &plugin.plugin;
}

static void deinit(void) { note("deinit"); }

static const void *get_factory(const char *kind) {
    return strcmp(kind, VOLTET_GRADIENT_FILTERS) == 0 ? &factory : NULL;
}

const voltet_entry voltet_plugin_entry = {sizeof(voltet_entry), VOLTET_PLUGIN_MAJOR, 7, 0, init, deinit, get_factory};
