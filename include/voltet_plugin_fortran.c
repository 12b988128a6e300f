/*
 * The entry of a plug-in in Fortran: what the standard has no way to write, a constant that holds addresses of functions. It
 * belongs to the module of voltet_plugin.f90; compile both with yours:
 *
 *     gfortran -O2 -shared -fPIC -o filter.so include/voltet_plugin.f90 filter.f90 include/voltet_plugin_fortran.c -Iinclude
 */
#include "voltet_plugin.h"

/* In the module. */
extern const voltet_plugin *voltet_fortran_init(const char *path, const voltet_host *host);
extern void voltet_fortran_deinit(void);
extern const void *voltet_fortran_factory(const char *kind);

const voltet_entry voltet_plugin_entry = {
    sizeof(voltet_entry),   VOLTET_PLUGIN_MAJOR,  VOLTET_PLUGIN_MINOR, VOLTET_PLUGIN_PATCH,
    voltet_fortran_init, voltet_fortran_deinit, voltet_fortran_factory};
