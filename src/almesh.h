/* almesh for C, and for every language that calls C: a mesh follows its boundary, and no element is ever inverted.
 *
 *     almesh_mesh *mesh;
 *     if (almesh_read("wing.msh", &mesh)) return fail(almesh_error());
 *     almesh_set_boundary(mesh, "wall", "rotate 10 about 0.25 0");       // a motion, as in a deck
 *     almesh_set_boundary(mesh, "rest", "fixed");
 *     if (almesh_move(mesh)) fail(almesh_error());                        // certified valid and injective, or why not
 *     const double *x = almesh_positions(mesh);                           // nodes x dim
 *     almesh_save(mesh, "moved.msh");
 *     almesh_free(mesh);
 *
 * The same input gives the same bits as the program `almesh`, whose settings, motions, quantities and sentences these
 * are: `almesh --keys` lists them, and so do almesh_key() and almesh_quantity().
 *
 * Arrays. Coordinate a of node i is at [dim * i + a]. Nodes, elements and faces are counted from 0, nodes of a cell are
 * in the order of Gmsh (vertices, then those of edges, faces, inside). Nodes and elements are in ascending order of
 * their ids in the file, or in the order of the arrays; nodes that the file does not have (keys degree, refine, split)
 * come after those. The unit of length is the caller's. Texts are UTF-8; paths start in the current folder.
 *
 * Errors. Functions that can fail return one of almesh_code; almesh_error() then has the sentence that says what, where
 * and what to do. Functions that return a pointer return NULL instead, and almesh_error_code() has the code. Wrong use
 * (a null, freed or busy mesh, a call out of order, sizes that do not fit, numbers that are not finite) is such an
 * error and changes nothing. Nothing is printed, no file is written but by almesh_save() (and invalid.csv, where the
 * key `output` names a folder), no signal is caught, and the program is never ended, unless memory ends inside a loop
 * on several threads.
 *
 * Pointers that a function returns belong to the mesh. Numbers live until the next almesh_move(), almesh_frame(),
 * almesh_improve(), almesh_adjoint(), almesh_tangent() or almesh_free() of this mesh; texts until the next call for it.
 *
 * Threads. Meshes are independent of each other, and may be used by several threads at a time; one mesh is used by one
 * thread at a time, and a call for it by another one is refused as ALMESH_BUSY. A call computes on the threads that the
 * key `threads` says, else on those of OpenMP (OMP_NUM_THREADS), with the same bits for any number of them.
 */
#ifndef ALMESH_H
#define ALMESH_H

#include <stddef.h>

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define ALMESH_API __attribute__((visibility("default")))
#else
#define ALMESH_API
#endif

/* A mesh with its settings and, after a run, its results. */
typedef struct almesh_mesh almesh_mesh;

/* 0 to 5 are the exit codes of the program. */
typedef enum almesh_code {
    ALMESH_OK = 0,
    ALMESH_USAGE = 1,         /* a setting, a name, a size or a number is wrong */
    ALMESH_INPUT = 2,         /* a file, a mesh or a target is wrong */
    ALMESH_NOT_CONVERGED = 3, /* the mesh that the run ended with is there; its status says why it ended */
    ALMESH_NOT_CERTIFIED = 4, /* the mesh is there, but is not certified valid and injective */
    ALMESH_EXPECTATION = 5,   /* the mesh is there and certified, but a line `expect` of the deck does not hold */
    ALMESH_CANCELLED = 16,    /* by the callback; the last valid mesh is there */
    ALMESH_HANDLE = 17,       /* a mesh that is null, freed, or was never made */
    ALMESH_BUSY = 18,         /* another call for the mesh has not returned */
    ALMESH_ORDER = 19,        /* results are asked for that no run has made */
    ALMESH_MEMORY = 20,       /* not enough of it */
    ALMESH_INTERNAL = 21      /* an error of the library: please report it */
} almesh_code;

typedef enum almesh_cell {
    ALMESH_LINE = 0,
    ALMESH_TRIANGLE = 1,
    ALMESH_QUADRILATERAL = 2,
    ALMESH_TETRAHEDRON = 3,
    ALMESH_HEXAHEDRON = 4,
    ALMESH_PRISM = 5,
    ALMESH_PYRAMID = 6
} almesh_cell;

/* Cells of one type, given. */
typedef struct almesh_block {
    int type;          /* of almesh_cell */
    int count;         /* of cells, >= 0 */
    const int *nodes;  /* count x nodes of a cell of the degree, each in 0 ... nodes - 1 */
    const char *group; /* of faces: the name of their boundary; of elements: of their volume, or NULL for none */
} almesh_block;

/* Cells of any type, of a mesh: cell k has the nodes node[offset[k]] ... node[offset[k + 1] - 1]. */
typedef struct almesh_cells {
    int count;
    const int *type;   /* count, each of almesh_cell */
    const int *offset; /* count + 1, the first is 0 */
    const int *node;   /* offset[count], each in 0 ... nodes - 1 */
} almesh_cells;

typedef struct almesh_sizes {
    int dim;        /* 2 or 3 */
    int degree;     /* of the elements, 1 to 7 */
    int nodes;      /* those of no element included, which do not move */
    int elements;
    int boundaries; /* named sets of outer faces, and inner ones that are a boundary; a set of two names is "a + b" */
    int volumes;    /* named groups of elements */
} almesh_sizes;

/* ---- The library */

/* "0.2.0". It never fails. */
ALMESH_API const char *almesh_version(void);

/* The sentence of the last call of this thread that failed, "" before the first; it lives until the next one that
 * fails. */
ALMESH_API const char *almesh_error(void);

/* The code of the last call of this thread, of almesh_code: of functions that return a pointer. */
ALMESH_API int almesh_error_code(void);

/* Key `index` >= 0 of the table of keys: its name, legal values, default and meaning. ALMESH_USAGE beyond the last.
 * Each pointer may be NULL. Texts live as long as the library. */
ALMESH_API int almesh_key(int index, const char **name, const char **legal, const char **value, const char **meaning);

/* Form `index` >= 0 of a motion, "rotate DEGREES [about PX PY [PZ]]", and its meaning. As almesh_key(). */
ALMESH_API int almesh_motion(int index, const char **form, const char **meaning);

/* Quantity `index` >= 0 of the results of a run, and its meaning. As almesh_key(). */
ALMESH_API int almesh_quantity(int index, const char **name, const char **meaning);

/* ---- Meshes. On error *mesh is NULL. */

/* The mesh of a file, in any format that the program reads. A mesh with inverted elements is read; only
 * almesh_improve() takes it further. */
ALMESH_API int almesh_read(const char *path, almesh_mesh **mesh);

/* A deck and its mesh: as the program reads it, with all its settings. */
ALMESH_API int almesh_read_deck(const char *path, almesh_mesh **mesh);

/* A mesh from arrays, which are copied. x: nodes x dim, finite. Cells of dimension dim are elements, those of dim - 1
 * faces; all are of the degree, 1 to 7. Outer faces in no block are the boundary "untagged"; without blocks of faces
 * "boundary" ("boundary-1", ... if in parts). Elements of negative orientation are turned over: almesh_elements() has
 * their nodes then. */
ALMESH_API int almesh_from_arrays(int dim, int degree, int nodes, const double *x, int blocks,
                                  const almesh_block *block, almesh_mesh **mesh);

/* NULL is nothing to free. ALMESH_BUSY frees nothing. */
ALMESH_API int almesh_free(almesh_mesh *mesh);

/* ---- Settings. They hold from the next run on, and replace those of a deck. What is wrong by itself is refused here,
 * what does not fit the mesh or another setting by the run. */

/* All settings anew, from the text of a deck (its key `mesh` is passed over); positions are forgotten. */
ALMESH_API int almesh_set_deck(almesh_mesh *mesh, const char *text);

/* A setting as on the program's command line: key "omega_star", value "1e-9". A key may be a line's beginning, too:
 * "let a", "select top", "expect nodes". value NULL: takes the setting back. Not for the key mesh. */
ALMESH_API int almesh_set(almesh_mesh *mesh, const char *key, const char *value);

/* The value of a key, of a deck's or of the default too, as almesh_set() takes it. */
ALMESH_API const char *almesh_get(almesh_mesh *mesh, const char *key);

/* What holds the nodes of a boundary: "fixed", "translate 1 0; rotate \"10*t\" about 0 0", "slide", ... name "rest": of all
 * boundaries without one, "all": also of those inside. motion NULL: takes it back, or the positions. */
ALMESH_API int almesh_set_boundary(almesh_mesh *mesh, const char *name, const char *motion);

/* The same of all nodes of a volume, a group of elements. */
ALMESH_API int almesh_set_volume(almesh_mesh *mesh, const char *name, const char *motion);

/* The nodes of a boundary go to given positions. x: nodes x dim of the mesh as it was read, of which those on the
 * boundary count. They are copied. Other positions of a boundary that has such already cost no new set-up of
 * almesh_frame(). */
ALMESH_API int almesh_set_boundary_positions(almesh_mesh *mesh, const char *name, const double *x, size_t numbers);

/* After every Newton step and, with newton_step = 0, every iteration of the augmented Lagrangian. Between them, where
 * other work takes long, the numbers of the last one are told again some ten times a second. */
typedef struct almesh_progress {
    int iteration, newton_step;
    double energy, gradient_norm, step_length, constraint_norm; /* |c_D| of iterations, else 0; step_length else 1 */
} almesh_progress;

/* It returns 0 to go on; else the run ends with the last valid mesh and ALMESH_CANCELLED. It is called by the thread
 * that has called the run, and must not throw. Calls for the same mesh in it are refused as ALMESH_BUSY. */
typedef int (*almesh_callback)(void *user, const almesh_progress *progress);

/* NULL: none. */
ALMESH_API int almesh_on_progress(almesh_mesh *mesh, almesh_callback callback, void *user);

/* ---- Runs. After ALMESH_OK, _NOT_CONVERGED, _NOT_CERTIFIED, _EXPECTATION and _CANCELLED the mesh has the positions
 * that the run ended with; after any other error those of before, and the results of before. */

/* Moves the mesh, as it was read, to where the settings say: the run of the program. Earlier runs do not count. */
ALMESH_API int almesh_move(almesh_mesh *mesh);

/* The same at the time t of a motion in time, as a frame of the program: motions are formulas of t, or positions that
 * are set anew before each frame. It starts from up to three frames before with a lesser t, in the few Newton steps
 * that a near mesh needs; every mesh depends on its t alone, but for tolerances. Other than the program it never puts
 * frames between two times. The first frame, and one after other settings than numbers in motions, costs a set-up. */
ALMESH_API int almesh_frame(almesh_mesh *mesh, double t);

/* Makes the mesh, as it was read, valid and its worst elements better: `almesh improve`. Boundaries slide along
 * themselves, unless they are set. Not for a deck. */
ALMESH_API int almesh_improve(almesh_mesh *mesh);

/* Certifies the positions x, nodes x dim (NULL: those that the mesh has): ALMESH_OK if every element is proved valid
 * and no two overlap, else ALMESH_NOT_CERTIFIED, and the sentence says why. numbers: of x; 0 with NULL. */
ALMESH_API int almesh_certify(almesh_mesh *mesh, const double *x, size_t numbers);

/* The derivative dJ/dg of a function J(x) by the position of each boundary node, zero elsewhere, at the mesh of the
 * last almesh_move() or almesh_frame(), which must have converged and is first made stationary to rounding: positions
 * change, within the tolerances of the run. dJ_dx, dJ_dg: nodes x dim each; `numbers` are in dJ_dx. */
ALMESH_API int almesh_adjoint(almesh_mesh *mesh, const double *dJ_dx, size_t numbers, double *dJ_dg);

/* The derivative dx of all positions along a velocity dg of the boundary nodes. As almesh_adjoint(). */
ALMESH_API int almesh_tangent(almesh_mesh *mesh, const double *dg, size_t numbers, double *dx);

/* ---- The mesh as it is: before a run, as it was read */

ALMESH_API int almesh_sizes_of(almesh_mesh *mesh, almesh_sizes *sizes);

/* nodes x dim, without a copy: as they are, and as they were read. */
ALMESH_API const double *almesh_positions(almesh_mesh *mesh);
ALMESH_API const double *almesh_first_positions(almesh_mesh *mesh);

/* Ids in the file, of all nodes and of all elements; of arrays the index + 1. */
ALMESH_API const long long *almesh_node_ids(almesh_mesh *mesh);
ALMESH_API const long long *almesh_element_ids(almesh_mesh *mesh);

ALMESH_API int almesh_elements(almesh_mesh *mesh, almesh_cells *cells);

/* Boundary `index` in 0 ... boundaries - 1: its name and its faces, oriented outward. Each pointer may be NULL. */
ALMESH_API int almesh_boundary(almesh_mesh *mesh, int index, const char **name, almesh_cells *faces);

/* Volume `index` in 0 ... volumes - 1: its name and its elements, ascending. Each pointer may be NULL. */
ALMESH_API int almesh_volume(almesh_mesh *mesh, int index, const char **name, const int **elements, int *count);

/* Numbers of all elements at the positions that the mesh has: "scaled_jacobian" (least at a corner, 1 at best),
 * "quality" (least 1/eta against the regular cell, 1 at best), "certified_bound" (below det J over that of the straight
 * element, everywhere; valid where > 0); after a run "distortion" (largest eta against the ideal mesh, 1 at best). */
ALMESH_API const double *almesh_element_values(almesh_mesh *mesh, const char *name);

/* ---- Results of the last run: ALMESH_ORDER before the first */

/* A quantity of the run, by its name in almesh_quantity(), as the program's summary.txt has it: as a number, or as its
 * text, which for some is a word: "status", "certified_valid", "certified_injective", "diagnosis", ... A number that is
 * "none" is refused as ALMESH_ORDER. */
ALMESH_API int almesh_number(almesh_mesh *mesh, const char *name, double *value);
ALMESH_API const char *almesh_word(almesh_mesh *mesh, const char *name);

/* The multipliers of the boundary condition at all nodes, nodes x dim, zero off the boundary, without a copy: of
 * almesh_move(), as the program's boundary.vtk has them. */
ALMESH_API const double *almesh_multipliers(almesh_mesh *mesh);

/* What the program would have told of the mesh and of the run besides: notes, a line each; "" if nothing. Before the
 * first run too. */
ALMESH_API const char *almesh_notes(almesh_mesh *mesh);

/* Writes the mesh with the positions that it has. If it comes from a file, the ending of the path is that of the file,
 * and it has the nodes of the file: the file itself, with nothing but its coordinates changed. Else .msh (2.2) or
 * .su2. A file that was there is replaced in one step. */
ALMESH_API int almesh_save(almesh_mesh *mesh, const char *path);

/* The same, and a proof that the mesh in that file is valid and covers no point twice, for whoever wants to check it
 * (outputs/README.md): with tests/verify.py, by exact arithmetic. Where it is not MSH 2.2 or 4.1 in text or SU2, the
 * mesh is written as MSH 2.2 beside the proof, too. ALMESH_NOT_CERTIFIED, and no proof: the mesh is not valid, or too
 * close to the limit to tell. */
ALMESH_API int almesh_save_proof(almesh_mesh *mesh, const char *path, const char *proof);

#ifdef __cplusplus
}
#endif

#endif
