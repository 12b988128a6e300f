/*
 * voltet_plugin.h: gradient filters, readers, grid filters and image filters for voltet, in C, C++, or whatever speaks C's
 * calling convention.
 *
 * A plug-in is a shared library that exports one symbol, the constant `voltet_plugin_entry`. It is loaded by the user's word
 * alone (`voltet run --plugin ./filter.so scene.toml`). What it offers is then named in pipeline files and shown in help and in
 * the editor as what ships is: gradient filters by `method`, all others as nodes by `type`. Whole plug-ins:
 * examples/plugin_c/least_squares.c (a gradient filter), reader.c, filters.c (of grids and of images). Build one with
 *
 *     cc -std=c99 -O2 -shared -fPIC -Iinclude -o filter.so filter.c -lm
 *
 * Rules that hold throughout
 *
 * - Order of calls: init, get_factory for each kind, counts and descriptions, then what these name as often as the user likes,
 *   last deinit. A library stays loaded until the program ends. After a deinit there may be another init.
 * - Size: every struct begins with its size in bytes, as its maker knows it: `sizeof`. Structs grow at their ends only. Before
 *   you read what came after version 1.0 of a host's struct, compare its size.
 * - Memory: nobody frees or keeps what the other side allocated. What a description points to stays as it is until deinit. What
 *   the host hands over is valid during that call, is constant but for the output, and is not to be written otherwise. The host
 *   compares it after the call, all of it, and fails a call that wrote into it.
 * - Text is UTF-8 and ends with a 0 byte. Limits, in bytes: names, words and units 64; summaries, help, versions, meanings 1024;
 *   errors and notes 4096. Names of filters and parameters are lower-case letters, digits, '-' and '_', beginning with a letter.
 * - Threads: the host calls the functions of one plug-in one at a time, not always from the same thread. Threads of your own
 *   are allowed; they must have ended when the function returns that began them (idle ones of a run-time library may stay). The
 *   thread that calls has a stack of 64 MiB, those of `parallel_for` 2 MiB.
 * - Exceptions (C++), longjmp and whatever unwinds must not leave a plug-in's function: catch them and call host->error. One that
 *   does leave ends the program, with a message that names the plug-in.
 * - A crash or a call of exit ends the program, too, with an error that names the plug-in on Unix; so do _exit and exec on Linux, and end
 *   it without a word elsewhere. `voltet --plugin-process` runs plug-ins in a process of their own, which may end.
 * - Standard output belongs to the program: a picture may be on its way there. On Unix prints go to the standard error. Say
 *   what there is to say by the host's functions.
 * - On Linux the program may load a private copy of the file: `path` of init is the file itself. A library that calls dladdr is loaded from
 *   there.
 */
#ifndef VOLTET_PLUGIN_H
#define VOLTET_PLUGIN_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface. A program loads plug-ins of its own major version, whatever the others are. */
#define VOLTET_PLUGIN_MAJOR 1
#define VOLTET_PLUGIN_MINOR 2 /* 0: gradient filters alone. 1: readers, grid filters, image filters. 2: boundary, second rings. */
#define VOLTET_PLUGIN_PATCH 0

#if defined(_WIN32)
#define VOLTET_PLUGIN_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define VOLTET_PLUGIN_EXPORT __attribute__((visibility("default")))
#else
#define VOLTET_PLUGIN_EXPORT
#endif

/* What functions return. Any other number counts as VOLTET_ERROR. */
enum {
    VOLTET_OK = 0,
    VOLTET_CANCELLED = 1, /* The user asked to stop, and the function stopped. */
    VOLTET_ERROR = 2      /* The text is what host->error was called with. */
};

/* ---- What the host can do for a plug-in ------------------------------------------------------------------------------------- */

/* A part of a loop: the numbers from `first` to `end` - 1. `thread` is below the host's thread_count, and no two parts run under
 * the same number at once: the place of scratch memory. Called from any thread. */
typedef void (*voltet_loop_body)(void *user, uint64_t first, uint64_t end, uint32_t thread);

/* Valid during the call that it was handed to. Each function takes the host itself first, and may be called from any thread
 * while that call lasts. */
typedef struct voltet_host {
    uint32_t size;
    uint32_t major, minor, patch; /* The version of the interface that the program was built with. */
    uint32_t thread_count;        /* Threads that the plug-in may use, at least 1. */
    uint32_t reserved;
    const char *program; /* "voltet 0.2.0". */
    void *context;       /* The host's own. */

    /* `fraction` of the work (0 to 1) is done. Cheap: call it a thousand times a second if you like. */
    void (*progress)(const struct voltet_host *host, double fraction);

    /* Whether the user asked to stop. Long loops ask now and then, and return VOLTET_CANCELLED. A filter that does not is
     * given up after three seconds: the user is told that the program must be ended. */
    int32_t (*cancelled)(const struct voltet_host *host);

    /* What went wrong: a clause without a full stop, such as "cell 12 has no volume". The first text counts. */
    void (*error)(const struct voltet_host *host, const char *text);

    /* The filter did with less than it promises at `point_count` points. `what` is a clause that "at 12 points" can follow:
     * "set to zero: the neighbours lie in a plane". The user is warned. Counts of the same text add up; 0 says nothing. At most
     * 32 different texts. */
    void (*fallback)(const struct voltet_host *host, const char *what, uint64_t point_count);

    /* Runs `body` over the numbers below `count` on the host's threads, in parts of `chunk` numbers (the last may be shorter; 0:
     * the host chooses), each once, in any order. Comes back when all are done. When the user asked to stop, parts that have not
     * begun are left out, and it returns VOLTET_CANCELLED; otherwise VOLTET_OK. A body may call all of these functions; loops
     * within a body run one part after the other. */
    int32_t (*parallel_for)(const struct voltet_host *host, uint64_t count, uint64_t chunk, voltet_loop_body body,
                            void *user);
} voltet_host;

/* ---- Parameters -------------------------------------------------------------------------------------------------------------- */

/* What a parameter may be: how the pipeline file gives it, and where the call finds it in voltet_values. */
enum {
    VOLTET_BOOLEAN = 1,     /* true or false: integers, 0 or 1. */
    VOLTET_INTEGER = 2,     /* A whole number: integers and numbers. */
    VOLTET_NUMBER = 3,      /* A number: numbers. */
    VOLTET_CHOICE = 4,      /* One of several words: integers (its place, from 0) and texts. */
    VOLTET_TEXT = 5,        /* Any text: texts. */
    VOLTET_VECTOR = 6,      /* A list of numbers: vectors and lengths. */
    VOLTET_POINT_ARRAY = 7  /* The name of an array of the data with a value a point: texts; the values: voltet_call.arrays,
                               voltet_grid_call.arrays. Of gradient filters and grid filters alone. */
};

/* Flags of a parameter. */
enum {
    VOLTET_REQUIRED = 1,      /* The pipeline file must give it; there is no default. */
    VOLTET_EXCLUSIVE_MIN = 2, /* `min` itself is excluded. */
    VOLTET_EXCLUSIVE_MAX = 4, /* `max` itself is excluded. */
    /* Names of these until version 0.2 of voltet. */
    VOLTET_ABOVE_LEAST = VOLTET_EXCLUSIVE_MIN,
    VOLTET_BELOW_MOST = VOLTET_EXCLUSIVE_MAX
};

/* Names of the fields `min` and `max` until version 0.2, where VOLTET_OLD_NAMES is defined before this header. */
#ifdef VOLTET_OLD_NAMES
#define least min
#define most max
#endif

/* A parameter. The elements of an array of these are `size` bytes apart, and all of the same size. What does not belong to its
 * type is 0. */
typedef struct voltet_parameter {
    uint32_t size;
    uint32_t type;    /* VOLTET_BOOLEAN ... */
    const char *name; /* The key in the pipeline file. "type", "inputs" and "method" are taken, and for readers the names that
                         every reader has: path, scalar, association, cell_values, time_step, time, subdivision. */
    const char *unit; /* NULL or "" where it has none. */
    const char *help; /* One line. */
    uint32_t flags;   /* VOLTET_REQUIRED ... or 0. */
    uint32_t length;  /* VOLTET_VECTOR: how many numbers, 0: any, at most 1024. VOLTET_POINT_ARRAY: components a point, at least 1. */
    double min;       /* The range of VOLTET_INTEGER, VOLTET_NUMBER and each number of VOLTET_VECTOR: from min to max, */
    double max;       /* both included unless flags say otherwise. -INFINITY and INFINITY: no limit. Both 0: no limits. */
    double number;    /* The default of VOLTET_BOOLEAN (0 or 1), VOLTET_INTEGER and VOLTET_NUMBER. */
    const char *text; /* The default of VOLTET_CHOICE and VOLTET_TEXT. VOLTET_POINT_ARRAY: NULL, or a default name. */
    const double *numbers; /* The default of VOLTET_VECTOR, `length` of them; NULL: none. */
    const char *unset; /* What it means where VOLTET_TEXT, VOLTET_VECTOR or VOLTET_POINT_ARRAY has no default and is not given,
                          such as "every point alike". They are NULL in the call then. */
    uint32_t word_count; /* VOLTET_CHOICE: how many words, at most 64. */
    uint32_t reserved;
    const char *const *words;    /* VOLTET_CHOICE: the words, */
    const char *const *meanings; /* and what each means, one line. */
} voltet_parameter;

/* What the parameters are set to: arrays of `count` elements, in the order of the declarations. They were checked against
 * these. Elements that do not belong to a parameter's type are 0 or NULL. */
typedef struct voltet_values {
    uint32_t size;
    uint32_t count;
    const int64_t *integers;
    const double *numbers;
    const char *const *texts;
    const double *const *vectors;
    const uint32_t *lengths; /* How many numbers a vector has. */
} voltet_values;

/* ---- Gradient filters -------------------------------------------------------------------------------------------------------- */

/* What a filter needs beside points, cells and scalar. What it does not ask for is not computed, and NULL in the call. */
enum {
    VOLTET_NEEDS_NEIGHBOURS = 1,      /* neighbour_starts and neighbours. */
    VOLTET_NEEDS_CELLS_OF_POINTS = 2, /* cell_starts and cells_of_points. */
    VOLTET_NEEDS_BOUNDARY = 4,        /* at_boundary (since 1.2: an older program refuses the filter). */
    VOLTET_NEEDS_SECOND_RINGS = 8     /* second_ring_starts and second_rings (since 1.2). */
};

/* The grid, the scalar, and where the gradient goes. */
typedef struct voltet_call {
    uint32_t size;
    uint32_t reserved;
    uint64_t point_count;
    uint64_t cell_count;
    const double *points;  /* x, y, z of each point: 3 point_count numbers. Those of points that no cell uses may not be finite. */
    const uint32_t *cells; /* The points of each cell, ascending: 4 cell_count numbers. All cells are tetrahedra; those of other
                              shapes were split into such that share faces. */
    /* The points that share an edge with point p: neighbours[neighbour_starts[p]] up to, without, [neighbour_starts[p + 1]],
     * each once, without p, in no order. point_count + 1 starts. A neighbour may lie at the position of p itself, and cells may be
     * flat: a weight by the distance divides by 0 there. `voltet gradient-test` has such a grid. */
    const uint64_t *neighbour_starts;
    const uint32_t *neighbours;
    /* The cells that use point p, ascending, in the same form. */
    const uint64_t *cell_starts;
    const uint32_t *cells_of_points;
    const double *scalar; /* One value a point. */
    /* The values of the array that each parameter of type VOLTET_POINT_ARRAY names, the components of a point side by side; as
     * many elements as there are parameters. */
    const double *const *arrays;
    const voltet_values *values;
    /* Out: the gradient's x, y, z at each point, in units of the scalar per length: 3 point_count numbers. A point of a cell that
     * gets none, or one that is not finite, makes the run fail. What no cell uses may be left as it is. */
    double *gradient;
    /* Since 1.2. */
    const uint8_t *at_boundary; /* 1 for points of a face that one cell alone has, 0 for others: point_count of them. */
    /* The points within two edges of point p, without p, in the form of the neighbours: first these, then theirs. */
    const uint64_t *second_ring_starts;
    const uint32_t *second_rings;
} voltet_call;

/* What a filter is: its name, what it does, its parameters and its functions. */
typedef struct voltet_gradient_filter {
    uint32_t size;
    uint32_t needs;      /* VOLTET_NEEDS_NEIGHBOURS ... or 0. */
    const char *name;    /* The name in pipeline files: method = "name". */
    const char *summary; /* What it does, one sentence. */
    uint32_t parameter_count; /* At most 64. */
    uint32_t reserved;
    const voltet_parameter *parameters;

    /* Checks what single declarations cannot say, such as parameters that exclude each other. May be NULL. Quick; touches no
     * files. VOLTET_OK, or VOLTET_ERROR with a text. */
    int32_t (*check)(const voltet_values *values, const voltet_host *host);

    /* Computes the gradient at every point. VOLTET_OK, VOLTET_CANCELLED, or VOLTET_ERROR with a text. */
    int32_t (*gradient)(const voltet_call *call, const voltet_host *host);
} voltet_gradient_filter;

/* The kind of factory that gives gradient filters. A plug-in may have several kinds; return NULL for those that you do not know.
 * All that a plug-in offers has different names. */
#define VOLTET_GRADIENT_FILTERS "voltet.gradient-filters/1"

typedef struct voltet_gradient_factory {
    uint32_t size;
    uint32_t reserved;
    /* How many filters there are, at most 256. */
    uint32_t (*filter_count)(void);
    /* The description of one, by its place from 0. */
    const voltet_gradient_filter *(*filter)(uint32_t place);
} voltet_gradient_factory;

/* ---- Grids: what readers and grid filters give (since 1.1) ------------------------------------------------------------------- */

/* What an array of a grid is. Of several, the elements are `size` bytes apart, and all of the same size. */
typedef struct voltet_array_head {
    uint32_t size;
    uint32_t component_count; /* Numbers a tuple, 1 to 1024; those of one tuple stand side by side. */
    const char *name;         /* Its name in the pipeline, at most 1024 bytes. No two at points, and no two at cells, share one. */
    uint32_t on_cells;        /* 0: a tuple a point; 1: a tuple a cell. */
    uint32_t reserved;
} voltet_array_head;

/* Flags of a grid. */
enum {
    VOLTET_TETRAHEDRA = 1,  /* All cells are tetrahedra: they are written to `tetrahedra`, in place of types, offsets and
                               connectivity. */
    VOLTET_SAME_POINTS = 2, /* Of a grid filter: the points are those of the input, and its arrays stay, but for those that are
                               given anew. `points` is NULL then. */
    VOLTET_SAME_CELLS = 4   /* The same: the cells are those of the input. The counts of points are then equal, too. */
};

/* How large a grid is and what it holds, but for the numbers. The host copies it. */
typedef struct voltet_grid_head {
    uint32_t size;
    uint32_t flags;              /* VOLTET_TETRAHEDRA ... or 0. */
    uint64_t point_count;        /* Less than 2^32. 0 with VOLTET_SAME_POINTS. */
    uint64_t cell_count;         /* The same. 0 with VOLTET_SAME_CELLS. */
    uint64_t connectivity_count; /* Numbers of points of all cells together; 0 with VOLTET_TETRAHEDRA or VOLTET_SAME_CELLS. */
    uint32_t array_count;        /* At most 4096. */
    uint32_t step_count;         /* Of a reader: steps of the time series that the file is, at most 2^20; 0: it is none. */
    const voltet_array_head *arrays;
    const char *scalar;  /* Of a reader: the array that is drawn where the pipeline names none; of a grid filter: the array that is
                            drawn from now on, one of `arrays` of one component. NULL: none is marked; the one drawn before. */
    const double *times; /* The time of each step, ascending, in the file's own unit. */
    const char *format;  /* Of a reader: how the file is written, for `voltet info`; NULL: the reader's name. */
} voltet_grid_head;

/* Memory of the host for a grid of that size: to be filled during the call, and not to be touched afterwards. What is NULL is not
 * asked for. What is left unset is an error, and so is what is written beyond the end of any of these. */
typedef struct voltet_grid_buffers {
    uint32_t size;
    uint32_t array_count;
    uint64_t point_count;
    uint64_t cell_count;
    uint64_t connectivity_count;
    double *points;             /* x, y, z of each point: 3 point_count numbers. */
    uint32_t *tetrahedra;       /* 4 cell_count numbers, with VOLTET_TETRAHEDRA. */
    uint8_t *types;             /* Otherwise VTK's code of each cell (vtkCellType.h), without polyhedra (42), */
    int64_t *offsets;           /* cell_count + 1: cell i has connectivity_u32[offsets[i]] to [offsets[i + 1] - 1], the first is 0, */
    uint32_t *connectivity_u32; /* the numbers of points, from 0, with VTK's order in a cell. */
    double *const *arrays;      /* The values of each array of the head; NULL for one that nobody asks for. Values that are not
                                   finite are as in any file: cells that touch one are left out and counted. */
} voltet_grid_buffers;

/* ---- Readers (since 1.1) ----------------------------------------------------------------------------------------------------- */

/* What is to be read. */
typedef struct voltet_reading {
    uint32_t size;
    uint32_t reserved;
    const char *path; /* The file, as this process can open it. */
    uint64_t step;    /* Which step of a series, from 0; 0 where the file is none. */
    const voltet_values *values;
    /* Of `inspect`: says what the file holds at that step; to be called once. VOLTET_OK, or VOLTET_ERROR where the head contradicts
     * itself: then return that, too. NULL in `read`. */
    int32_t (*describe)(const struct voltet_reading *reading, const voltet_grid_head *head);
    const voltet_grid_buffers *buffers; /* Of `read`: where it goes. Points and cells are NULL where they are not asked for. NULL in
                                           `inspect`. */
    void *context;                      /* The host's own. */
} voltet_reading;

/* What a reader is: the type of a node that gives a grid, with the parameters of every reader and its own. */
typedef struct voltet_reader {
    uint32_t size;
    uint32_t reserved;
    const char *name;    /* The type in pipeline files: type = "name". */
    const char *summary; /* What it reads, one sentence. */
    uint32_t parameter_count; /* At most 64. */
    uint32_t extension_count; /* At most 16. */
    const voltet_parameter *parameters;
    int32_t (*check)(const voltet_values *values, const voltet_host *host); /* As that of a gradient filter. */

    /* Says by reading->describe how large the file's grid is and what it holds, from its headers where it has such: it is called
     * more often than `read`. */
    int32_t (*inspect)(const voltet_reading *reading, const voltet_host *host);

    /* Reads what is asked for into memory of the size that `inspect` gave. A file that is not as large any more is an error. */
    int32_t (*read)(const voltet_reading *reading, const voltet_host *host);

    /* How `voltet info FILE`, the editor and the node `reader` know a file: by how it begins where `magic` is given, otherwise by what
     * its name ends with after a dot, in lower case. */
    const char *const *extensions;
    const uint8_t *magic;
    uint32_t magic_length; /* Bytes, at most 64; 0: none. */
    uint32_t reserved_too;
} voltet_reader;

/* The kind of factory that gives readers. */
#define VOLTET_READERS "voltet.readers/1"

typedef struct voltet_reader_factory {
    uint32_t size;
    uint32_t reserved;
    uint32_t (*reader_count)(void); /* At most 256. */
    const voltet_reader *(*reader)(uint32_t place);
} voltet_reader_factory;

/* ---- Grid filters (since 1.1) ------------------------------------------------------------------------------------------------ */

/* An array of the input, one tuple a point. */
typedef struct voltet_given_array {
    uint32_t size;
    uint32_t component_count;
    const char *name;
    const double *values;
} voltet_given_array;

/* The grid that a filter is given, and how it gives its own. */
typedef struct voltet_grid_call {
    uint32_t size;
    uint32_t array_count;
    uint64_t point_count;
    uint64_t cell_count;
    const double *points;       /* As in voltet_call. */
    const uint32_t *tetrahedra; /* 4 cell_count numbers, ascending in each cell: cells of other shapes were split. */
    const voltet_given_array *carried; /* The arrays that the grid carries: the scalar that is drawn, first, if there is one, and
                                          what somebody asks for, so not all that the file holds. array_count of them. */
    const char *scalar;                /* The name of the scalar that is drawn; NULL: the grid carries none. */
    const double *const *arrays;       /* As in voltet_call: the array that each parameter names. */
    const voltet_values *values;
    /* Hands out memory for the filter's own grid; to be called once. Fills *buffers, whose size the filter has set. VOLTET_OK, or
     * VOLTET_ERROR where the head contradicts itself or memory ends: then return that, too. */
    int32_t (*begin)(const struct voltet_grid_call *call, const voltet_grid_head *head, voltet_grid_buffers *buffers);
    void *context; /* The host's own. */
} voltet_grid_call;

/* What a grid filter is: the type of a node that takes a grid and gives one. */
typedef struct voltet_grid_filter {
    uint32_t size;
    uint32_t reserved;
    const char *name;
    const char *summary;
    uint32_t parameter_count; /* At most 64. */
    uint32_t made_count;      /* At most 64. */
    const voltet_parameter *parameters;
    int32_t (*check)(const voltet_values *values, const voltet_host *host);

    /* Makes the grid: begins it by call->begin, and fills it. Positions must be finite. Other arrays that the input carried must be
     * given, too, unless VOLTET_SAME_POINTS keeps them. */
    int32_t (*filter)(const voltet_grid_call *call, const voltet_host *host);

    const char *const *made; /* The names of arrays that it makes itself: they are not asked of the input. NULL where none. */
} voltet_grid_filter;

/* The kind of factory that gives grid filters. */
#define VOLTET_GRID_FILTERS "voltet.grid-filters/1"

typedef struct voltet_grid_factory {
    uint32_t size;
    uint32_t reserved;
    uint32_t (*filter_count)(void); /* At most 256. */
    const voltet_grid_filter *(*filter)(uint32_t place);
} voltet_grid_factory;

/* ---- Image filters (since 1.1) ----------------------------------------------------------------------------------------------- */

/* A picture, and where the filtered one goes: premultiplied linear RGBA with the primaries of sRGB, 4 floats a pixel, row 0 at the
 * top. */
typedef struct voltet_image_call {
    uint32_t size;
    uint32_t reserved;
    uint64_t width, height; /* Pixels. */
    const float *rgba;      /* 4 width height numbers. */
    const voltet_values *values;
    float *filtered; /* Out: as many. Every number must be set and finite, the last of each pixel 0 to 1. */
} voltet_image_call;

/* What an image filter is: the type of a node that takes a picture and gives one of the same size. */
typedef struct voltet_image_filter {
    uint32_t size;
    uint32_t reserved;
    const char *name;
    const char *summary;
    uint32_t parameter_count; /* At most 64. */
    uint32_t reserved_too;
    const voltet_parameter *parameters;
    int32_t (*check)(const voltet_values *values, const voltet_host *host);
    int32_t (*filter)(const voltet_image_call *call, const voltet_host *host);
} voltet_image_filter;

/* The kind of factory that gives image filters. */
#define VOLTET_IMAGE_FILTERS "voltet.image-filters/1"

typedef struct voltet_image_factory {
    uint32_t size;
    uint32_t reserved;
    uint32_t (*filter_count)(void); /* At most 256. */
    const voltet_image_filter *(*filter)(uint32_t place);
} voltet_image_factory;

/* ---- The library ------------------------------------------------------------------------------------------------------------- */

/* What a plug-in says of itself. */
typedef struct voltet_plugin {
    uint32_t size;
    uint32_t reserved;
    const char *name;    /* For messages, and for pictures that say what they were made with. */
    const char *version; /* Its own, in any form. */
} voltet_plugin;

/* The one symbol that a plug-in exports. */
typedef struct voltet_entry {
    uint32_t size;
    uint32_t major, minor, patch; /* VOLTET_PLUGIN_MAJOR ... of the header that the plug-in was compiled with. */
    /* Called first. `path`: the library's own file. What the plug-in is; NULL, with a text by host->error, where it cannot serve. */
    const voltet_plugin *(*init)(const char *path, const voltet_host *host);
    /* Called last, if init gave something; not where the program ends at once. May be NULL. */
    void (*deinit)(void);
    /* The factory of a kind, such as VOLTET_GRADIENT_FILTERS for a voltet_gradient_factory; NULL where there is none. A kind that
     * you do not know may come. Where the same is given for several kinds, it counts for the first of them alone. */
    const void *(*get_factory)(const char *kind);
} voltet_entry;

extern VOLTET_PLUGIN_EXPORT const voltet_entry voltet_plugin_entry;

/* All that surrounds a plug-in of gradient filters alone: behind the definitions of the filters, once in the library, without a semicolon.
 *
 *     static const voltet_gradient_filter mean = {sizeof mean, ...};
 *     VOLTET_GRADIENT_PLUGIN("my filters", "1.0", &mean)
 *
 * The last argument is one filter or several, separated by commas. For what needs init or offers other kinds, write the entry out. */
#define VOLTET_GRADIENT_PLUGIN(plugin_name, plugin_version, ...)                                                                  \
    static const voltet_gradient_filter *const voltet_own_filters[] = {__VA_ARGS__};                                              \
    static uint32_t voltet_own_filter_count(void) {                                                                               \
        return (uint32_t)(sizeof voltet_own_filters / sizeof *voltet_own_filters);                                                \
    }                                                                                                                             \
    static const voltet_gradient_filter *voltet_own_filter(uint32_t place) { return voltet_own_filters[place]; }                  \
    static const voltet_plugin *voltet_own_init(const char *path, const voltet_host *host) {                                      \
        static const voltet_plugin plugin = {sizeof(voltet_plugin), 0, plugin_name, plugin_version};                              \
        (void)path, (void)host;                                                                                                   \
        return &plugin;                                                                                                           \
    }                                                                                                                             \
    static const void *voltet_own_factory(const char *kind) {                                                                     \
        static const voltet_gradient_factory factory = {sizeof(voltet_gradient_factory), 0, voltet_own_filter_count,              \
                                                        voltet_own_filter};                                                       \
        const char *own = VOLTET_GRADIENT_FILTERS;                                                                                \
        while (*kind && *kind == *own) kind++, own++;                                                                             \
        return *kind == *own ? &factory : 0;                                                                                      \
    }                                                                                                                             \
    const voltet_entry voltet_plugin_entry = {                                                                                    \
        sizeof(voltet_entry), VOLTET_PLUGIN_MAJOR, VOLTET_PLUGIN_MINOR, VOLTET_PLUGIN_PATCH, voltet_own_init, 0,                  \
        voltet_own_factory};

#ifdef __cplusplus
}
#endif

#endif
