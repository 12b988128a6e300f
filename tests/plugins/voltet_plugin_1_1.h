/* The plug-in header of version 1.1 without its comments, as libraries were compiled against it: it stays as it is. */
#ifndef VOLTET_PLUGIN_H
#define VOLTET_PLUGIN_H
#include <stdint.h>
#ifdef __cplusplus
extern "C" {
#endif
#define VOLTET_PLUGIN_MAJOR 1
#define VOLTET_PLUGIN_MINOR 1
#define VOLTET_PLUGIN_PATCH 0
#if defined(_WIN32)
#define VOLTET_PLUGIN_EXPORT __declspec(dllexport)
#elif defined(__GNUC__)
#define VOLTET_PLUGIN_EXPORT __attribute__((visibility("default")))
#else
#define VOLTET_PLUGIN_EXPORT
#endif
enum {
    VOLTET_OK = 0,
    VOLTET_CANCELLED = 1,
    VOLTET_ERROR = 2
};
typedef void (*voltet_loop_body)(void *user, uint64_t first, uint64_t end, uint32_t thread);
typedef struct voltet_host {
    uint32_t size;
    uint32_t major, minor, patch;
    uint32_t thread_count;
    uint32_t reserved;
    const char *program;
    void *context;
    void (*progress)(const struct voltet_host *host, double fraction);
    int32_t (*cancelled)(const struct voltet_host *host);
    void (*error)(const struct voltet_host *host, const char *text);
    void (*fallback)(const struct voltet_host *host, const char *what, uint64_t point_count);
    int32_t (*parallel_for)(const struct voltet_host *host, uint64_t count, uint64_t chunk, voltet_loop_body body,
                            void *user);
} voltet_host;
enum {
    VOLTET_BOOLEAN = 1,
    VOLTET_INTEGER = 2,
    VOLTET_NUMBER = 3,
    VOLTET_CHOICE = 4,
    VOLTET_TEXT = 5,
    VOLTET_VECTOR = 6,
    VOLTET_POINT_ARRAY = 7
};
enum {
    VOLTET_REQUIRED = 1,
    VOLTET_EXCLUSIVE_MIN = 2,
    VOLTET_EXCLUSIVE_MAX = 4,
    VOLTET_ABOVE_LEAST = VOLTET_EXCLUSIVE_MIN,
    VOLTET_BELOW_MOST = VOLTET_EXCLUSIVE_MAX
};
#ifdef VOLTET_OLD_NAMES
#define least min
#define most max
#endif
typedef struct voltet_parameter {
    uint32_t size;
    uint32_t type;
    const char *name;
    const char *unit;
    const char *help;
    uint32_t flags;
    uint32_t length;
    double min;
    double max;
    double number;
    const char *text;
    const double *numbers;
    const char *unset;
    uint32_t word_count;
    uint32_t reserved;
    const char *const *words;
    const char *const *meanings;
} voltet_parameter;
typedef struct voltet_values {
    uint32_t size;
    uint32_t count;
    const int64_t *integers;
    const double *numbers;
    const char *const *texts;
    const double *const *vectors;
    const uint32_t *lengths;
} voltet_values;
enum {
    VOLTET_NEEDS_NEIGHBOURS = 1,
    VOLTET_NEEDS_CELLS_OF_POINTS = 2
};
typedef struct voltet_call {
    uint32_t size;
    uint32_t reserved;
    uint64_t point_count;
    uint64_t cell_count;
    const double *points;
    const uint32_t *cells;
    const uint64_t *neighbour_starts;
    const uint32_t *neighbours;
    const uint64_t *cell_starts;
    const uint32_t *cells_of_points;
    const double *scalar;
    const double *const *arrays;
    const voltet_values *values;
    double *gradient;
} voltet_call;
typedef struct voltet_gradient_filter {
    uint32_t size;
    uint32_t needs;
    const char *name;
    const char *summary;
    uint32_t parameter_count;
    uint32_t reserved;
    const voltet_parameter *parameters;
    int32_t (*check)(const voltet_values *values, const voltet_host *host);
    int32_t (*gradient)(const voltet_call *call, const voltet_host *host);
} voltet_gradient_filter;
#define VOLTET_GRADIENT_FILTERS "voltet.gradient-filters/1"
typedef struct voltet_gradient_factory {
    uint32_t size;
    uint32_t reserved;
    uint32_t (*filter_count)(void);
    const voltet_gradient_filter *(*filter)(uint32_t place);
} voltet_gradient_factory;
typedef struct voltet_array_head {
    uint32_t size;
    uint32_t component_count;
    const char *name;
    uint32_t on_cells;
    uint32_t reserved;
} voltet_array_head;
enum {
    VOLTET_TETRAHEDRA = 1,
    VOLTET_SAME_POINTS = 2,
    VOLTET_SAME_CELLS = 4
};
typedef struct voltet_grid_head {
    uint32_t size;
    uint32_t flags;
    uint64_t point_count;
    uint64_t cell_count;
    uint64_t connectivity_count;
    uint32_t array_count;
    uint32_t step_count;
    const voltet_array_head *arrays;
    const char *scalar;
    const double *times;
    const char *format;
} voltet_grid_head;
typedef struct voltet_grid_buffers {
    uint32_t size;
    uint32_t array_count;
    uint64_t point_count;
    uint64_t cell_count;
    uint64_t connectivity_count;
    double *points;
    uint32_t *tetrahedra;
    uint8_t *types;
    int64_t *offsets;
    uint32_t *connectivity_u32;
    double *const *arrays;
} voltet_grid_buffers;
typedef struct voltet_reading {
    uint32_t size;
    uint32_t reserved;
    const char *path;
    uint64_t step;
    const voltet_values *values;
    int32_t (*describe)(const struct voltet_reading *reading, const voltet_grid_head *head);
    const voltet_grid_buffers *buffers;
    void *context;
} voltet_reading;
typedef struct voltet_reader {
    uint32_t size;
    uint32_t reserved;
    const char *name;
    const char *summary;
    uint32_t parameter_count;
    uint32_t extension_count;
    const voltet_parameter *parameters;
    int32_t (*check)(const voltet_values *values, const voltet_host *host);
    int32_t (*inspect)(const voltet_reading *reading, const voltet_host *host);
    int32_t (*read)(const voltet_reading *reading, const voltet_host *host);
    const char *const *extensions;
    const uint8_t *magic;
    uint32_t magic_length;
    uint32_t reserved_too;
} voltet_reader;
#define VOLTET_READERS "voltet.readers/1"
typedef struct voltet_reader_factory {
    uint32_t size;
    uint32_t reserved;
    uint32_t (*reader_count)(void);
    const voltet_reader *(*reader)(uint32_t place);
} voltet_reader_factory;
typedef struct voltet_given_array {
    uint32_t size;
    uint32_t component_count;
    const char *name;
    const double *values;
} voltet_given_array;
typedef struct voltet_grid_call {
    uint32_t size;
    uint32_t array_count;
    uint64_t point_count;
    uint64_t cell_count;
    const double *points;
    const uint32_t *tetrahedra;
    const voltet_given_array *carried;
    const char *scalar;
    const double *const *arrays;
    const voltet_values *values;
    int32_t (*begin)(const struct voltet_grid_call *call, const voltet_grid_head *head, voltet_grid_buffers *buffers);
    void *context;
} voltet_grid_call;
typedef struct voltet_grid_filter {
    uint32_t size;
    uint32_t reserved;
    const char *name;
    const char *summary;
    uint32_t parameter_count;
    uint32_t made_count;
    const voltet_parameter *parameters;
    int32_t (*check)(const voltet_values *values, const voltet_host *host);
    int32_t (*filter)(const voltet_grid_call *call, const voltet_host *host);
    const char *const *made;
} voltet_grid_filter;
#define VOLTET_GRID_FILTERS "voltet.grid-filters/1"
typedef struct voltet_grid_factory {
    uint32_t size;
    uint32_t reserved;
    uint32_t (*filter_count)(void);
    const voltet_grid_filter *(*filter)(uint32_t place);
} voltet_grid_factory;
typedef struct voltet_image_call {
    uint32_t size;
    uint32_t reserved;
    uint64_t width, height;
    const float *rgba;
    const voltet_values *values;
    float *filtered;
} voltet_image_call;
typedef struct voltet_image_filter {
    uint32_t size;
    uint32_t reserved;
    const char *name;
    const char *summary;
    uint32_t parameter_count;
    uint32_t reserved_too;
    const voltet_parameter *parameters;
    int32_t (*check)(const voltet_values *values, const voltet_host *host);
    int32_t (*filter)(const voltet_image_call *call, const voltet_host *host);
} voltet_image_filter;
#define VOLTET_IMAGE_FILTERS "voltet.image-filters/1"
typedef struct voltet_image_factory {
    uint32_t size;
    uint32_t reserved;
    uint32_t (*filter_count)(void);
    const voltet_image_filter *(*filter)(uint32_t place);
} voltet_image_factory;
typedef struct voltet_plugin {
    uint32_t size;
    uint32_t reserved;
    const char *name;
    const char *version;
} voltet_plugin;
typedef struct voltet_entry {
    uint32_t size;
    uint32_t major, minor, patch;
    const voltet_plugin *(*init)(const char *path, const voltet_host *host);
    void (*deinit)(void);
    const void *(*get_factory)(const char *kind);
} voltet_entry;
extern VOLTET_PLUGIN_EXPORT const voltet_entry voltet_plugin_entry;
#ifdef __cplusplus
}
#endif
#endif
