/* Declarations of Catalyst 2 and of Conduit's C interface that the tests and examples use, for machines without Catalyst. The real
   header is `catalyst.h` of https://gitlab.kitware.com/paraview/catalyst; stand_in.c defines these. */
#ifndef VOLTET_STAND_IN_CATALYST_H
#define VOLTET_STAND_IN_CATALYST_H

#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Catalyst exports the functions of its Conduit under names of its own. */
#define CONDUIT(name) catalyst_conduit_##name
#define conduit_node_create CONDUIT(node_create)
#define conduit_node_destroy CONDUIT(node_destroy)
#define conduit_node_fetch CONDUIT(node_fetch)
#define conduit_node_append CONDUIT(node_append)
#define conduit_node_set_char8_str CONDUIT(node_set_char8_str)
#define conduit_node_set_path_char8_str CONDUIT(node_set_path_char8_str)
#define conduit_node_set_path_int32 CONDUIT(node_set_path_int32)
#define conduit_node_set_path_int64 CONDUIT(node_set_path_int64)
#define conduit_node_set_path_float64 CONDUIT(node_set_path_float64)
#define conduit_node_as_char8_str CONDUIT(node_as_char8_str)
#define conduit_node_number_of_children CONDUIT(node_number_of_children)
#define conduit_node_child CONDUIT(node_child)
#define conduit_node_has_path CONDUIT(node_has_path)
#define conduit_node_fetch_existing CONDUIT(node_fetch_existing)
#define conduit_node_name CONDUIT(node_name)
#define conduit_node_dtype CONDUIT(node_dtype)
#define conduit_node_element_ptr CONDUIT(node_element_ptr)
#define conduit_datatype_id CONDUIT(datatype_id)
#define conduit_datatype_number_of_elements CONDUIT(datatype_number_of_elements)
#define conduit_datatype_stride CONDUIT(datatype_stride)
#define conduit_datatype_element_bytes CONDUIT(datatype_element_bytes)
#define conduit_datatype_endianness_matches_machine CONDUIT(datatype_endianness_matches_machine)

typedef int64_t conduit_index_t;
typedef struct stand_in_node conduit_node;
typedef struct stand_in_datatype conduit_datatype;

conduit_node *conduit_node_create(void);
void conduit_node_destroy(conduit_node *node);
conduit_node *conduit_node_fetch(conduit_node *node, const char *path);
conduit_node *conduit_node_append(conduit_node *node);
void conduit_node_set_char8_str(conduit_node *node, const char *text);
void conduit_node_set_path_char8_str(conduit_node *node, const char *path, const char *text);
char *conduit_node_as_char8_str(conduit_node *node);
conduit_index_t conduit_node_number_of_children(conduit_node *node);
conduit_node *conduit_node_child(conduit_node *node, conduit_index_t number);
int conduit_node_has_path(const conduit_node *node, const char *path);
conduit_node *conduit_node_fetch_existing(conduit_node *node, const char *path);
char *conduit_node_name(const conduit_node *node);
const conduit_datatype *conduit_node_dtype(const conduit_node *node);
void *conduit_node_element_ptr(conduit_node *node, conduit_index_t number);
conduit_index_t conduit_datatype_id(const conduit_datatype *type);
conduit_index_t conduit_datatype_number_of_elements(const conduit_datatype *type);
conduit_index_t conduit_datatype_stride(const conduit_datatype *type);
conduit_index_t conduit_datatype_element_bytes(const conduit_datatype *type);
int conduit_datatype_endianness_matches_machine(const conduit_datatype *type);

/* Numbers of one type: a copy of one, and arrays of the caller's, with bytes before the first and from one to the next. */
#define STAND_IN_TYPE(name, type)                                                                                    \
    void catalyst_conduit_node_set_path_##name(conduit_node *node, const char *path, type value);                    \
    void catalyst_conduit_node_set_path_external_##name##_ptr(conduit_node *node, const char *path, type *values,    \
                                                              conduit_index_t count);                                \
    void catalyst_conduit_node_set_path_external_##name##_ptr_detailed(                                              \
        conduit_node *node, const char *path, type *values, conduit_index_t count, conduit_index_t offset,           \
        conduit_index_t stride, conduit_index_t element_bytes, conduit_index_t endianness);

STAND_IN_TYPE(int8, int8_t)
STAND_IN_TYPE(int16, int16_t)
STAND_IN_TYPE(int32, int32_t)
STAND_IN_TYPE(int64, int64_t)
STAND_IN_TYPE(uint8, uint8_t)
STAND_IN_TYPE(uint16, uint16_t)
STAND_IN_TYPE(uint32, uint32_t)
STAND_IN_TYPE(uint64, uint64_t)
STAND_IN_TYPE(float32, float)
STAND_IN_TYPE(float64, double)

#define conduit_node_set_path_external_int32_ptr CONDUIT(node_set_path_external_int32_ptr)
#define conduit_node_set_path_external_int64_ptr CONDUIT(node_set_path_external_int64_ptr)
#define conduit_node_set_path_external_float64_ptr CONDUIT(node_set_path_external_float64_ptr)
#define conduit_node_set_path_external_float64_ptr_detailed CONDUIT(node_set_path_external_float64_ptr_detailed)

enum { CONDUIT_ENDIANNESS_DEFAULT_ID = 0, CONDUIT_ENDIANNESS_BIG_ID = 1 };

enum catalyst_status {
    catalyst_status_ok = 0,
    catalyst_status_error_no_implementation,
    catalyst_status_error_already_loaded,
    catalyst_status_error_not_found,
    catalyst_status_error_not_catalyst,
    catalyst_status_error_incomplete,
    catalyst_status_error_unsupported_version
};

enum catalyst_status catalyst_initialize(const conduit_node *parameters);
enum catalyst_status catalyst_execute(const conduit_node *parameters);
enum catalyst_status catalyst_finalize(const conduit_node *parameters);
enum catalyst_status catalyst_about(conduit_node *parameters);
enum catalyst_status catalyst_results(conduit_node *parameters);

#ifdef __cplusplus
}
#endif

#endif
