// A plug-in that lets exceptions leave it: from its filter (WHERE 1), from the body of a loop (2), from init (3). Or it ends the
// program (4).
#include "voltet_plugin.h"

#include <cstdlib>
#include <stdexcept>

#ifndef WHERE
#define WHERE 1
#endif

static void throws(int where) {
    if (where == WHERE) throw std::runtime_error("nobody caught this");
}

static std::int32_t gradient(const voltet_call *call, const voltet_host *host) {
    throws(1);
    if (WHERE == 4) std::exit(0);
    return host->parallel_for(host, call->point_count, 1, [](void *, std::uint64_t, std::uint64_t, std::uint32_t) { throws(2); },
                              nullptr);
}

static const voltet_gradient_filter throwing = {
    sizeof(voltet_gradient_filter), 0, "throwing", "Throws.", 0, 0, nullptr, nullptr, gradient};

static std::uint32_t filter_count() { return 1; }

static const voltet_gradient_filter *filter(std::uint32_t) { return &throwing; }

static const voltet_gradient_factory factory = {sizeof(voltet_gradient_factory), 0, filter_count, filter};

static const voltet_plugin *init(const char *, const voltet_host *) {
    throws(3);
    static const voltet_plugin plugin = {sizeof(voltet_plugin), 0, "throwing", "0.1"};
    return &plugin;
}

static const void *get_factory(const char *) { return &factory; }

const voltet_entry voltet_plugin_entry = {
    sizeof(voltet_entry), VOLTET_PLUGIN_MAJOR, VOLTET_PLUGIN_MINOR, VOLTET_PLUGIN_PATCH, init, nullptr, get_factory};
