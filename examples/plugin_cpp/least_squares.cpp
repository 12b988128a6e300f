// cpp-least-squares: the linear function through each point that fits its neighbours best, the nearer ones more.
//
// As examples/plugin_c/least_squares.c, which says what it computes; here with exceptions, which must not leave the plug-in.
//
//     c++ -std=c++17 -O2 -shared -fPIC -I../../include -o least_squares.so least_squares.cpp
#include "voltet_plugin.h"

#include <array>
#include <atomic>
#include <cmath>
#include <cstring>
#include <exception>
#include <string>

namespace {

using Vector = std::array<double, 3>;

// Under this pivot of the normal matrix, in parts of its trace, the neighbours lie in a plane.
constexpr double small = 1e-9;

// Runs `work`, and says by the host what it throws.
template <typename Work> std::int32_t guarded(const voltet_host *host, Work work) {
    try {
        return work();
    } catch (const std::exception &error) {
        host->error(host, error.what());
    } catch (...) {
        host->error(host, "an exception of an unknown type");
    }
    return VOLTET_ERROR;
}

// `part(first, end, thread)` on the host's threads. It must not throw.
template <typename Part> std::int32_t parallel_for(const voltet_host *host, std::uint64_t count, Part part) {
    const auto body = [](void *user, std::uint64_t first, std::uint64_t end, std::uint32_t thread) {
        (*static_cast<Part *>(user))(first, end, thread);
    };
    return host->parallel_for(host, count, 512, body, &part);
}

// The gradient at point p; false where the neighbours lie in a plane or on a line.
bool fit(const voltet_call &call, double power, std::uint64_t p, Vector &g) noexcept {
    const double *x = call.points + 3 * p;
    double m[6] = {};
    Vector b = {};
    for (auto k = call.neighbour_starts[p]; k < call.neighbour_starts[p + 1]; k++) {
        const std::uint64_t q = call.neighbours[k];
        const double *y = call.points + 3 * q;
        const Vector d = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
        const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
        if (!(square > 0)) continue;
        const double weight = power == 1 ? 1 / square : std::pow(square, -power);
        const double delta = call.scalar[q] - call.scalar[p];
        for (int i = 0, e = 0; i < 3; i++) {
            for (int j = i; j < 3; j++) m[e++] += weight * d[i] * d[j];
            b[i] += weight * d[i] * delta;
        }
    }
    const double limit = small * (m[0] + m[3] + m[5]);
    if (!(m[0] > limit)) return false;
    const double l1 = m[1] / m[0], l2 = m[2] / m[0], d1 = m[3] - l1 * m[1];
    if (!(d1 > limit)) return false;
    const double r = m[4] - l1 * m[2], l3 = r / d1, d2 = m[5] - l2 * m[2] - l3 * r;
    if (!(d2 > limit)) return false;
    const double y1 = b[1] - l1 * b[0];
    g[2] = (b[2] - l2 * b[0] - l3 * y1) / d2;
    g[1] = y1 / d1 - l3 * g[2];
    g[0] = b[0] / m[0] - l1 * g[1] - l2 * g[2];
    return true;
}

std::int32_t gradient(const voltet_call *call, const voltet_host *host) {
    return guarded(host, [=] {
        const double power = call->values->numbers[0];
        std::atomic<std::uint64_t> flat{0}, done{0};
        const auto code = parallel_for(host, call->point_count, [&](auto first, auto end, auto) noexcept {
            for (auto p = first; p < end; p++) {
                Vector g = {};
                if (!fit(*call, power, p, g)) flat++;
                std::memcpy(call->gradient + 3 * p, g.data(), sizeof g);
            }
            done += end - first;
            host->progress(host, double(done) / double(call->point_count));
        });
        host->fallback(host, "set to zero: the neighbours lie in a plane or on a line", flat);
        return code;
    });
}

const voltet_parameter *parameters() {
    static const voltet_parameter power = [] {
        voltet_parameter power = {};
        power.size = sizeof power;
        power.type = VOLTET_NUMBER;
        power.name = "power";
        power.help = "the power of the distance that a neighbour's weight is divided by; 1 is least-squares";
        power.max = 4;
        power.number = 1;
        return power;
    }();
    return &power;
}

const voltet_gradient_filter least_squares = [] {
    voltet_gradient_filter filter = {};
    filter.size = sizeof filter;
    filter.needs = VOLTET_NEEDS_NEIGHBOURS;
    filter.name = "cpp-least-squares";
    filter.summary = "Linear fit to the neighbouring points, weighted by a power of their distance, in C++.";
    filter.parameter_count = 1;
    filter.parameters = parameters();
    filter.gradient = gradient;
    return filter;
}();

} // namespace

VOLTET_GRADIENT_PLUGIN("least squares in C++", "1.0.0", &least_squares)
