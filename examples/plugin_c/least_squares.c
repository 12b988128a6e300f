/*
 * c-least-squares: the linear function through each point that fits its neighbours best, the nearer ones more.
 *
 * The gradient minimises sum over q of w_q^2 (gradient . d_q - delta_q)^2 over the points q that share an edge with p, with
 * d_q = x_q - x_p, delta_q = s_q - s_p and w_q = 1 / |d_q|^power. With power 1 it is the filter least-squares that ships.
 *
 *     cc -std=c99 -O2 -shared -fPIC -I../../include -o least_squares.so least_squares.c -lm
 */
#include "voltet_plugin.h"

#include <math.h>
#include <string.h>

/* Under this pivot of the normal matrix, in parts of its trace, the neighbours lie in a plane. */
#define SMALL 1e-9

/* What all parts of the loop share. */
typedef struct {
    const voltet_call *call;
    const voltet_host *host;
    double power;
    /* By threads: points where the neighbours lie in a plane, and points done. */
    uint64_t flat[256];
    uint64_t done[256];
} work;

/* Solves the symmetric system (xx xy xz; xy yy yz; xz yz zz) g = b by L D L^T; 0 where a pivot is too small. */
static int solve(const double m[6], const double b[3], double *restrict g) {
    const double limit = SMALL * (m[0] + m[3] + m[5]);
    if (!(m[0] > limit)) return 0;
    const double l1 = m[1] / m[0], l2 = m[2] / m[0];
    const double d1 = m[3] - l1 * m[1];
    if (!(d1 > limit)) return 0;
    const double r = m[4] - l1 * m[2], l3 = r / d1;
    const double d2 = m[5] - l2 * m[2] - l3 * r;
    if (!(d2 > limit)) return 0;
    const double y1 = b[1] - l1 * b[0], y2 = b[2] - l2 * b[0] - l3 * y1;
    g[2] = y2 / d2;
    g[1] = y1 / d1 - l3 * g[2];
    g[0] = b[0] / m[0] - l1 * g[1] - l2 * g[2];
    return 1;
}

/* The points from `first` to `end` - 1. */
static void fit(void *user, uint64_t first, uint64_t end, uint32_t thread) {
    work *w = user;
    const voltet_call *c = w->call;
    for (uint64_t p = first; p < end; p++) {
        const double *x = c->points + 3 * p;
        double m[6] = {0}, b[3] = {0};
        for (uint64_t k = c->neighbour_starts[p]; k < c->neighbour_starts[p + 1]; k++) {
            const uint32_t q = c->neighbours[k];
            const double *y = c->points + 3 * (uint64_t)q;
            const double d[3] = {y[0] - x[0], y[1] - x[1], y[2] - x[2]};
            const double square = d[0] * d[0] + d[1] * d[1] + d[2] * d[2];
            if (!(square > 0)) continue;
            const double weight = w->power == 1 ? 1 / square : pow(square, -w->power);
            const double e[3] = {weight * d[0], weight * d[1], weight * d[2]};
            const double delta = c->scalar[q] - c->scalar[p];
            m[0] += e[0] * d[0];
            m[1] += e[0] * d[1];
            m[2] += e[0] * d[2];
            m[3] += e[1] * d[1];
            m[4] += e[1] * d[2];
            m[5] += e[2] * d[2];
            for (int i = 0; i < 3; i++) b[i] += e[i] * delta;
        }
        if (!solve(m, b, c->gradient + 3 * p)) {
            memset(c->gradient + 3 * p, 0, 3 * sizeof(double));
            w->flat[thread]++;
        }
    }
    /* About how much is done: each thread counts its own part. */
    w->done[thread] += end - first;
    w->host->progress(w->host, (double)w->done[thread] * w->host->thread_count / (double)c->point_count);
}

static int32_t gradient(const voltet_call *call, const voltet_host *host) {
    work w = {.call = call, .host = host, .power = call->values->numbers[0]};
    if (host->thread_count > 256) {
        host->error(host, "there are more than 256 threads");
        return VOLTET_ERROR;
    }
    const int32_t code = host->parallel_for(host, call->point_count, 512, fit, &w);
    uint64_t flat = 0;
    for (uint32_t i = 0; i < host->thread_count; i++) flat += w.flat[i];
    host->fallback(host, "set to zero: the neighbours lie in a plane or on a line", flat);
    return code;
}

static const voltet_parameter parameters[] = {{
    .size = sizeof(voltet_parameter),
    .type = VOLTET_NUMBER,
    .name = "power",
    .help = "the power of the distance that a neighbour's weight is divided by; 1 is least-squares",
    .min = 0,
    .max = 4,
    .number = 1,
}};

static const voltet_gradient_filter least_squares = {
    .size = sizeof(voltet_gradient_filter),
    .needs = VOLTET_NEEDS_NEIGHBOURS,
    .name = "c-least-squares",
    .summary = "Linear fit to the neighbouring points, weighted by a power of their distance, in C.",
    .parameter_count = 1,
    .parameters = parameters,
    .gradient = gradient,
};

VOLTET_GRADIENT_PLUGIN("least squares in C", "1.0.0", &least_squares)
