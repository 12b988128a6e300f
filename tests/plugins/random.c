/*
 * A plug-in whose filter gives the gradient of 2 x + 3 y - z, damaged at random in what it declares, says and gives. The digits of
 * its file's name are the seed; one whose name begins with "wild" damages addresses of functions, too. What it gives is either
 * right, or wrong in a way that can be seen: not finite, or not written.
 */
#include "drawn.h"
#include "voltet_plugin.h"

#include <dlfcn.h>
#include <math.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

static int wild;

static uint64_t code, points_damaged, kind_of_damage, says, loops;

static void body(void *user, uint64_t first, uint64_t end, uint32_t thread) {
    static const double right[3] = {2, 3, -1};
    (void)thread;
    for (uint64_t p = first; p < end; p++) memcpy((double *)user + 3 * p, right, sizeof right);
}

static char noise[8192];

static int32_t gradient(const voltet_call *call, const voltet_host *host) {
    uint64_t count = call->point_count;
    if (kind_of_damage == 1) count -= count < points_damaged ? count : points_damaged;
    if (loops == 1) host->parallel_for(host, 0, 7, body, call->gradient);
    host->parallel_for(host, count, loops == 2 ? UINT64_MAX : loops, body, call->gradient);
    for (uint64_t i = 0; kind_of_damage > 1 && i < points_damaged; i++) {
        double values[] = {NAN, INFINITY, -INFINITY};
        call->gradient[below(3 * call->point_count)] = values[below(3)];
    }
    if (says == 1) host->error(host, noise + below(sizeof noise));
    if (says == 2) host->fallback(host, noise + below(sizeof noise), draw());
    if (says == 3) host->fallback(host, NULL, draw()), host->error(host, NULL), host->progress(host, NAN);
    if (says == 4) host->error(host, (const char *)(uintptr_t)draw());
    return (int32_t)code;
}

static const char *words[] = {"none", "other"};
static const char *meanings[] = {"nothing", "something else"};
static const double vector[] = {1, 2, 3};

static voltet_parameter parameters[] = {
    {.size = sizeof(voltet_parameter), .type = VOLTET_NUMBER, .name = "number", .help = "a number", .max = 1, .number = 0.5},
    {.size = sizeof(voltet_parameter), .type = VOLTET_BOOLEAN, .name = "flag", .help = "a flag", .number = 1},
    {.size = sizeof(voltet_parameter), .type = VOLTET_INTEGER, .name = "whole", .unit = "m", .help = "a whole number", .number = 4},
    {.size = sizeof(voltet_parameter),
     .type = VOLTET_CHOICE,
     .name = "word",
     .help = "a word",
     .text = "none",
     .word_count = 2,
     .words = words,
     .meanings = meanings},
    {.size = sizeof(voltet_parameter), .type = VOLTET_TEXT, .name = "text", .help = "a text", .text = "abc"},
    {.size = sizeof(voltet_parameter), .type = VOLTET_VECTOR, .name = "vector", .help = "a vector", .length = 3, .numbers = vector},
    {.size = sizeof(voltet_parameter),
     .type = VOLTET_POINT_ARRAY,
     .name = "trust",
     .help = "an array",
     .length = 1,
     .unset = "every point alike"},
};

static voltet_gradient_filter filters[] = {{.size = sizeof(voltet_gradient_filter),
                                            .needs = VOLTET_NEEDS_NEIGHBOURS,
                                            .name = "random",
                                            .summary = "Gives the gradient of 2 x + 3 y - z.",
                                            .parameter_count = 7,
                                            .parameters = parameters,
                                            .gradient = gradient}};

static uint64_t counted = 1;
static const void *given;

static uint32_t filter_count(void) { return (uint32_t)counted; }

static const voltet_gradient_filter *filter(uint32_t place) {
    return given ? given : place < 2 ? &filters[0] : NULL;
}

static voltet_gradient_factory factory = {
    .size = sizeof(voltet_gradient_factory), .filter_count = filter_count, .filter = filter};
static voltet_plugin plugin = {.size = sizeof(voltet_plugin), .name = "random", .version = "0.1"};
static const void *factory_given = &factory;
static const voltet_plugin *plugin_given = &plugin;

static const voltet_plugin *init(const char *path, const voltet_host *host) {
    (void)path;
    if (says == 5) host->error(host, noise);
    return plugin_given;
}

static const void *get_factory(const char *kind) { return kind[0] == 'v' ? factory_given : NULL; }

extern voltet_entry entry;
voltet_entry entry __asm__("voltet_plugin_entry") = {
    sizeof(voltet_entry), VOLTET_PLUGIN_MAJOR, VOLTET_PLUGIN_MINOR, VOLTET_PLUGIN_PATCH, init, NULL, get_factory};

/* An address of anything: null, nowhere, the end of what there is, noise. */
static const void *anywhere(void) {
    switch (below(6)) {
    case 0: return NULL;
    case 1: return (const void *)(uintptr_t)draw();
    case 2: return (const void *)(uintptr_t)below(4096);
    case 3: return (const char *)&entry + below(4096);
    case 4: return noise + below(sizeof noise);
    default: return (const void *)~(uintptr_t)below(64);
    }
}

/* Changes some bits or a whole number of `size` bytes, but not those from `kept` on. */
static void damage(void *thing, size_t size, size_t kept) {
    unsigned char *bytes = thing;
    if (wild) kept = size;
    switch (below(3)) {
    case 0: bytes[below(kept)] ^= (unsigned char)(1u << below(8)); break;
    case 1: bytes[below(kept)] = (unsigned char)draw(); break;
    default: {
        const void *address = anywhere();
        memcpy(bytes + 8 * below(kept / 8), &address, sizeof address);
    }
    }
}

__attribute__((constructor)) static void begin(void) {
    Dl_info found;
    if (!dladdr((void *)&entry, &found)) return;
    const char *name = strrchr(found.dli_fname, '/');
    wild = name && strncmp(name + 1, "wild", 4) == 0;
    for (const char *c = name; c && *c; c++)
        if (*c >= '0' && *c <= '9') state = 10 * state + (uint64_t)(*c - '0');
    for (size_t i = 0; i < sizeof noise; i++) noise[i] = (char)draw();
    if (below(2)) noise[sizeof noise - 1] = 0;
    for (uint64_t i = 1 + below(3); i > 0; i--) {
        switch (below(15)) {
        case 0: damage(&entry, sizeof entry, offsetof(voltet_entry, init)); break;
        case 1: plugin_given = below(2) ? NULL : anywhere(); break;
        case 2: damage(&plugin, sizeof plugin, sizeof plugin); break;
        case 3: factory_given = below(2) ? NULL : anywhere(); break;
        case 4: damage(&factory, sizeof factory, offsetof(voltet_gradient_factory, filter_count)); break;
        case 5: counted = below(2) ? draw() : below(4); break;
        case 6: given = anywhere(); break;
        case 7: damage(&filters[0], sizeof filters[0], offsetof(voltet_gradient_filter, check)); break;
        case 8: filters[0].parameter_count = (uint32_t)below(100); break;
        case 9: words[below(2)] = anywhere(); break;
        case 10: meanings[below(2)] = anywhere(); break;
        case 11: code = draw(); break;
        case 12: kind_of_damage = 1 + below(2), points_damaged = 1 + below(40); break;
        case 13: says = 1 + below(5), loops = below(3); break;
        default: damage(&parameters[below(7)], sizeof parameters[0], sizeof parameters[0]); break;
        }
    }
}
