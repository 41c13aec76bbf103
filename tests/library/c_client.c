/* almesh.h as a program in C99 has it. Returns the line of the first check that fails, or 0. */
#include "c_client.h"

#include <math.h>
#include <string.h>

#include "almesh.h"

#define CHECK(condition) \
    do {                 \
        if (!(condition)) return __LINE__; \
    } while (0)

static int count_and_stop(void *user, const almesh_progress *progress) {
    int *left = user;
    return progress->iteration < 0 || --*left < 0;
}

/* Two triangles and a quadrilateral in a row, with a node of no element. */
static int squares(almesh_mesh **mesh) {
    const double x[] = {0, 0, 1, 0, 2, 0, 0, 1, 1, 1, 2, 1, 9, 9};
    const int quadrilateral[] = {1, 2, 5, 4}, triangles[] = {0, 1, 3, 1, 4, 3}, left[] = {3, 0};
    const almesh_block blocks[] = {{ALMESH_QUADRILATERAL, 1, quadrilateral, "right part"},
                                   {ALMESH_TRIANGLE, 2, triangles, NULL},
                                   {ALMESH_LINE, 1, left, "left"}};
    return almesh_from_arrays(2, 1, 7, x, 3, blocks, mesh);
}

int c_client(void) {
    almesh_mesh *mesh = NULL;
    almesh_sizes sizes;
    almesh_cells cells;
    const char *name, *meaning;
    const int *elements;
    int count, left = 1000, k;
    double value, slope[14], moved[14];

    CHECK(almesh_key(0, &name, NULL, NULL, &meaning) == ALMESH_OK && strcmp(name, "mesh") == 0);
    CHECK(almesh_motion(0, &name, NULL) == ALMESH_OK && almesh_quantity(0, &name, &meaning) == ALMESH_OK);
    CHECK(squares(&mesh) == ALMESH_OK && almesh_sizes_of(mesh, &sizes) == ALMESH_OK);
    CHECK(sizes.dim == 2 && sizes.nodes == 7 && sizes.elements == 3 && sizes.boundaries == 2 && sizes.volumes == 1);
    CHECK(almesh_elements(mesh, &cells) == ALMESH_OK && cells.count == 3 && cells.type[0] == ALMESH_QUADRILATERAL);
    CHECK(cells.offset[3] == 10 && cells.node[4] == 0 && almesh_element_ids(mesh)[2] == 3);
    CHECK(almesh_volume(mesh, 0, &name, &elements, &count) == ALMESH_OK && strcmp(name, "right part") == 0);
    CHECK(count == 1 && elements[0] == 0 && almesh_node_ids(mesh)[6] == 7);
    CHECK(almesh_boundary(mesh, 0, &name, &cells) == ALMESH_OK && almesh_element_values(mesh, "quality")[0] == 1);
    CHECK(almesh_certify(mesh, NULL, 0) == ALMESH_OK && almesh_on_progress(mesh, count_and_stop, &left) == ALMESH_OK);
    CHECK(almesh_set_boundary(mesh, "all", "rotate \"90*t\"") == ALMESH_OK && almesh_frame(mesh, 0.5) == ALMESH_OK);
    CHECK(almesh_frame(mesh, 1) == ALMESH_OK && almesh_positions(mesh)[4] < 1e-12 && left < 1000);
    CHECK(almesh_positions(mesh)[12] == 9 && almesh_first_positions(mesh)[4] == 2);
    CHECK(almesh_number(mesh, "relative_quality", &value) == ALMESH_OK && value > 0.999999 && value <= 1);
    CHECK(strcmp(almesh_word(mesh, "certified_injective"), "yes") == 0 && almesh_multipliers(mesh) != NULL);
    for (k = 0; k < 14; ++k) slope[k] = k;
    CHECK(almesh_adjoint(mesh, slope, 14, moved) == ALMESH_NOT_CONVERGED); /* nothing is distorted: E is 0 */
    CHECK(almesh_set_boundary(mesh, "all", "scale \"1 + t\" 1") == ALMESH_OK && almesh_frame(mesh, 0.5) == ALMESH_OK);
    CHECK(almesh_adjoint(mesh, slope, 14, moved) == ALMESH_OK && moved[12] == 0);
    CHECK(almesh_tangent(mesh, slope, 14, moved) == ALMESH_OK && fabs(moved[2] - 2) < 1e-9);
    memcpy(moved, almesh_first_positions(mesh), sizeof moved);
    for (k = 0; k < 14; k += 2) moved[k] += 1;
    CHECK(almesh_set_boundary(mesh, "all", NULL) == ALMESH_OK);
    CHECK(almesh_set_boundary(mesh, "rest", "fixed") == ALMESH_OK);
    CHECK(almesh_set_boundary_positions(mesh, "left", moved, 14) == ALMESH_OK);
    CHECK(almesh_move(mesh) == ALMESH_INPUT && strstr(almesh_error(), "left takes it to (1, 0)") != NULL);
    CHECK(almesh_set(mesh, "shared_nodes", "first") == ALMESH_OK && almesh_move(mesh) == ALMESH_OK);
    CHECK(almesh_positions(mesh)[0] == 0 && almesh_set(mesh, "shared_nodes", NULL) == ALMESH_OK);
    return almesh_free(mesh) == ALMESH_OK ? 0 : __LINE__;
}
