// cpp-cells: the format of examples/plugin_c/reader.c, which says how it is written, read in C++; with exceptions, which must not
// leave the plug-in.
//
//     c++ -std=c++17 -O2 -shared -fPIC -I../../include -o reader.so reader.cpp
#include "voltet_plugin.h"

#include <cmath>
#include <cstring>
#include <exception>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

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

struct Array {
    std::string name;
    std::uint32_t components;
    bool on_cells;
};

// A file whose header was read.
class File {
  public:
    explicit File(const char *path) : stream(path) {
        if (!stream) throw std::runtime_error("the file cannot be opened");
        stream.exceptions(std::ios::failbit | std::ios::badbit);
        try {
            read_header();
        } catch (const std::ios::failure &) {
            throw std::runtime_error("the header is not 'cells 1', points, cells, steps, arrays");
        }
    }

    // The next number of the file.
    template <typename Number> Number next(const char *what) {
        Number number;
        try {
            stream >> number;
        } catch (const std::ios::failure &) {
            throw std::runtime_error(std::string(what) + " is missing");
        }
        return number;
    }

    std::uint64_t points = 0, cells = 0, connectivity = 0;
    std::vector<double> times;
    std::vector<Array> arrays;

  private:
    std::uint32_t count(const char *what, std::uint32_t most) {
        std::uint32_t count;
        stream >> word >> count;
        if (count > most) throw std::runtime_error("there are more than " + std::to_string(most) + " " + what);
        return count;
    }

    void read_header() {
        stream >> word >> word >> word >> points >> word >> cells >> connectivity;
        times.resize(count("steps", 1 << 20));
        for (double &time : times) stream >> time;
        arrays.resize(count("arrays", 4096));
        for (Array &array : arrays) {
            stream >> array.name >> word >> array.components;
            array.on_cells = word == "cells";
        }
    }

    std::ifstream stream;
    std::string word;
};

std::int32_t inspect(const voltet_reading *reading, const voltet_host *host) {
    return guarded(host, [&] {
        const File file(reading->path);
        std::vector<voltet_array_head> heads;
        for (const Array &array : file.arrays)
            heads.push_back({sizeof(voltet_array_head), array.components, array.name.c_str(), array.on_cells, 0});
        voltet_grid_head head = {};
        head.size = sizeof head;
        head.point_count = file.points;
        head.cell_count = file.cells;
        head.connectivity_count = file.connectivity;
        head.array_count = static_cast<std::uint32_t>(heads.size());
        head.arrays = heads.data();
        head.step_count = static_cast<std::uint32_t>(file.times.size());
        head.times = file.times.data();
        head.scalar = heads.empty() ? nullptr : heads[0].name;
        head.format = "simple cells, text";
        return reading->describe(reading, &head);
    });
}

// `count` numbers, times `factor`; passed over where `to` is null.
void read_numbers(File &file, double *to, std::uint64_t count, double factor, const char *what) {
    for (std::uint64_t i = 0; i < count; i++) {
        const double number = file.next<double>(what);
        if (to) to[i] = factor * number;
    }
}

std::int32_t read_cells(File &file, const voltet_grid_buffers *b, const voltet_host *host) {
    std::uint64_t end = 0;
    if (b->offsets) b->offsets[0] = 0;
    for (std::uint64_t cell = 0; cell < file.cells; cell++) {
        const auto type = file.next<unsigned>("a cell");
        const auto count = file.next<std::uint64_t>("a cell");
        if (count > file.connectivity - end) throw std::runtime_error("the cells have more points than the header says");
        for (std::uint64_t k = 0; k < count; k++) {
            const auto point = file.next<std::uint32_t>("a point of a cell");
            if (b->connectivity_u32) b->connectivity_u32[end + k] = point;
        }
        end += count;
        if (b->types) b->types[cell] = static_cast<std::uint8_t>(type);
        if (b->offsets) b->offsets[cell + 1] = static_cast<std::int64_t>(end);
        if (cell % 1024 == 0) {
            host->progress(host, static_cast<double>(cell) / static_cast<double>(file.cells));
            if (host->cancelled(host)) return VOLTET_CANCELLED;
        }
    }
    return VOLTET_OK;
}

std::int32_t read(const voltet_reading *reading, const voltet_host *host) {
    return guarded(host, [&]() -> std::int32_t {
        const voltet_grid_buffers *b = reading->buffers;
        File file(reading->path);
        if (file.points != b->point_count || file.cells != b->cell_count || file.connectivity != b->connectivity_count ||
            file.arrays.size() != b->array_count)
            throw std::runtime_error("the file has changed since it was looked at");
        read_numbers(file, b->points, 3 * file.points, reading->values->numbers[0], "a coordinate");
        if (const std::int32_t code = read_cells(file, b, host)) return code;
        for (std::uint64_t step = 0; step <= reading->step; step++)
            for (std::size_t i = 0; i < file.arrays.size(); i++) {
                const Array &array = file.arrays[i];
                const std::uint64_t count = (array.on_cells ? file.cells : file.points) * array.components;
                read_numbers(file, step == reading->step ? b->arrays[i] : nullptr, count, 1, "a value");
            }
        return VOLTET_OK;
    });
}

const voltet_reader *reader(std::uint32_t place) {
    static const char *const extensions[] = {"cells"};
    static const voltet_parameter scale = [] {
        voltet_parameter scale = {};
        scale.size = sizeof scale;
        scale.type = VOLTET_NUMBER;
        scale.name = "scale";
        scale.help = "the factor on positions";
        scale.flags = VOLTET_EXCLUSIVE_MIN;
        scale.max = INFINITY;
        scale.number = 1;
        return scale;
    }();
    static const voltet_reader cells = [] {
        voltet_reader cells = {};
        cells.size = sizeof cells;
        cells.name = "cpp-cells";
        cells.summary = "Reads a text of points, cells and arrays, with time steps.";
        cells.parameter_count = 1;
        cells.parameters = &scale;
        cells.extension_count = 1;
        cells.extensions = extensions;
        cells.inspect = inspect;
        cells.read = read;
        return cells;
    }();
    return place == 0 ? &cells : nullptr;
}

std::uint32_t reader_count() { return 1; }

const voltet_plugin *init(const char *, const voltet_host *) {
    static const voltet_plugin plugin = {sizeof(voltet_plugin), 0, "simple cells in C++", "1.0.0"};
    return &plugin;
}

const void *get_factory(const char *kind) {
    static const voltet_reader_factory factory = {sizeof(voltet_reader_factory), 0, reader_count, reader};
    return std::strcmp(kind, VOLTET_READERS) == 0 ? &factory : nullptr;
}

} // namespace

const voltet_entry voltet_plugin_entry = {
    sizeof(voltet_entry), VOLTET_PLUGIN_MAJOR, VOLTET_PLUGIN_MINOR, VOLTET_PLUGIN_PATCH, init, nullptr, get_factory};
