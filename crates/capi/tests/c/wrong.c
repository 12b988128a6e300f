/* Wrong uses of voltet.h, each with the status and the words that it is answered with; and what goes on after them. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <voltet.h>

static int failures = 0;

/* A call that is to fail with this status, and a text that has these words. */
static void wrong(int line, const voltet_session *session, int found, int status, const char *words)
{
    const char *text = voltet_error_text(session);
    if (found != status || !strstr(text, words)) {
        printf("line %d: status %d, \"%s\"; expected %d, \"%s\"\n", line, found, text, status, words);
        failures++;
    }
}
/* More than the program takes, bytes. */
#define LARGE ((size_t)1 << 27)
#define WRONG(call, words) wrong(__LINE__, session, (call), VOLTET_WRONG, words)
#define FAILED(call, words) wrong(__LINE__, session, (call), VOLTET_FAILED, words)

static void check(int line, int is_right, const char *what)
{
    if (!is_right) {
        printf("line %d: %s\n", line, what);
        failures++;
    }
}
#define CHECK(what) check(__LINE__, (what), #what)

static double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
static double values[] = {0, 0.25, 0.5, 0.75, 1};
static uint32_t tetrahedra[] = {0, 1, 2, 3, 1, 2, 3, 4};
static int released = 0;
static void release(void *user) { *(int *)user += 1; }

static voltet_array arrays[2];

/* Two tetrahedra. */
static voltet_grid_source two(void)
{
    voltet_grid_source source;
    memset(&source, 0, sizeof source);
    memset(arrays, 0, sizeof arrays);
    arrays[0].size = arrays[1].size = sizeof arrays[0];
    arrays[0].name = "s";
    arrays[0].values = values;
    arrays[0].component_count = 1;
    source.size = sizeof source;
    source.point_count = 5;
    source.points = points;
    source.array_count = 1;
    source.arrays = arrays;
    source.cell_count = 2;
    source.tetrahedra = tetrahedra;
    source.release = release;
    source.user = &released;
    return source;
}

static int make(voltet_session *session, const voltet_grid_source *source)
{
    voltet_grid *grid = (voltet_grid *)1;
    int status = voltet_grid_new(session, source, &grid);
    CHECK((status == VOLTET_DONE) == (grid != NULL));
    voltet_grid_release(grid);
    return status;
}

static void wrong_grids(voltet_session *session)
{
    static const uint8_t types[] = {10, 10}, unknown[] = {10, 99}, polyhedra[] = {10, 42};
    static const int64_t offsets[] = {0, 4, 8}, falling[] = {0, 4, 3}, beyond[] = {0, 4, 9}, negative[] = {-1, 4, 8};
    static const int64_t connectivity[] = {0, 1, 2, 3, 1, 2, 3, 4}, below[] = {0, 1, 2, 3, 1, 2, 3, -4},
                         above[] = {0, 1, 2, 3, 1, 2, 3, 4294967296};
    static const int64_t stream[] = {4, 3, 1, 2, 3, 3, 1, 2, 4, 3, 2, 3, 4, 3, 1, 3, 99999999}, locations[] = {-1, 0},
                         nowhere[] = {-1, 17}, sound[] = {4, 3, 1, 2, 3, 3, 1, 2, 4, 3, 2, 3, 4, 3, 1, 3, 4};
    static const uint32_t missing[] = {0, 1, 2, 3, 1, 2, 3, 5};
    voltet_grid_source source = two();
    struct { voltet_grid_source source; double more; } newer;

    released = 0;
    WRONG(make(session, NULL), "voltet_grid_source is missing: found a null pointer");
    WRONG(voltet_grid_new(session, &source, NULL), "the place of the grid is missing");
    source.size = 0;
    WRONG(make(session, &source), "the size of a voltet_grid_source is wrong: found 0; expected size = sizeof");
    source.size = (size_t)-1;
    WRONG(make(session, &source), "the size of a voltet_grid_source is wrong");
    newer.source = two();
    newer.source.size = sizeof newer.source + sizeof newer.more;
    newer.more = 0.0;
    CHECK(make(session, &newer.source) == VOLTET_DONE);
    CHECK(released == 1);
    newer.more = 1.0;
    WRONG(make(session, &newer.source), "fields that this library does not know");

    source = two(), source.points = NULL;
    WRONG(make(session, &source), "points is missing");
    source = two(), source.points = (const double *)((const char *)points + 1);
    WRONG(make(session, &source), "points are at an odd address");
    source = two(), source.point_count = (size_t)-1;
    WRONG(make(session, &source), "the count of points is out of range");
    source = two(), source.point_count = (size_t)-1 / 24 + 1;
    WRONG(make(session, &source), "the count of points is out of range");
    source = two(), source.cell_count = (size_t)-1 / 16 + 2;
    WRONG(make(session, &source), "the count of tetrahedra is out of range");
    source = two(), source.cell_count = 0;
    FAILED(make(session, &source), "there is nothing to draw");
    source = two(), source.tetrahedra = NULL;
    WRONG(make(session, &source), "neither tetrahedra nor types");
    source = two(), source.types = types;
    WRONG(make(session, &source), "both tetrahedra and types");
    source = two(), source.tetrahedra = missing;
    FAILED(make(session, &source), "cell 1 names a point that does not exist: found 5; expected a point number below 5");
    source = two(), source.subdivision = -1;
    WRONG(make(session, &source), "subdivision is out of range: found -1");
    source = two(), source.subdivision = 65;
    WRONG(make(session, &source), "out of range: found 65");

    source = two(), source.array_count = 0;
    WRONG(make(session, &source), "the grid has no arrays");
    source = two(), source.arrays = NULL;
    WRONG(make(session, &source), "voltet_array is missing");
    source = two(), source.array_count = (size_t)-1;
    WRONG(make(session, &source), "the count of arrays is out of range");
    source = two(), arrays[0].size = 8;
    WRONG(make(session, &source), "the size of a voltet_array is wrong: found 8");
    source = two(), arrays[0].name = NULL;
    WRONG(make(session, &source), "the name of array 0 is missing");
    source = two(), arrays[0].name = "\xff";
    WRONG(make(session, &source), "is no UTF-8: found byte 0");
    source = two(), arrays[0].name = "";
    WRONG(make(session, &source), "array 0 has no name");
    source = two(), arrays[0].component_count = 0;
    WRONG(make(session, &source), "array 0 has no components");
    source = two(), arrays[0].component_count = (size_t)-1 / 4;
    WRONG(make(session, &source), "the count of array 's' is out of range");
    source = two(), arrays[0].values = NULL;
    WRONG(make(session, &source), "array 's' is missing");
    source = two(), source.array_count = 2, arrays[1] = arrays[0];
    WRONG(make(session, &source), "two arrays have the same name: found 's'");
    source = two(), source.array_count = 2, arrays[1] = arrays[0], arrays[1].name = "t";
    WRONG(make(session, &source), "the scalar is not named; expected an array of one component: s, t");
    source = two(), source.scalar = "t";
    WRONG(make(session, &source), "the grid has no such scalar: found 't'; expected an array of one component: s");

    source = two(), source.tetrahedra = NULL, source.types = types;
    WRONG(make(session, &source), "offsets is missing");
    source.offsets = offsets;
    source.connectivity_count = 8;
    WRONG(make(session, &source), "connectivity is missing");
    source.connectivity = connectivity;
    CHECK(make(session, &source) == VOLTET_DONE);
    CHECK(released == 2);
    source.connectivity_u32 = tetrahedra;
    WRONG(make(session, &source), "the connectivity is stated twice");
    source.connectivity_u32 = NULL;
    source.offsets = falling;
    WRONG(make(session, &source), "offsets[2] is wrong: found 3; expected at least 4");
    source.offsets = beyond;
    WRONG(make(session, &source), "offsets[2] is wrong: found 9; expected at most 8");
    source.offsets = negative;
    WRONG(make(session, &source), "offsets[0] is wrong: found -1");
    source.offsets = offsets;
    source.connectivity = below;
    WRONG(make(session, &source), "connectivity[7] is no number of a point: found -4");
    source.connectivity = above;
    WRONG(make(session, &source), "connectivity[7] is no number of a point: found 4294967296");
    source.connectivity = connectivity;
    source.types = unknown;
    FAILED(make(session, &source), "cell 1 has an unknown type: found 99");
    source.types = polyhedra;
    WRONG(make(session, &source), "face_locations is missing");
    source.faces = stream;
    source.faces_count = 16;
    source.face_locations = nowhere;
    WRONG(make(session, &source), "the faces of cell 1, a polyhedron, are damaged");
    source.face_locations = locations;
    WRONG(make(session, &source), "the faces of cell 1, a polyhedron, are damaged");
    source.faces_count = 17;
    FAILED(make(session, &source), "99999999");
    source.faces = sound;
    CHECK(make(session, &source) == VOLTET_DONE);
    CHECK(released == 3);
    source.cell_count = (size_t)-1;
    WRONG(make(session, &source), "out of range");

    values[4] = NAN;
    source = two();
    CHECK(make(session, &source) == VOLTET_DONE);
    values[0] = INFINITY;
    FAILED(make(session, &source), "there is nothing to draw: found 2 tetrahedra (2 not finite)");
    values[0] = 0.0, values[4] = 1.0;
    CHECK(released == 4);
}

static void wrong_pipelines(voltet_session *session)
{
    WRONG(voltet_load(session, NULL), "the path is missing");
    WRONG(voltet_load(session, "no/such/file.toml"), "the pipeline file cannot be read");
    WRONG(voltet_load_text(session, NULL, NULL), "the pipeline is missing");
    WRONG(voltet_load_text(session, "[pipeline]\nformat = 1\n[nodes.a]\ntype = \"reeder\"\n", NULL), "(the pipeline's text:4:8");
    WRONG(voltet_load_text(session, "[pipeline]\nformat = 1\n[nodes", NULL), "is not valid TOML");
    WRONG(voltet_load_text(session, "", NULL), "the file does not state its format");
    WRONG(voltet_set(session, NULL), "the option is missing");
    WRONG(voltet_set(session, "camera.size"), "the option has no '='");
    WRONG(voltet_set(session, "camara.size=[1, 1]"), "there is no node 'camara'; expected 'camera'");
    WRONG(voltet_set(session, "camera.sise=[1, 1]"), "unknown parameter 'sise'");
    WRONG(voltet_set(session, "camera.samples=0"), "samples");
    WRONG(voltet_set(session, "picture.engine=abacus"), "abacus");
    WRONG(voltet_set_node(session, NULL, ""), "the node is missing");
    WRONG(voltet_set_node(session, "camera", NULL), "the parameters is missing");
    WRONG(voltet_set_node(session, "nobody", ""), "there is no node 'nobody'");
    WRONG(voltet_set_node(session, "gradient", "method = \"no-such\""), "(gradient:1:10, node 'gradient'");
    WRONG(voltet_set_node(session, "transfer_function",
                          "unit_distance = 1.0\n[[widgets]]\nkind = \"gaussian\"\nextinction = 1.0\ncentre = [0.5, 0.0]\nsigma = 7\n"),
          "(transfer_function:6:9, node 'transfer_function'");
    WRONG(voltet_set_node(session, "transfer_function", "unit_distance = \n"), "(transfer_function:1:");
    WRONG(voltet_set_node(session, "transfer_function", "type = \"reader\""), "'type' is no parameter");
}

static void wrong_cameras(voltet_session *session)
{
    voltet_camera camera = {0};
    camera.size = sizeof camera;
    camera.eye[1] = -3.0;
    camera.pixels[0] = camera.pixels[1] = 8;
    CHECK(voltet_set_camera(session, NULL, &camera) == VOLTET_DONE);
    WRONG(voltet_set_camera(session, NULL, NULL), "voltet_camera is missing");
    WRONG(voltet_set_camera(session, "grid", &camera), "the node 'grid' gives no camera; expected a node that gives a camera: camera");
    camera.eye[2] = NAN;
    WRONG(voltet_set_camera(session, NULL, &camera), "eye");
    camera.eye[2] = 0.0, camera.eye[1] = 0.0;
    WRONG(voltet_set_camera(session, NULL, &camera), "the same point");
    camera.eye[1] = -3.0, camera.fov_y = 200.0;
    WRONG(voltet_set_camera(session, NULL, &camera), "fov_y");
    camera.fov_y = 20.0, camera.height = 2.0;
    WRONG(voltet_set_camera(session, NULL, &camera), "exclude each other");
    camera.height = 0.0, camera.near_plane = -1.0;
    WRONG(voltet_set_camera(session, NULL, &camera), "near");
    camera.near_plane = 0.0, camera.pixels[0] = 100000;
    WRONG(voltet_set_camera(session, NULL, &camera), "size");
    camera.pixels[0] = 0;
    WRONG(voltet_set_camera(session, NULL, &camera), "size");
    camera.pixels[0] = 8, camera.size = 17;
    WRONG(voltet_set_camera(session, NULL, &camera), "the size of a voltet_camera is wrong: found 17");
}

static int calls = 0;
static voltet_session *called = NULL;
static void progress(void *user, const char *node, const char *stage, double fraction)
{
    (void)user;
    calls += node != NULL && stage != NULL && fraction >= 0.0;
    /* Refused, rather than a second call at a time. */
    CHECK(voltet_set(called, "camera.samples=2") == VOLTET_WRONG);
    CHECK(strstr(voltet_error_text(NULL), "the session is in use") != NULL);
    CHECK(voltet_close(called) == VOLTET_WRONG);
}
static int stop(void *user) { return *(int *)user; }

static void wrong_images(voltet_session *session)
{
    static float pixels[8 * 8 * 4];
    static unsigned char bytes[8 * 32];
    char text[16] = "untouched";
    voltet_grid_source source = two();
    voltet_grid *grid = NULL;
    voltet_image image = {0};
    voltet_follow follow = {0};
    int no = 0, yes = 1, i;
    char *report, *again, *place;
    size_t width = 0, height = 0, length;

    image.size = sizeof image;
    image.width = image.height = 8;
    image.rgba = pixels;
    CHECK(voltet_report(session, text, sizeof text) == (size_t)-1);
    wrong(__LINE__, session, VOLTET_WRONG, VOLTET_WRONG, "nothing has been drawn");
    WRONG(voltet_render(session, NULL, &image, NULL), "the program has given no grid to this node");
    CHECK(voltet_grid_new(session, &source, &grid) == VOLTET_DONE);
    WRONG(voltet_set_grid(session, "camera", grid), "the node 'camera' gives no grid");
    CHECK(voltet_set_grid(session, NULL, grid) == VOLTET_DONE);
    CHECK(voltet_set_node(session, "transfer_function", "unit_distance = 1.0\n[[widgets]]\nkind = \"gaussian\"\n"
                          "color = [1.0, 0.5, 0.2]\nextinction = 1.0\ncentre = [0.5, 0.0]\nsigma = [0.5, 9.0]\n") == VOLTET_DONE);
    CHECK(voltet_set(session, "picture.engine=cpu") == VOLTET_DONE);
    WRONG(voltet_render(session, "file", &image, NULL), "the node 'file' gives no picture; expected a node that gives a picture: picture");
    WRONG(voltet_render(session, NULL, NULL, NULL), "voltet_image is missing");
    image.width = 9;
    WRONG(voltet_render(session, NULL, &image, NULL), "the image has another size than the picture: found 9 × 8; expected 8 × 8");
    image.width = 8, image.rgba_stride = 127;
    WRONG(voltet_render(session, NULL, &image, NULL), "rgba_stride is out of range: found 127 bytes");
    image.rgba_stride = 130;
    WRONG(voltet_render(session, NULL, &image, NULL), "a multiple of 4");
    image.rgba_stride = (size_t)-4;
    WRONG(voltet_render(session, NULL, &image, NULL), "rgba_stride is out of range");
    image.rgba_stride = 0, image.rgba = NULL;
    WRONG(voltet_render(session, NULL, &image, NULL), "the image has no memory");
    image.rgba = (float *)((char *)pixels + 2);
    WRONG(voltet_render(session, NULL, &image, NULL), "rgba is at an odd address");
    image.rgba = pixels, image.background[1] = NAN;
    WRONG(voltet_render(session, NULL, &image, NULL), "the background is not finite");
    image.background[1] = 0.0, image.srgb = bytes, image.srgb_stride = 23;
    WRONG(voltet_render(session, NULL, &image, NULL), "srgb_stride is out of range");
    WRONG(voltet_picture_size(session, NULL, NULL, &height), "the place of the size is missing");
    CHECK(voltet_picture_size(session, NULL, &width, &height) == VOLTET_DONE && width == 8 && height == 8);

    follow.size = sizeof follow;
    follow.cancelled = stop;
    follow.user = &yes;
    image.srgb_stride = 32;
    memset(bytes, 77, sizeof bytes);
    wrong(__LINE__, session, voltet_render(session, NULL, &image, &follow), VOLTET_STOPPED, "the run was stopped");
    for (i = 0; i < 8 * 32; i++) {
        CHECK(bytes[i] == 77);
    }
    follow.user = &no;
    follow.progress = progress;
    called = session;
    CHECK(voltet_render(session, NULL, &image, &follow) == VOLTET_DONE);
    CHECK(calls > 0);
    /* Something is drawn, and nothing between the rows. */
    CHECK(pixels[4 * (8 * 3 + 4) + 3] > 0.1f && pixels[4 * (8 * 3 + 4) + 3] < 1.0f);
    for (i = 0; i < 8; i++) {
        CHECK(bytes[32 * i + 24] == 77 && bytes[32 * i + 31] == 77);
    }

    length = voltet_report(session, NULL, 0);
    CHECK(length > 500 && length < 100000);
    CHECK(voltet_report(session, NULL, 7) == (size_t)-1);
    CHECK(voltet_report(session, text, 6) == length && strlen(text) == 5 && text[0] == '{');
    /* It is that of the picture, also after the process has taken more memory. */
    report = malloc(length + 1);
    CHECK(voltet_report(session, report, length + 1) == length && strlen(report) == length);
    place = malloc(LARGE);
    memset(place, 'x', LARGE - 1);
    place[LARGE - 1] = 0;
    CHECK(strlen(place) == LARGE - 1);
    free(place);
    again = malloc(length + 1);
    CHECK(voltet_report(session, again, length + 1) == length && strcmp(report, again) == 0);
    free(report);
    free(again);
    CHECK(voltet_warnings(session, text, 0) != (size_t)-1);

    /* A moved camera: the grid, its gradient and the transfer function are used again. */
    CHECK(voltet_set(session, "camera.eye=[1.0, -4.0, 0.5]") == VOLTET_DONE);
    CHECK(voltet_render(session, NULL, &image, NULL) == VOLTET_DONE);
    length = voltet_report(session, NULL, 0);
    report = malloc(length + 1);
    CHECK(voltet_report(session, report, length + 1) == length && strlen(report) == length);
    for (i = 0, place = report; (place = strstr(place, "\"reused\": true")) != NULL; i++, place++) {
    }
    CHECK(i == 3);
    free(report);

    /* The session's part of the memory is given back when the grid is taken away, the handle's with its release. */
    released = 0;
    voltet_grid_release(grid);
    CHECK(released == 0);
    CHECK(voltet_set_grid(session, NULL, NULL) == VOLTET_DONE);
    CHECK(released == 1);
    WRONG(voltet_render(session, NULL, &image, NULL), "the program has given no grid to this node");
}

/* What is lent, and what must be copied. */
static void lending(voltet_session *session)
{
    static uint32_t turned[] = {3, 1, 2, 0, 4, 2, 3, 1}, one[] = {0, 1, 2, 3};
    voltet_grid_source source = two();
    voltet_grid_info info = {0};
    voltet_grid *grid;
    info.size = sizeof info;
    CHECK(voltet_grid_new(session, &source, &grid) == VOLTET_DONE);
    CHECK(voltet_grid_about(grid, NULL) == VOLTET_WRONG);
    CHECK(voltet_grid_about(NULL, &info) == VOLTET_WRONG);
    CHECK(voltet_grid_about(grid, &info) == VOLTET_DONE);
    CHECK(info.point_count == 5 && info.tetrahedron_count == 2);
    CHECK(info.bytes_lent == sizeof points + sizeof values + sizeof tetrahedra && info.bytes_copied == 0);
    CHECK(info.low[0] == 0.0 && info.high[2] == 1.0 && info.scalar[0] == 0.0 && info.scalar[1] == 1.0);
    voltet_grid_release(grid);
    source.tetrahedra = turned;
    CHECK(voltet_grid_new(session, &source, &grid) == VOLTET_DONE);
    CHECK(voltet_grid_about(grid, &info) == VOLTET_DONE);
    CHECK(info.bytes_lent == sizeof points + sizeof values && info.bytes_copied == sizeof turned);
    CHECK(turned[0] == 3 && turned[7] == 1);
    voltet_grid_release(grid);
    /* A point that no cell uses is dropped. */
    source.tetrahedra = one;
    source.cell_count = 1;
    CHECK(voltet_grid_new(session, &source, &grid) == VOLTET_DONE);
    CHECK(voltet_grid_about(grid, &info) == VOLTET_DONE);
    CHECK(info.point_count == 4 && info.bytes_lent == sizeof one && info.bytes_copied == 4 * 32);
    voltet_grid_release(grid);
}

int main(void)
{
    voltet_session *session = NULL;
    CHECK(voltet_open(NULL) == VOLTET_WRONG);
    CHECK(strstr(voltet_error_text(NULL), "the place of the session is missing") != NULL);
    CHECK(voltet_set(NULL, "camera.samples=1") == VOLTET_WRONG);
    CHECK(voltet_report(NULL, NULL, 0) == (size_t)-1);
    CHECK(strstr(voltet_error_text(NULL), "the session is missing") != NULL);
    CHECK(voltet_close(NULL) == VOLTET_DONE);
    voltet_grid_release(NULL);
    CHECK(voltet_interface() >= VOLTET_INTERFACE && strchr(voltet_version(), '.') != NULL);
    if (voltet_open(&session) != VOLTET_DONE) {
        return VOLTET_FAILED;
    }
    CHECK(strcmp(voltet_error_text(session), "") == 0);
    wrong_grids(session);
    wrong_pipelines(session);
    wrong_cameras(session);
    wrong_images(session);
    lending(session);
    CHECK(voltet_close(session) == VOLTET_DONE);
    if (failures == 0) {
        printf("all as it should be\n");
    }
    return failures != 0;
}
