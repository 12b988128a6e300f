/*
 * Pictures of a grid that lives in this program's memory, and of a pipeline file, by voltet.h.
 *
 *     cc -std=c99 -O2 picture.c $(pkg-config --cflags --libs voltet) -lm -o picture
 *     ./picture own own.ppm                   # a grid of its own, made below
 *     ./picture file scene.toml scene.ppm     # a pipeline file, with its data
 *
 * With a further argument, FILE.rgba, the picture is also written there as it is: 32-bit floats.
 */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <voltet.h>

/* Hexahedra along each side of the box. */
enum { SIDE = 12, POINTS = (SIDE + 1) * (SIDE + 1) * (SIDE + 1), CELLS = SIDE * SIDE * SIDE };

/* A box of hexahedra around the origin, with a ball of heat: what a solver would hold. */
static double points[3 * POINTS];
static double heat[POINTS];
static int64_t corners[8 * CELLS];
static int64_t offsets[CELLS + 1];
static uint8_t types[CELLS];

static int64_t point(int i, int j, int k) { return i + (SIDE + 1) * (j + (int64_t)(SIDE + 1) * k); }

static void solve(void)
{
    int i, j, k, corner, cell = 0;
    for (k = 0; k <= SIDE; k++) {
        for (j = 0; j <= SIDE; j++) {
            for (i = 0; i <= SIDE; i++) {
                double *p = points + 3 * point(i, j, k);
                p[0] = 2.0 * i / SIDE - 1.0;
                p[1] = 2.0 * j / SIDE - 1.0;
                p[2] = 2.0 * k / SIDE - 1.0;
                heat[point(i, j, k)] = 1.0 - sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
            }
        }
    }
    for (k = 0; k < SIDE; k++) {
        for (j = 0; j < SIDE; j++) {
            for (i = 0; i < SIDE; i++, cell++) {
                /* VTK's hexahedron: around the lower face, then around the upper one. */
                static const int step[8][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0},
                                               {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};
                for (corner = 0; corner < 8; corner++) {
                    const int *s = step[corner];
                    corners[8 * cell + corner] = point(i + s[0], j + s[1], k + s[2]);
                }
                types[cell] = 12;
                offsets[cell + 1] = 8 * (cell + 1);
            }
        }
    }
}

/* Two shells by s alone, and one that looks at the gradient, too. */
static const char *look = "unit_distance = 1.0\n"
                          "[[widgets]]\n"
                          "kind = \"gaussian\"\n"
                          "color = [1.0, 0.4, 0.05]\n"
                          "extinction = 40.0\n"
                          "centre = [0.6, 1.0]\n"
                          "sigma = [0.05, 0.2]\n"
                          "[[widgets]]\n"
                          "kind = \"gaussian\"\n"
                          "color = [0.1, 0.3, 1.0]\n"
                          "extinction = 6.0\n"
                          "centre = [0.2, 1.0]\n"
                          "sigma = [0.05, 0.5]\n";

/* Ends the program where something failed, with what the library says of it. */
static void need(voltet_session *session, int status)
{
    if (status != VOLTET_DONE) {
        fprintf(stderr, "error: %s\n", voltet_error_text(session));
        exit(status);
    }
}

static void released(void *user) { *(int *)user = 1; }

/* The scene of the program's own grid. */
static voltet_grid *own_scene(voltet_session *session, int *is_released)
{
    voltet_array array = {sizeof array, "heat", heat, 1, 0};
    voltet_camera camera = {0};
    voltet_grid_source source = {0};
    voltet_grid *grid;

    solve();
    source.size = sizeof source;
    source.point_count = POINTS;
    source.points = points;
    source.array_count = 1;
    source.arrays = &array;
    source.cell_count = CELLS;
    source.types = types;
    source.offsets = offsets;
    source.connectivity = corners;
    source.connectivity_count = 8 * CELLS;
    source.release = released;
    source.user = is_released;
    need(session, voltet_grid_new(session, &source, &grid));
    need(session, voltet_set_grid(session, NULL, grid));
    need(session, voltet_set_node(session, "transfer_function", look));
    /* Without this line a graphics device draws, where there is one. */
    need(session, voltet_set(session, "picture.engine=cpu"));

    camera.size = sizeof camera;
    camera.eye[0] = 2.0;
    camera.eye[1] = -4.0;
    camera.eye[2] = 1.5;
    camera.pixels[0] = 160;
    camera.pixels[1] = 120;
    need(session, voltet_set_camera(session, NULL, &camera));
    return grid;
}

/* Draws, and writes the picture. */
static void write_picture(voltet_session *session, const char *ppm, const char *rgba)
{
    voltet_image image = {0};
    FILE *file;
    need(session, voltet_picture_size(session, NULL, &image.width, &image.height));
    image.size = sizeof image;
    image.rgba = malloc(16 * image.width * image.height);
    image.srgb = malloc(3 * image.width * image.height);
    if (!image.rgba || !image.srgb) {
        exit(VOLTET_FAILED);
    }
    need(session, voltet_render(session, NULL, &image, NULL));
    file = fopen(ppm, "wb");
    if (!file || fprintf(file, "P6\n%lu %lu\n255\n", (unsigned long)image.width, (unsigned long)image.height) < 0 ||
        fwrite(image.srgb, 3 * image.width, image.height, file) != image.height || fclose(file) != 0) {
        perror(ppm);
        exit(VOLTET_FAILED);
    }
    if (rgba) {
        file = fopen(rgba, "wb");
        if (!file || fwrite(image.rgba, 16 * image.width, image.height, file) != image.height || fclose(file) != 0) {
            perror(rgba);
            exit(VOLTET_FAILED);
        }
    }
    free(image.rgba);
    free(image.srgb);
}

/* Says what the library warns of. */
static void write_warnings(voltet_session *session)
{
    size_t length = voltet_warnings(session, NULL, 0);
    char *text = malloc(length + 1);
    if (text && length > 0) {
        voltet_warnings(session, text, length + 1);
        fprintf(stderr, "%s\n", text);
    }
    free(text);
}

int main(int count, char **words)
{
    int own = count >= 3 && strcmp(words[1], "own") == 0;
    int file = count >= 4 && strcmp(words[1], "file") == 0;
    int is_released = 0;
    voltet_session *session;
    voltet_grid *grid = NULL;
    if (!own && !file) {
        fprintf(stderr, "usage: picture own PICTURE.ppm [FILE.rgba]\n       picture file SCENE.toml PICTURE.ppm [FILE.rgba]\n");
        return VOLTET_WRONG;
    }
    need(NULL, voltet_open(&session));
    if (own) {
        grid = own_scene(session, &is_released);
        write_picture(session, words[2], count > 3 ? words[3] : NULL);
    } else {
        need(session, voltet_load(session, words[2]));
        write_picture(session, words[3], count > 4 ? words[4] : NULL);
    }
    write_warnings(session);
    voltet_grid_release(grid);
    need(NULL, voltet_close(session));
    if (own && !is_released) {
        fprintf(stderr, "the arrays are still lent\n");
        return VOLTET_FAILED;
    }
    return VOLTET_DONE;
}
