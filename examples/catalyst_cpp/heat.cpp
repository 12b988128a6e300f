// Heat conduction in a box, solved step by step, and drawn while it runs: by Catalyst, with voltet as its implementation.
//
//     c++ -O2 heat.cpp -I$CATALYST/include/catalyst-2.0 -L$CATALYST/lib -lcatalyst -o heat
//     ./heat FOLDER scene.toml [STEPS [OPTION]]         FOLDER holds libcatalyst-voltet.so
//
// With MPI, each process solves a slab: mpicxx -DHEAT_MPI …, mpirun -n 4 ./heat …
#include <catalyst.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
#include <vector>

#ifdef HEAT_MPI
#include <mpi.h>
#endif

namespace {

const int side = 16;        // cells along each axis
const int n = side + 1;     // points along each axis
const double width = 1.0 / side;

// A slab of the box between two layers of points; temperatures have a further layer on each side, which the neighbours hold.
struct Slab {
    int first, layers;
    std::vector<double> points;      // x, y, z of each point
    std::vector<std::int64_t> cells; // eight points each
    std::vector<double> temperature, flux;

    int index(int i, int j, int k) const { return i + n * (j + n * k); }

    Slab(int rank, int count) : first(side * rank / count), layers(side * (rank + 1) / count - first + 1) {
        temperature.resize(std::size_t(n) * n * (layers + 2));
        flux.resize(std::size_t(3) * n * n * layers);
        for (int k = 0; k < layers; k++)
            for (int j = 0; j < n; j++)
                for (int i = 0; i < n; i++)
                    points.insert(points.end(), {i * width, j * width, (first + k) * width});
        for (int k = -1; k <= layers; k++)
            for (int j = 0; j < n; j++)
                for (int i = 0; i < n; i++) {
                    double x = i * width - 0.3, y = j * width - 0.4, z = (first + k) * width - 0.5;
                    temperature[index(i, j, k + 1)] = std::exp(-20.0 * (x * x + y * y + z * z));
                }
        for (int k = 0; k + 1 < layers; k++)
            for (int j = 0; j < side; j++)
                for (int i = 0; i < side; i++)
                    for (int top = 0; top < 2; top++)
                        cells.insert(cells.end(), {index(i, j, k + top), index(i + 1, j, k + top),
                                                   index(i + 1, j + 1, k + top), index(i, j + 1, k + top)});
    }

    // One explicit step; the faces of the box keep their temperature.
    void advance() {
        const double r = 0.1; // diffusivity * time step / width²
        std::vector<double> before = temperature;
        for (int k = 0; k < layers; k++) {
            if (first + k == 0 || first + k == side)
                continue;
            for (int j = 1; j < side; j++)
                for (int i = 1; i < side; i++) {
                    auto t = [&](int a, int b, int c) { return before[index(i + a, j + b, k + 1 + c)]; };
                    temperature[index(i, j, k + 1)] = t(0, 0, 0) + r * (t(1, 0, 0) + t(-1, 0, 0) + t(0, 1, 0) + t(0, -1, 0) +
                                                                      t(0, 0, 1) + t(0, 0, -1) - 6.0 * t(0, 0, 0));
                }
        }
    }

    // Heat flux along the axes, by differences to the next point of the layer.
    void find_flux() {
        for (int k = 0; k < layers; k++)
            for (int j = 0; j < n; j++)
                for (int i = 0; i < n; i++) {
                    auto t = [&](int a, int b) { return temperature[index(a, b, k + 1)]; };
                    double *own = &flux[std::size_t(3) * index(i, j, k)];
                    own[0] = i < side ? (t(i, j) - t(i + 1, j)) / width : 0.0;
                    own[1] = j < side ? (t(i, j) - t(i, j + 1)) / width : 0.0;
                    own[2] = 0.0;
                }
    }

    // Takes the layers beside the slab from the neighbours.
    void exchange(int rank, int count) {
#ifdef HEAT_MPI
        int below = rank > 0 ? rank - 1 : MPI_PROC_NULL, above = rank + 1 < count ? rank + 1 : MPI_PROC_NULL;
        double *t = temperature.data();
        MPI_Sendrecv(t + index(0, 0, 2), n * n, MPI_DOUBLE, below, 0, t + index(0, 0, layers + 1), n * n, MPI_DOUBLE, above, 0,
                     MPI_COMM_WORLD, MPI_STATUS_IGNORE);
        MPI_Sendrecv(t + index(0, 0, layers - 1), n * n, MPI_DOUBLE, above, 1, t + index(0, 0, 0), n * n, MPI_DOUBLE, below, 1,
                     MPI_COMM_WORLD, MPI_STATUS_IGNORE);
#else
        (void)rank, (void)count;
#endif
    }
};

// Ends the program where a call of Catalyst failed; the implementation has said why.
void need(enum catalyst_status status, const char *call) {
    if (status != catalyst_status_ok) {
        std::fprintf(stderr, "%s: status %d\n", call, int(status));
        std::exit(1);
    }
}

// The mesh and its fields, as Conduit's Mesh Blueprint describes them; arrays stay where they are.
void describe(conduit_node *mesh, Slab &slab) {
    conduit_index_t count = conduit_index_t(slab.points.size() / 3), bytes = sizeof(double);
    auto vector = [&](const std::string &path, double *values, const char *names[3]) {
        for (int axis = 0; axis < 3; axis++)
            conduit_node_set_path_external_float64_ptr_detailed(mesh, (path + names[axis]).c_str(), values, count, axis * bytes, 3 * bytes,
                                                                bytes, CONDUIT_ENDIANNESS_DEFAULT_ID);
    };
    const char *xyz[] = {"/x", "/y", "/z"}, *uvw[] = {"/u", "/v", "/w"};
    conduit_node_set_path_char8_str(mesh, "coordsets/coords/type", "explicit");
    vector("coordsets/coords/values", slab.points.data(), xyz);
    conduit_node_set_path_char8_str(mesh, "topologies/mesh/type", "unstructured");
    conduit_node_set_path_char8_str(mesh, "topologies/mesh/coordset", "coords");
    conduit_node_set_path_char8_str(mesh, "topologies/mesh/elements/shape", "hex");
    conduit_node_set_path_external_int64_ptr(mesh, "topologies/mesh/elements/connectivity", slab.cells.data(),
                                             conduit_index_t(slab.cells.size()));
    for (const char *name : {"T", "flux"}) {
        std::string field = std::string("fields/") + name;
        conduit_node_set_path_char8_str(mesh, (field + "/association").c_str(), "vertex");
        conduit_node_set_path_char8_str(mesh, (field + "/topology").c_str(), "mesh");
    }
    conduit_node_set_path_external_float64_ptr(mesh, "fields/T/values", slab.temperature.data() + n * n, count);
    vector("fields/flux/values", slab.flux.data(), uvw);
}

} // namespace

int main(int argc, char **argv) {
    if (argc < 3) {
        std::fprintf(stderr, "usage: heat FOLDER scene.toml [STEPS [OPTION]]\n");
        return 2;
    }
    int rank = 0, count = 1, steps = argc > 3 ? std::atoi(argv[3]) : 20;
#ifdef HEAT_MPI
    MPI_Init(&argc, &argv);
    MPI_Comm_rank(MPI_COMM_WORLD, &rank);
    MPI_Comm_size(MPI_COMM_WORLD, &count);
#endif
    Slab slab(rank, count);

    conduit_node *start = conduit_node_create();
    conduit_node_set_path_char8_str(start, "catalyst_load/implementation", "voltet");
    conduit_node_set_path_char8_str(start, "catalyst_load/search_paths/voltet", argv[1]);
    conduit_node_set_path_char8_str(start, "catalyst/scripts/picture/filename", argv[2]);
    conduit_node *options = conduit_node_fetch(start, "catalyst/scripts/picture/args");
    conduit_node_set_char8_str(conduit_node_append(options), "every=10");
    if (argc > 4)
        conduit_node_set_char8_str(conduit_node_append(options), argv[4]);
#ifdef HEAT_MPI
    conduit_node_set_path_int64(start, "catalyst/mpi_comm", MPI_Comm_c2f(MPI_COMM_WORLD));
#endif
    need(catalyst_initialize(start), "catalyst_initialize");
    conduit_node_destroy(start);

    for (int step = 0; step <= steps; step++) {
        slab.find_flux();
        conduit_node *now = conduit_node_create();
        conduit_node_set_path_int64(now, "catalyst/state/timestep", step);
        conduit_node_set_path_float64(now, "catalyst/state/time", 0.1 * step * width * width);
        conduit_node_set_path_char8_str(now, "catalyst/channels/grid/type", "mesh");
        describe(conduit_node_fetch(now, "catalyst/channels/grid/data"), slab);
        need(catalyst_execute(now), "catalyst_execute");
        conduit_node_destroy(now);
        slab.advance();
        slab.exchange(rank, count);
    }

    conduit_node *end = conduit_node_create();
    need(catalyst_finalize(end), "catalyst_finalize");
    conduit_node_destroy(end);
#ifdef HEAT_MPI
    MPI_Finalize();
#endif
    return 0;
}
