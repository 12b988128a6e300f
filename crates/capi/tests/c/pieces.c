/* A grid of two tetrahedra in two pieces is drawn as the grid in one: by positions, by global ids, and with the other's cell as a
 * ghost. */
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <voltet.h>

enum { SIDE = 48 };

static double points[] = {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 1, 1};
static double values[] = {0, 0.25, 0.5, 0.75, 1};
static uint32_t tetrahedra[] = {0, 1, 2, 3, 1, 2, 3, 4};
static int64_t ids[] = {10, 11, 12, 13, 14};
static const uint8_t ghosts[2][2] = {{0, 1}, {1, 0}};
static float expected[4 * SIDE * SIDE], found[4 * SIDE * SIDE];
static voltet_array array;

static voltet_grid_source source_of(size_t first, size_t count)
{
    voltet_grid_source source;
    memset(&source, 0, sizeof source);
    source.size = sizeof source;
    source.point_count = 5;
    source.points = points;
    source.array_count = 1;
    source.arrays = &array;
    source.cell_count = count;
    source.tetrahedra = tetrahedra + 4 * first;
    return source;
}

static int draw(voltet_session *session, const voltet_grid_source *source, float *rgba)
{
    static const char *look = "unit_distance = 1.0\n[[widgets]]\nkind = \"gaussian\"\ncolor = [1.0, 0.5, 0.25]\n"
                              "extinction = 3.0\ncentre = [0.5, 0.6]\nsigma = [0.2, 0.2]\n";
    voltet_image image;
    voltet_camera camera;
    voltet_grid *grid;
    int status;
    memset(&camera, 0, sizeof camera);
    camera.size = sizeof camera;
    camera.eye[0] = 2.0;
    camera.eye[1] = -3.0;
    camera.eye[2] = 1.5;
    camera.pixels[0] = camera.pixels[1] = SIDE;
    memset(&image, 0, sizeof image);
    image.size = sizeof image;
    image.width = image.height = SIDE;
    image.rgba = rgba;
    if ((status = voltet_grid_new(session, source, &grid)) != VOLTET_DONE) {
        return status;
    }
    if ((status = voltet_set_grid(session, NULL, grid)) == VOLTET_DONE &&
        (status = voltet_set_node(session, "transfer_function", look)) == VOLTET_DONE &&
        (status = voltet_set(session, "picture.engine=cpu")) == VOLTET_DONE &&
        (status = voltet_set_camera(session, NULL, &camera)) == VOLTET_DONE) {
        status = voltet_render(session, NULL, &image, NULL);
    }
    voltet_grid_release(grid);
    return status;
}

int main(void)
{
    voltet_session *session;
    voltet_grid_source whole = source_of(0, 2);
    int with_ids, with_ghosts, status;
    float sum = 0.0f;
    size_t i;
    array.size = sizeof array;
    array.name = "s";
    array.values = values;
    array.component_count = 1;
    status = voltet_open(&session);
    if (status == VOLTET_DONE) {
        status = draw(session, &whole, expected);
    }
    for (with_ids = 0; with_ids < 2 && status == VOLTET_DONE; with_ids++) {
        for (with_ghosts = 0; with_ghosts < 2 && status == VOLTET_DONE; with_ghosts++) {
            voltet_grid_source pieces[2];
            for (i = 0; i < 2; i++) {
                pieces[i] = source_of(with_ghosts ? 0 : i, with_ghosts ? 2 : 1);
                pieces[i].global_ids = with_ids ? ids : NULL;
                pieces[i].ghost = with_ghosts ? ghosts[i] : NULL;
            }
            pieces[0].further_pieces = &pieces[1];
            pieces[0].further_piece_count = 1;
            status = draw(session, pieces, found);
            for (i = 0; i < 4 * SIDE * SIDE; i++) {
                sum += expected[i];
                if (fabsf(found[i] - expected[i]) > 1e-6f) {
                    printf("channel %lu: %g for %g\n", (unsigned long)i, found[i], expected[i]);
                    return 1;
                }
            }
        }
    }
    if (status != VOLTET_DONE || !(sum > 100.0f)) {
        printf("status %d, %s, sum %g\n", status, voltet_error_text(session), sum);
        return 1;
    }
    voltet_close(session);
    printf("all as it should be\n");
    return 0;
}
