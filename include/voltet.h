/*
 * voltet.h: volume pictures of unstructured grids, from programs in C, C++, Fortran, or whatever speaks C's calling convention.
 *
 *     cc -std=c99 -O2 program.c $(pkg-config --cflags --libs voltet) -o program
 *
 * A session holds a pipeline: nodes that read or are given a grid, compute its gradient, turn values into colour and extinction,
 * and draw. A new session's pipeline has the nodes
 *
 *     grid                the grid that you give: voltet_set_grid
 *     gradient            gradient-magnitude: method = "least-squares", ...
 *     transfer_function   transfer-function: [[widgets]], unit_distance, model
 *     camera              camera: voltet_set_camera
 *     picture             renderer: engine = "auto", integrator, light, ...
 *
 * voltet_load takes another one from a pipeline file. What parameters a node has, with units, ranges and defaults, is said by
 * `voltet nodes`; the words here are those of pipeline files. What was drawn before is used again as far as it serves: after a
 * moved camera the picture is drawn, and nothing else is done. A whole program: examples/renderer_c/picture.c.
 *
 * Rules that hold throughout
 *
 * - Results. Functions that give an int give one of the statuses below. After any but VOLTET_DONE, voltet_error_text says in one
 *   line what is wrong, what was found, what would be right, and where (of texts and files with line and column). A call that
 *   fails changes nothing: pipeline, images and handles are as they were. No function ends the program, but where memory ends it
 *   may end.
 * - Structs begin with their size in bytes as their maker knows it: `sizeof`. Set all else to 0 first (`= {0}` or memset), which
 *   stands for what is usual. Structs grow at their ends only; a library of another version takes them as long as what it does not
 *   know is 0.
 * - Memory. What you hand over is yours, is only read, and is not needed after the call, but for the arrays of a grid: these are
 *   lent until their release (voltet_grid_source). Handles are the library's; each has its function that takes it back.
 * - Text is UTF-8 and ends with a 0 byte.
 * - Threads. Each session is used by one thread at a time; a call into one that is in use is refused. Sessions in several threads
 *   work side by side, also on the same grid. Every call uses all cores by itself; the environment variable RAYON_NUM_THREADS,
 *   read at the first call of a process, says how many threads that are. Your functions are called by the thread that you called
 *   from, but for `release`. They must return: no exception (C++) and no longjmp may leave them.
 * - Units. Positions and lengths are in the grid's own unit, angles in degrees, colours linear RGB with the primaries of sRGB,
 *   opacities 0 to 1. Point numbers begin at 0.
 */
#ifndef VOLTET_H
#define VOLTET_H

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The version of this interface: it grows where something is added. voltet_interface() is at least this if all of it is there. */
#define VOLTET_INTERFACE 1

/* Statuses. 0 to 2 are also the exit codes of the program `voltet`. */
enum {
    VOLTET_DONE = 0,
    VOLTET_FAILED = 1,  /* The run failed: data are damaged, a file or a device is not there, memory does not suffice. */
    VOLTET_WRONG = 2,   /* The call, a text or a pipeline is wrong. */
    VOLTET_STOPPED = 3, /* Your function `cancelled` said so. */
    VOLTET_PANIC = 4    /* A mistake of the library itself. The session can be used on, and begins with nothing kept. */
};

/* The library's version, such as "0.2.0"; the interface's number. From any thread, at any time. */
const char *voltet_version(void);
uint32_t voltet_interface(void);

/* ---- Sessions -------------------------------------------------------------------------------------------------------------- */

typedef struct voltet_session voltet_session;

/* Opens a session with the pipeline above. On failure *session is null. */
int voltet_open(voltet_session **session);

/* Closes it and forgets all that it keeps; null is allowed. Grids stay. Refused while another call uses it. */
int voltet_close(voltet_session *session);

/* What was wrong with the session's last call that failed; "" if none did. With null: of this thread's last call that failed,
 * such as of voltet_open. Valid until the next call of the session, or with null of the thread. */
const char *voltet_error_text(const voltet_session *session);

/* ---- The pipeline ---------------------------------------------------------------------------------------------------------- */

/* Takes a pipeline file, or a picture that carries its pipeline. Files that it names are relative to its folder. Only
 * what the picture needs will run: writers write nothing. Grids that were set are taken away. */
int voltet_load(voltet_session *session, const char *path);

/* The same from a text. Files that it names are relative to `folder`; null stands for the working directory. */
int voltet_load_text(voltet_session *session, const char *pipeline, const char *folder);

/* Sets one parameter, as `voltet run --set` does: "node.parameter=value", such as "camera.size=[640, 480]" or
 * "transfer_function.widgets.0.extinction=2.5". */
int voltet_set(voltet_session *session, const char *option);

/* Sets all parameters of a node by TOML text, as below [nodes.NAME] in a pipeline file, in place of those that it has. Its type
 * and wires stay. Examples:
 *
 *     voltet_set_node(s, "transfer_function", "unit_distance = 10.0\n"
 *                     "[[widgets]]\nkind = \"gaussian\"\ncentre = [0.5, 0.0]\nsigma = [0.1, 0.2]\nextinction = 8.0\n");
 *     voltet_set_node(s, "gradient", "method = \"quadratic-fit\"");
 *     voltet_set_node(s, "gradient", "method = \"array\"\narray = \"my gradient\"");
 *     voltet_set_node(s, "picture", "engine = \"cpu\"\nintegrator = \"adaptive\"\ntolerance = 1e-4\n"
 *                     "light = { direction = [0.0, 0.0, 1.0], ambient = 0.3, diffuse = 0.7 }");
 */
int voltet_set_node(voltet_session *session, const char *node, const char *parameters);

typedef struct voltet_camera {
    size_t size;        /* sizeof(voltet_camera) */
    double eye[3];      /* Position; may lie inside the grid. */
    double target[3];   /* Appears in the middle of the picture. */
    double up[3];       /* Points up in the picture; any length. All 0: +z. */
    double fov_y;       /* Vertical field of view, degrees, between 0 and 180. 0: 30, unless height is given. */
    double height;      /* Above 0: parallel rays, and this is the height of the picture in the grid's unit. */
    double near_plane;  /* What is nearer along the view direction is cut away; 0 or more. */
    uint32_t pixels[2]; /* Width and height. Both 0: as they are. */
    uint32_t samples;   /* Rays a pixel, 1 to 256. 0: 1. */
} voltet_camera;

/* Sets all parameters of a camera. `node`: its name; null: the only one. */
int voltet_set_camera(voltet_session *session, const char *node, const voltet_camera *camera);

/* ---- Grids ----------------------------------------------------------------------------------------------------------------- */

typedef struct voltet_grid voltet_grid;

/* One array of a grid. */
typedef struct voltet_array {
    size_t size;            /* sizeof(voltet_array); all of a grid's have the same. */
    const char *name;       /* Its name in the pipeline. No two of a grid have the same. */
    const double *values;   /* component_count numbers a point (or cell), those of one side by side. */
    size_t component_count; /* 1 for a scalar, 3 for a gradient, ... */
    int on_cells;           /* 0: a tuple a point; else a tuple a cell, which the points get the average of (constant_cells). */
} voltet_array;

/*
 * Points, cells and arrays in your memory.
 *
 * `points` and the arrays on points are not copied, and neither are `tetrahedra` whose numbers ascend within every cell: they are
 * lent, and must stay where and as they are until the release. The exceptions: points that no drawn cell uses are dropped, and
 * cells of curved types and some polyhedra add points; then points and arrays are copied. voltet_grid_about says what was.
 *
 * Cells are either tetrahedra, four numbers each in any order; or of any types of VTK (vtkCellType.h), of which those of three
 * dimensions are drawn: types, offsets and connectivity, with VTK's order of points. Cells that touch a position or a value that is
 * not finite are left out, and a warning of the picture counts them; so hand over no array that you do not draw by.
 */
typedef struct voltet_grid_source {
    size_t size; /* sizeof(voltet_grid_source) */

    size_t point_count;
    const double *points; /* x, y, z of each. */

    size_t array_count;
    const voltet_array *arrays;
    const char *scalar; /* The name of the array that is drawn; null: the only one of one component. */

    size_t cell_count;
    const uint32_t *tetrahedra; /* 4 numbers a cell, or null. */

    const uint8_t *types;             /* VTK's code of each cell, or null. */
    const int64_t *offsets;           /* cell_count + 1: cell i has connectivity[offsets[i]] to [offsets[i + 1] - 1]. */
    const int64_t *connectivity;      /* Point numbers; or null and */
    const uint32_t *connectivity_u32; /* the same in 32 bits. */
    size_t connectivity_count;

    const int64_t *faces;          /* Of cells of type 42 (polyhedra): the number of faces, then each face's count and points. */
    const int64_t *face_locations; /* A number a cell: where in faces its own begin; not looked at for other types. */
    size_t faces_count;

    const uint8_t *degrees; /* Of Lagrange and Bezier cells: 3 a cell, along its axes; null: the same along all. */
    const uint8_t *ghost;   /* vtkGhostType of each cell, or null: 1 a ghost of another piece, which serves gradients and means of
                             * arrays on cells and is not drawn; 8 or 32 left out. */

    int subdivision;    /* Pieces along each stretch of a curved cell's edge, 1 to 64; 0: 1. */
    int constant_cells; /* Not 0: arrays on cells are constant in each cell, with jumps between them. */

    /* Called once, when nobody needs the memory any more: after voltet_grid_release, and after every session has drawn another
     * grid in its place, has had it taken away, or was closed. Not called where voltet_grid_new fails. It is called within a call
     * of yours, maybe by another thread, and must not call the library. May be null. */
    void (*release)(void *user);
    void *user; /* Handed to release. */

    /* A grid in pieces: points of different pieces are one where their global ids are equal, or without ids at equal positions with
     * equal values of the arrays that a picture requests (voltet_grid_info: of all arrays); ghost cells of which a piece has the
     * original are left out. All pieces have the same arrays. Of the further ones scalar, subdivision, constant_cells, release and
     * further_pieces are not looked at. */
    const int64_t *global_ids; /* A number a point, or null. */
    const struct voltet_grid_source *further_pieces;
    size_t further_piece_count;
} voltet_grid_source;

/* Makes a grid. The session only carries the error; the grid belongs to no session. On failure *grid is null. */
int voltet_grid_new(voltet_session *session, const voltet_grid_source *source, voltet_grid **grid);

/* What is known of a grid. */
typedef struct voltet_grid_info {
    size_t size; /* sizeof(voltet_grid_info), set by you. */
    uint64_t point_count;       /* Points that cells use. */
    uint64_t tetrahedron_count; /* Tetrahedra that are drawn. */
    uint64_t bytes_lent;        /* Of points, tetrahedra and arrays: what is your memory, */
    uint64_t bytes_copied;      /* and what is the library's. */
    double low[3], high[3];     /* Bounds of the points. */
    double scalar[2];           /* Least and largest value of the scalar. */
} voltet_grid_info;

/* Fills *info. From any thread, also while the grid is drawn. */
int voltet_grid_about(const voltet_grid *grid, voltet_grid_info *info);

/* Gives a grid back. Sessions that draw it go on with it; its memory is released when the last of them is done with it. Null is
 * allowed. */
void voltet_grid_release(voltet_grid *grid);

/* Puts a grid in place of what a node reads: in the standard pipeline of nothing, in others of a file, which is not opened then. The
 * scalar is the grid's, or the array that the node's parameter `scalar` names. `node`: its name; null: the only one. A null grid
 * takes the grid away. What was kept of a former grid is forgotten. */
int voltet_set_grid(voltet_session *session, const char *node, const voltet_grid *grid);

/* ---- Pictures -------------------------------------------------------------------------------------------------------------- */

/* Where a picture goes. Row 0 is the top one. */
typedef struct voltet_image {
    size_t size;          /* sizeof(voltet_image) */
    size_t width, height; /* Of the picture: see voltet_picture_size. */
    float *rgba;          /* Premultiplied linear RGBA, 4 floats a pixel; or null. */
    size_t rgba_stride;   /* Bytes from row to row, a multiple of 4; 0: 16 * width. */
    uint8_t *srgb;        /* 8-bit sRGB over the background, 3 bytes a pixel; or null. */
    size_t srgb_stride;   /* Bytes from row to row; 0: 3 * width. */
    double background[3]; /* Linear RGB. */
} voltet_image;

/* How a picture is followed. The functions are called about 50 times a second, first before anything is done. Either may be
 * null. They must not call into the session. */
typedef struct voltet_follow {
    size_t size; /* sizeof(voltet_follow) */
    void *user;  /* Handed to both. */
    /* A stage of a node is `fraction` (0 to 1) done. The texts are valid during the call. */
    void (*progress)(void *user, const char *node, const char *stage, double fraction);
    /* Not 0: stop. The call then ends soon, with VOLTET_STOPPED. */
    int (*cancelled)(void *user);
} voltet_follow;

/* The size of a picture in pixels, as its camera says. `node`: which; null: the only one. */
int voltet_picture_size(voltet_session *session, const char *node, size_t *width, size_t *height);

/* Draws a picture. `node`: the name of the node that draws; null: the only one. `follow` may be null. */
int voltet_render(voltet_session *session, const char *node, const voltet_image *image, const voltet_follow *follow);

/* ---- What was done --------------------------------------------------------------------------------------------------------- */

/* The report of the last picture as JSON: seconds a node and stage, counts, what was left out and why, the engine. As snprintf does,
 * at most `size` bytes are written, the last of them 0, and the length of the whole text is given, without the 0; `buffer` may be
 * null where `size` is 0. (size_t)-1: failed, see voltet_error_text. */
size_t voltet_report(voltet_session *session, char *buffer, size_t size);

/* The warnings of the last picture, a line each, in the same manner; length 0 where there are none. */
size_t voltet_warnings(voltet_session *session, char *buffer, size_t size);

#ifdef __cplusplus
}
#endif

#endif /* VOLTET_H */
