/* The part of Catalyst 2 and of Conduit that the tests and examples use, as a library for machines without Catalyst: a tree of typed
   nodes, and a loader of implementations. */
#define _POSIX_C_SOURCE 200809L
#include "catalyst.h"

#include <dlfcn.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Conduit's numbers of the kinds of nodes. */
enum { EMPTY = 0, OBJECT = 1, LIST = 2, int8_id = 3, int16_id, int32_id, int64_id, uint8_id, uint16_id, uint32_id, uint64_id, float32_id, float64_id, TEXT };

struct stand_in_datatype {
    conduit_index_t id, count, offset, stride, element_bytes, endianness;
};

struct stand_in_node {
    struct stand_in_datatype type;
    char *name;
    char *values;
    int is_own;
    conduit_index_t child_count;
    conduit_node **children;
};

static char *copied(const char *text, size_t length) {
    char *copy = malloc(length + 1);
    memcpy(copy, text, length);
    copy[length] = 0;
    return copy;
}

static conduit_node *added(conduit_node *parent, const char *name, size_t length) {
    conduit_node *child = calloc(1, sizeof *child);
    child->name = copied(name, length);
    parent->child_count++;
    parent->children = realloc(parent->children, (size_t)parent->child_count * sizeof *parent->children);
    parent->children[parent->child_count - 1] = child;
    return child;
}

static conduit_node *child_named(const conduit_node *node, const char *name, size_t length) {
    for (conduit_index_t i = 0; i < node->child_count; i++)
        if (strlen(node->children[i]->name) == length && !memcmp(node->children[i]->name, name, length))
            return node->children[i];
    return NULL;
}

/* The node at a path; made where it is not there and `makes`, else null. */
static conduit_node *at(conduit_node *node, const char *path, int makes) {
    while (*path && node) {
        const char *end = strchr(path, '/');
        size_t length = end ? (size_t)(end - path) : strlen(path);
        conduit_node *child = child_named(node, path, length);
        if (!child && makes) {
            node->type.id = OBJECT;
            child = added(node, path, length);
        }
        node = child;
        path += length + (end != NULL);
    }
    return node;
}

conduit_node *conduit_node_create(void) {
    conduit_node *node = calloc(1, sizeof *node);
    node->name = copied("", 0);
    return node;
}

void conduit_node_destroy(conduit_node *node) {
    for (conduit_index_t i = 0; i < node->child_count; i++)
        conduit_node_destroy(node->children[i]);
    if (node->is_own)
        free(node->values);
    free(node->children);
    free(node->name);
    free(node);
}

conduit_node *conduit_node_fetch(conduit_node *node, const char *path) { return at(node, path, 1); }

conduit_node *conduit_node_append(conduit_node *node) {
    node->type.id = LIST;
    return added(node, "", 0);
}

static void set(conduit_node *node, void *values, int is_own, struct stand_in_datatype type) {
    if (node->is_own)
        free(node->values);
    node->values = values;
    node->is_own = is_own;
    node->type = type;
}

void conduit_node_set_char8_str(conduit_node *node, const char *text) {
    size_t length = strlen(text);
    struct stand_in_datatype type = {TEXT, (conduit_index_t)length + 1, 0, 1, 1, 0};
    set(node, copied(text, length), 1, type);
}

void conduit_node_set_path_char8_str(conduit_node *node, const char *path, const char *text) {
    conduit_node_set_char8_str(at(node, path, 1), text);
}

#define DEFINE(name, type_name)                                                                                       \
    void catalyst_conduit_node_set_path_external_##name##_ptr_detailed(                                               \
        conduit_node *node, const char *path, type_name *values, conduit_index_t count, conduit_index_t offset,       \
        conduit_index_t stride, conduit_index_t element_bytes, conduit_index_t endianness) {                          \
        struct stand_in_datatype type = {name##_id, count, offset, stride, element_bytes, endianness};                \
        set(at(node, path, 1), values, 0, type);                                                                      \
    }                                                                                                                 \
    void catalyst_conduit_node_set_path_external_##name##_ptr(conduit_node *node, const char *path,                   \
                                                              type_name *values, conduit_index_t count) {             \
        catalyst_conduit_node_set_path_external_##name##_ptr_detailed(node, path, values, count, 0,                   \
                                                                      sizeof(type_name), sizeof(type_name), 0);       \
    }                                                                                                                 \
    void catalyst_conduit_node_set_path_##name(conduit_node *node, const char *path, type_name value) {               \
        struct stand_in_datatype type = {name##_id, 1, 0, sizeof value, sizeof value, 0};                             \
        type_name *own = malloc(sizeof value);                                                                        \
        *own = value;                                                                                                 \
        set(at(node, path, 1), own, 1, type);                                                                         \
    }

DEFINE(int8, int8_t)
DEFINE(int16, int16_t)
DEFINE(int32, int32_t)
DEFINE(int64, int64_t)
DEFINE(uint8, uint8_t)
DEFINE(uint16, uint16_t)
DEFINE(uint32, uint32_t)
DEFINE(uint64, uint64_t)
DEFINE(float32, float)
DEFINE(float64, double)

char *conduit_node_as_char8_str(conduit_node *node) { return node->values; }

conduit_index_t conduit_node_number_of_children(conduit_node *node) { return node->child_count; }

conduit_node *conduit_node_child(conduit_node *node, conduit_index_t number) { return node->children[number]; }

int conduit_node_has_path(const conduit_node *node, const char *path) { return at((conduit_node *)node, path, 0) != NULL; }

conduit_node *conduit_node_fetch_existing(conduit_node *node, const char *path) {
    conduit_node *found = at(node, path, 0);
    /* Conduit throws an exception of C++, which no caller in C may meet. */
    if (!found)
        abort();
    return found;
}

char *conduit_node_name(const conduit_node *node) { return copied(node->name, strlen(node->name)); }

const conduit_datatype *conduit_node_dtype(const conduit_node *node) { return &node->type; }

void *conduit_node_element_ptr(conduit_node *node, conduit_index_t number) {
    return node->values ? node->values + node->type.offset + number * node->type.stride : NULL;
}

conduit_index_t conduit_datatype_id(const conduit_datatype *type) { return type->id; }

conduit_index_t conduit_datatype_number_of_elements(const conduit_datatype *type) { return type->count; }

conduit_index_t conduit_datatype_stride(const conduit_datatype *type) { return type->stride; }

conduit_index_t conduit_datatype_element_bytes(const conduit_datatype *type) { return type->element_bytes; }

int conduit_datatype_endianness_matches_machine(const conduit_datatype *type) {
    return type->endianness != CONDUIT_ENDIANNESS_BIG_ID;
}

/* What an implementation exports under the name catalyst_api_impl. */
struct implementation {
    int version;
    enum catalyst_status (*initialize)(const conduit_node *);
    enum catalyst_status (*execute)(const conduit_node *);
    enum catalyst_status (*finalize)(const conduit_node *);
    enum catalyst_status (*about)(conduit_node *);
    enum catalyst_status (*results)(conduit_node *);
};

static const struct implementation *implementation;

static enum catalyst_status load(conduit_node *parameters) {
    conduit_node *name = at(parameters, "catalyst_load/implementation", 0);
    conduit_node *folders = at(parameters, "catalyst_load/search_paths", 0);
    if (!name || !folders)
        return catalyst_status_error_not_found;
    for (conduit_index_t i = 0; i < folders->child_count; i++) {
        char path[4096];
        snprintf(path, sizeof path, "%s/libcatalyst-%s.so", folders->children[i]->values, name->values);
        void *library = dlopen(path, RTLD_LAZY | RTLD_GLOBAL);
        if (!library) {
            printf("failed to open library: %s\n", dlerror());
            continue;
        }
        implementation = dlsym(library, "catalyst_api_impl");
        if (!implementation)
            return catalyst_status_error_not_catalyst;
        if (implementation->version != 1)
            return catalyst_status_error_unsupported_version;
        return catalyst_status_ok;
    }
    return catalyst_status_error_not_found;
}

enum catalyst_status catalyst_initialize(const conduit_node *parameters) {
    enum catalyst_status status = implementation ? catalyst_status_ok : load((conduit_node *)parameters);
    return status == catalyst_status_ok ? implementation->initialize(parameters) : status;
}

enum catalyst_status catalyst_execute(const conduit_node *parameters) {
    return implementation ? implementation->execute(parameters) : catalyst_status_error_no_implementation;
}

enum catalyst_status catalyst_finalize(const conduit_node *parameters) {
    return implementation ? implementation->finalize(parameters) : catalyst_status_error_no_implementation;
}

enum catalyst_status catalyst_about(conduit_node *parameters) {
    return implementation ? implementation->about(parameters) : catalyst_status_error_no_implementation;
}

enum catalyst_status catalyst_results(conduit_node *parameters) {
    return implementation ? implementation->results(parameters) : catalyst_status_error_no_implementation;
}
