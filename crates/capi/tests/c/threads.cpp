// Sessions in several threads that draw one grid, whose memory is given back once, when all are done with it; and one session that
// several threads try to use at once.
#include <atomic>
#include <cstdio>
#include <cstring>
#include <thread>
#include <vector>
#include <voltet.h>

namespace {

constexpr int SIDE = 6, ACROSS = SIDE + 1, THREADS = 4, PICTURES = 5;
constexpr size_t WIDTH = 48, HEIGHT = 40;

std::atomic<int> failures{0};

void check(bool is_right, int line, const char *what)
{
    if (!is_right) {
        std::printf("line %d: %s\n", line, what);
        failures++;
    }
}
#define CHECK(what) check((what), __LINE__, #what)

struct Box {
    std::vector<double> points, heat;
    std::vector<uint32_t> corners;
    std::vector<int64_t> offsets{0};
    std::vector<uint8_t> types;

    Box()
    {
        for (int n = 0; n < ACROSS * ACROSS * ACROSS; n++) {
            const double p[3] = {n % ACROSS - 3.0, n / ACROSS % ACROSS - 3.0, n / ACROSS / ACROSS - 3.0};
            points.insert(points.end(), p, p + 3);
            heat.push_back(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
        }
        for (int n = 0; n < SIDE * SIDE * SIDE; n++) {
            const uint32_t first = n % SIDE + ACROSS * (n / SIDE % SIDE + ACROSS * (n / SIDE / SIDE));
            for (int corner = 0; corner < 8; corner++) { // VTK's voxel, type 11.
                corners.push_back(first + (corner & 1) + ACROSS * ((corner >> 1 & 1) + ACROSS * (corner >> 2)));
            }
            types.push_back(11);
            offsets.push_back(8 * (n + 1));
        }
    }
};

void release(void *user) { static_cast<std::atomic<int> *>(user)->fetch_add(1); }

voltet_session *open_with(const voltet_grid *grid)
{
    voltet_session *session = nullptr;
    CHECK(voltet_open(&session) == VOLTET_DONE);
    CHECK(voltet_set_node(session, "transfer_function",
                          "unit_distance = 1.0\n[[widgets]]\nkind = \"gaussian\"\ncolor = [1.0, 0.3, 0.1]\nextinction = 3.0\n"
                          "centre = [6.0, 4.0]\nsigma = [2.0, 3.0]\n") == VOLTET_DONE);
    CHECK(voltet_set(session, "picture.engine=cpu") == VOLTET_DONE);
    CHECK(voltet_set_grid(session, nullptr, grid) == VOLTET_DONE);
    return session;
}

void draw(voltet_session *session, int number, std::vector<float> &pixels)
{
    voltet_camera camera{};
    camera.size = sizeof camera;
    camera.eye[0] = 4.0 - number;
    camera.eye[1] = -20.0;
    camera.eye[2] = number;
    camera.pixels[0] = WIDTH;
    camera.pixels[1] = HEIGHT;
    CHECK(voltet_set_camera(session, nullptr, &camera) == VOLTET_DONE);
    voltet_image image{};
    image.size = sizeof image;
    image.width = WIDTH;
    image.height = HEIGHT;
    pixels.assign(4 * WIDTH * HEIGHT, -1.0f);
    image.rgba = pixels.data();
    // Half of them are followed, from a thread of their own.
    voltet_follow follow{};
    follow.size = sizeof follow;
    follow.cancelled = [](void *) { return 0; };
    CHECK(voltet_render(session, nullptr, &image, number % 2 ? &follow : nullptr) == VOLTET_DONE);
}

} // namespace

int main()
{
    Box box;
    std::atomic<int> released{0};
    voltet_array heat{sizeof heat, "heat", box.heat.data(), 1, 0};
    voltet_grid_source source{};
    source.size = sizeof source;
    source.point_count = box.heat.size();
    source.points = box.points.data();
    source.array_count = 1;
    source.arrays = &heat;
    source.cell_count = box.types.size();
    source.types = box.types.data();
    source.offsets = box.offsets.data();
    source.connectivity_u32 = box.corners.data();
    source.connectivity_count = box.corners.size();
    source.release = release;
    source.user = &released;
    voltet_session *maker = nullptr;
    voltet_grid *grid = nullptr;
    CHECK(voltet_open(&maker) == VOLTET_DONE);
    if (voltet_grid_new(maker, &source, &grid) != VOLTET_DONE) {
        std::printf("%s\n", voltet_error_text(maker));
        return 1;
    }

    // What each picture is when nobody else draws.
    std::vector<std::vector<float>> alone(PICTURES);
    voltet_session *session = open_with(grid);
    for (int number = 0; number < PICTURES; number++) {
        draw(session, number, alone[number]);
    }
    CHECK(alone[0] != alone[1]);
    CHECK(voltet_close(session) == VOLTET_DONE);

    std::vector<std::thread> threads;
    for (int thread = 0; thread < THREADS; thread++) {
        threads.emplace_back([&, thread] {
            voltet_session *own = open_with(grid);
            std::vector<float> pixels;
            for (int number = 0; number < PICTURES; number++) {
                const int which = (number + thread) % PICTURES;
                draw(own, which, pixels);
                CHECK(pixels == alone[which]);
                // Errors are each thread's own.
                CHECK(voltet_set(own, "camera.samples=0") == VOLTET_WRONG);
                CHECK(std::strstr(voltet_error_text(own), "samples") != nullptr);
            }
            CHECK(voltet_close(own) == VOLTET_DONE);
        });
    }
    for (auto &thread : threads) {
        thread.join();
    }

    // One session for all: each call is done, or refused.
    std::atomic<int> done{0}, refused{0};
    session = open_with(grid);
    threads.clear();
    for (int thread = 0; thread < THREADS; thread++) {
        threads.emplace_back([&] {
            for (int number = 0; number < 200; number++) {
                const int status = voltet_set(session, "camera.samples=2");
                CHECK(status == VOLTET_DONE || status == VOLTET_WRONG);
                CHECK(status == VOLTET_DONE || std::strstr(voltet_error_text(nullptr), "in use") != nullptr);
                ++(status == VOLTET_DONE ? done : refused);
            }
        });
    }
    for (auto &thread : threads) {
        thread.join();
    }
    CHECK(done > 0 && done + refused == 200 * THREADS);
    CHECK(voltet_close(session) == VOLTET_DONE);

    CHECK(released == 0);
    voltet_grid_release(grid);
    CHECK(released == 1);
    CHECK(voltet_close(maker) == VOLTET_DONE);
    if (failures == 0) {
        std::printf("all as it should be\n");
    }
    return failures != 0;
}
