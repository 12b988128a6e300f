/*
 * Plug-ins that do what they must not. FAULT (a number, given to the compiler) chooses what is wrong with what the library
 * declares; the parameter `fault` what is wrong with what its filter does.
 */
#include "voltet_plugin.h"

#include <fenv.h>
#include <math.h>
#include <stddef.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#ifdef __linux__
#include <sys/resource.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#endif

#ifndef FAULT
#define FAULT 0
#endif

/* The gradient of 2 x + 3 y - z, wherever that is the scalar. */
static const double right[3] = {2, 3, -1};

static void body(void *user, uint64_t first, uint64_t end, uint32_t thread) {
    double *gradient = user;
    (void)thread;
    for (uint64_t p = first; p < end; p++) memcpy(gradient + 3 * p, right, sizeof right);
}

static void leave(void *user, uint64_t first, uint64_t end, uint32_t thread) {
    (void)user, (void)end, (void)thread;
    if (first == 500) exit(3);
}

/* Rounds up, as threads of the host must not go on to do. */
static void round_up(void *user, uint64_t first, uint64_t end, uint32_t thread) {
    (void)user, (void)first, (void)end, (void)thread;
    fesetround(FE_UPWARD);
}

static void leave_quietly(void) { _exit(0); }

/* Writes over all memory from its own stack upwards. */
static void overrun(void) {
    volatile char room[1];
    for (size_t i = 0; i < (size_t)1 << 40; i++) ((volatile char *)room)[i] = 1;
}

static int recurse(volatile int depth) {
    volatile char room[4096];
    room[0] = (char)depth;
    return depth < 0 ? 0 : recurse(depth + 1) + room[0];
}

static int32_t gradient(const voltet_call *call, const voltet_host *host) {
    const char *fault = call->values->texts[0];
    const int32_t code = host->parallel_for(host, call->point_count, 0, body, call->gradient);
    if (!strcmp(fault, "error")) return host->error(host, "cell 12 has no volume"), VOLTET_ERROR;
    if (!strcmp(fault, "mute")) return 77;
    if (!strcmp(fault, "stopped")) return VOLTET_CANCELLED;
    if (!strcmp(fault, "nan")) call->gradient[3] = NAN;
    if (!strcmp(fault, "infinite")) call->gradient[4] = INFINITY;
    if (!strcmp(fault, "huge")) call->gradient[3] = call->gradient[4] = 1e308, call->gradient[5] = 1.7e308;
    if (!strcmp(fault, "beyond")) call->gradient[3 * call->point_count + 2] = 1;
    if (!strcmp(fault, "a block beyond")) memset(call->gradient + 3 * call->point_count, 0, 3 * 4096 * sizeof(double));
    if (!strcmp(fault, "endless")) {
        for (;;) host->progress(host, NAN);
    }
    if (!strcmp(fault, "patient")) {
        fputs("a plug-in waits\n", stderr);
        while (!host->cancelled(host)) usleep(1000);
        fputs("a plug-in stopped\n", stderr);
        return VOLTET_CANCELLED;
    }
    /* Inputs that are written to. */
    if (!strcmp(fault, "points")) ((double *)call->points)[7] += 1;
    if (!strcmp(fault, "cells")) ((uint32_t *)call->cells)[3] = 0;
    if (!strcmp(fault, "scalar")) memset((double *)call->scalar, 0, 8 * call->point_count);
    if (!strcmp(fault, "neighbours")) ((uint32_t *)call->neighbours)[0] += 1;
    if (!strcmp(fault, "cells of points")) ((uint64_t *)call->cell_starts)[call->point_count] = 0;
    if (!strcmp(fault, "values")) ((double *)call->values->numbers)[2] = 9;
    int *volatile nowhere = (int *)8;
    if (!strcmp(fault, "crash")) *nowhere = 1;
    if (!strcmp(fault, "abort")) abort();
    if (!strcmp(fault, "exit")) exit(0);
    if (!strcmp(fault, "rounds")) host->parallel_for(host, 100000, 1, round_up, NULL), fesetround(FE_UPWARD);
    if (!strcmp(fault, "elsewhere") && chdir("/")) abort();
    if (!strcmp(fault, "quiet exit")) _exit(0);
    if (!strcmp(fault, "exec")) execl("/bin/true", "true", (char *)NULL);
    if (!strcmp(fault, "abort at exit")) atexit(abort);
    if (!strcmp(fault, "quiet exit at exit")) atexit(leave_quietly);
#ifdef __linux__
    if (!strcmp(fault, "private files")) umask(0777);
    if (!strcmp(fault, "small files")) {
        struct rlimit limit = {1, RLIM_INFINITY};
        setrlimit(RLIMIT_FSIZE, &limit);
    }
    if (!strcmp(fault, "thread ended")) syscall(SYS_exit, 0);
    if (!strcmp(fault, "memory ends")) {
        /* All that is left is taken; the host then has no room for the text. */
        struct rlimit limit;
        static char text[3000];
        getrlimit(RLIMIT_AS, &limit);
        limit.rlim_cur = 0;
        setrlimit(RLIMIT_AS, &limit);
        for (size_t room = (size_t)1 << 24; room >= 16; room /= 2)
            for (void *volatile taken = text; taken;) taken = malloc(room);
        memset(text, 'x', sizeof text - 1);
        host->error(host, text);
        return VOLTET_ERROR;
    }
#endif
    if (!strcmp(fault, "exit in a loop")) host->parallel_for(host, 1000, 1, leave, NULL);
    if (!strcmp(fault, "deep")) recurse(0);
    if (!strcmp(fault, "overrun")) overrun();
    if (!strcmp(fault, "prints")) puts("a plug-in prints"), fflush(stdout);
    if (!strcmp(fault, "notes")) {
        char text[9000];
        memset(text, 'x', sizeof text);
        text[sizeof text - 1] = 0;
        for (int i = 0; i < 100; i++) {
            text[0] = (char)('!' + i);
            host->fallback(host, text, 1);
        }
        host->fallback(host, NULL, 1);
        host->fallback(host, "\xff\x01", UINT64_MAX);
        host->fallback(NULL, "nobody", 1);
        host->error(host, NULL);
        host->parallel_for(host, 10, 0, NULL, NULL);
    }
    return code;
}

static int32_t few(const voltet_call *call, const voltet_host *host) {
    return host->parallel_for(host, call->point_count - 2, 100, body, call->gradient);
}

static int32_t check(const voltet_values *values, const voltet_host *host) {
    if (!strcmp(values->texts[0], "refused")) return host->error(host, "'fault' must not be refused"), VOLTET_ERROR;
    return VOLTET_OK;
}

#if FAULT == 20
static const char *const words[] = {"none", "none"};
#else
static const char *const words[] = {"none", "other"};
#endif
static const char *const meanings[] = {"nothing", "something else"};

static voltet_parameter parameters[] = {
    {.size = sizeof(voltet_parameter), .type = VOLTET_TEXT, .name = "fault", .help = "what it does wrong", .text = "none"},
    {.size = sizeof(voltet_parameter),
     .type = VOLTET_CHOICE,
     .name = "word",
     .help = "a word",
     .text = "none",
     .word_count = 2,
     .words = words,
     .meanings = meanings},
    {.size = sizeof(voltet_parameter),
     .type = VOLTET_NUMBER,
     .name = "number",
     .help = "a number",
     .min = 0,
     .max = 1,
     .number = 0.5},
};

static voltet_gradient_filter filters[] = {
    {.size = sizeof(voltet_gradient_filter),
     .name = "faulty",
     .needs = VOLTET_NEEDS_NEIGHBOURS | VOLTET_NEEDS_CELLS_OF_POINTS,
     .summary = "Gives the gradient of 2 x + 3 y - z, or what its parameter says.",
     .parameter_count = 3,
     .parameters = parameters,
     .check = check,
     .gradient = gradient},
    {.size = sizeof(voltet_gradient_filter),
     .name = "faulty-few",
     .summary = "Leaves two points out.",
     .gradient = few},
};

static uint32_t filter_count(void) {
#if FAULT == 1
    return 1000000;
#elif FAULT == 2
    return 0;
#else
    return 2;
#endif
}

static const voltet_gradient_filter *filter(uint32_t place) {
#if FAULT == 3
    return place == 0 ? &filters[0] : NULL;
#else
    return &filters[place];
#endif
}

static voltet_gradient_factory factory = {
    .size = sizeof(voltet_gradient_factory), .filter_count = filter_count, .filter = filter};
static voltet_plugin plugin = {.size = sizeof(voltet_plugin), .name = "faulty", .version = "0.1"};

static char long_text[5000];

__attribute__((unused)) static const voltet_plugin *init(const char *path, const voltet_host *host) {
    (void)path;
    memset(long_text, 'a', sizeof long_text - 1);
#if FAULT == 4
    return NULL;
#elif FAULT == 5
    host->error(host, "the licence has run out");
    return NULL;
#elif FAULT == 6
    plugin.size = 8;
#elif FAULT == 7
    plugin.name = NULL;
#elif FAULT == 8
    plugin.name = "caf\xe9";
#elif FAULT == 9
    filters[0].name = long_text;
#elif FAULT == 10
    filters[0].name = "Two Words";
#elif FAULT == 11
    filters[1].name = "faulty";
#elif FAULT == 12
    filters[0].gradient = NULL;
#elif FAULT == 13
    filters[0].parameter_count = 65;
#elif FAULT == 14
    filters[0].parameters = NULL;
#elif FAULT == 15
    parameters[1].size = 48;
#elif FAULT == 16
    parameters[0].type = 99;
#elif FAULT == 17
    parameters[2].number = 7;
#elif FAULT == 18
    parameters[2].min = 2;
#elif FAULT == 19
    parameters[1].text = "third";
#elif FAULT == 21
    parameters[1].words = NULL;
#elif FAULT == 22
    parameters[1].word_count = 1u << 30;
#elif FAULT == 23
    parameters[1].name = "fault";
#elif FAULT == 24
    parameters[1].name = "inputs";
#elif FAULT == 25
    parameters[0].help = "";
#elif FAULT == 26
    parameters[0].help = "two\nlines";
#elif FAULT == 27
    filters[0].needs = 1u << 20;
#elif FAULT == 28
    filters[0].name = "least-squares";
#elif FAULT == 29
    filters[0].summary = (const char *)16;
#elif FAULT == 30
    abort();
#elif FAULT == 38
    exit(3);
#elif FAULT == 39
    _exit(0);
#elif FAULT == 31
    factory.filter = NULL;
#elif FAULT == 32
    parameters[1].words = (const char *const *)-8;
#endif
    (void)host;
    return &plugin;
}

static const void *get_factory(const char *kind) {
#if FAULT == 33
    return NULL;
#endif
    return strcmp(kind, VOLTET_GRADIENT_FILTERS) == 0 ? &factory : NULL;
}

#if FAULT == 34
#define MAJOR 2
#else
#define MAJOR VOLTET_PLUGIN_MAJOR
#endif
#if FAULT == 35
#define SIZE 20
#else
#define SIZE sizeof(voltet_entry)
#endif
#if FAULT == 36
#define INIT NULL
#else
#define INIT init
#endif
#if FAULT != 37
const voltet_entry voltet_plugin_entry = {SIZE, MAJOR, 3, 1, INIT, NULL, get_factory};
#else
const voltet_entry another_name;
const voltet_entry another_name = {SIZE, MAJOR, 3, 1, INIT, NULL, get_factory};
#endif
