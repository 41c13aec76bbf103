/* A data set of a hundred shapes of one mesh: for each a deformed circle, the moved mesh and how good it is.
 *
 *   shapes MESH FOLDER [SHAPES]    cc shapes.c $(pkg-config --cflags --libs almesh) -lm -o shapes
 *
 * The shapes follow each other as frames of a motion: the problem, its matrix and the order of its factorisation are
 * set up once, and each mesh starts from those before. A shape whose file is there is passed over, so that a run that
 * was killed goes on where it stood; a file is written in one step, and so never half. */
#include "almesh.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static void check(int code, const char *what) {
    if (code == ALMESH_OK) return;
    fprintf(stderr, "%s: %s\n", what, almesh_error());
    exit(code);
}

/* The nodes of the boundary `inner` as an ellipse, turned: x has all nodes, of which those count. */
static void set_shape(almesh_mesh *mesh, int k, const double *first, double *x, int nodes) {
    const double turn = 0.06 * k, stretch = 1 + 0.2 * sin(0.3 * k), c = cos(turn), s = sin(turn);
    for (int i = 0; i < nodes; ++i) {
        const double a = stretch * first[2 * i], b = first[2 * i + 1] / stretch;
        x[2 * i] = c * a - s * b;
        x[2 * i + 1] = s * a + c * b;
    }
    check(almesh_set_boundary_positions(mesh, "inner", x, (size_t)(2 * nodes)), "shape");
}

int main(int argc, char **argv) {
    almesh_mesh *mesh = NULL;
    almesh_sizes sizes;
    const int shapes = argc > 3 ? atoi(argv[3]) : 100;
    int made = 0;
    if (argc < 3) return fprintf(stderr, "usage: shapes MESH FOLDER [SHAPES]\n"), 1;
    check(almesh_read(argv[1], &mesh), argv[1]);
    check(almesh_set_boundary(mesh, "outer", "fixed"), "outer");
    check(almesh_sizes_of(mesh, &sizes), "sizes");
    const size_t bytes = sizeof(double) * 2 * (size_t)sizes.nodes;
    double *first = malloc(bytes), *x = malloc(bytes);
    if (!first || !x) return 2;
    for (int i = 0; i < 2 * sizes.nodes; ++i) first[i] = almesh_first_positions(mesh)[i];
    for (int k = 0; k < shapes; ++k) {
        char path[1000];
        snprintf(path, sizeof path, "%s/shape-%03d.msh", argv[2], k);
        FILE *there = fopen(path, "r");
        if (there) {
            fclose(there);
            continue;
        }
        double quality, bound;
        set_shape(mesh, k, first, x, sizes.nodes);
        check(almesh_frame(mesh, k), path);
        check(almesh_number(mesh, "relative_quality", &quality), path);
        check(almesh_number(mesh, "certified_bound", &bound), path);
        check(almesh_save(mesh, path), path);
        if (++made % 10 == 1) printf("%s: quality %.4f, certified bound %.3f\n", path, quality, bound);
    }
    printf("%d shapes made, %d were there\n", made, shapes - made);
    free(first);
    free(x);
    return almesh_free(mesh);
}
