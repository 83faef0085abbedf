/* SPDX-License-Identifier: Apache-2.0 */
/* mesh3.h - ground of triangles: a mesh, or heights on a grid.
 *
 *     fp3_mesh3 *ground;
 *     if (fp3_make_mesh3(points, point, triangles, corner, &ground, &error))
 *         ...
 *     found = fp3_collide_mesh3(ground, &pose_a, &box, &pose_b, 0.02f, 16, touch);
 *     fp3_free_mesh3(&ground);
 *
 * A triangle has one side, that from which its corners run anticlockwise. What slides over an edge
 * between two triangles does not catch there: where the ground is flat or hollow a triangle has its
 * own normal alone; over a ridge each has the normals between its own and the middle of both. An
 * edge that has not exactly two triangles, one each way round, is an end of the ground. */
#ifndef FP3_BODIES_MESH3_H
#define FP3_BODIES_MESH3_H

#include "bodies/shapes/collide3.h"

typedef struct fp3_mesh3 fp3_mesh3;

/* Copies all it is given. Refused: no triangle or more than 2^28, a corner that is no point,
 * numbers beyond 1e6 or not finite, a triangle whose corners are on a line. *mesh is NULL then. */
fp3_status fp3_make_mesh3(uint32_t points, const fp3_point3 *point, uint32_t triangles,
                          const uint32_t (*corner)[3], fp3_mesh3 **mesh, fp3_error *error);

/* The point of column i and row j is (i dx, j dy, height[j * columns + i]); z is up. At least two
 * of each. Some 70 bytes a triangle, of which a cell has two. */
fp3_status fp3_make_heights3(uint32_t columns, uint32_t rows, float dx, float dy,
                             const float *height, fp3_mesh3 **mesh, fp3_error *error);

uint32_t fp3_mesh_triangles3(const fp3_mesh3 *mesh);
uint32_t fp3_mesh_points3(const fp3_mesh3 *mesh);
fp3_point3 fp3_mesh_point3(const fp3_mesh3 *mesh, uint32_t point);
/* The three points of one of them. */
const uint32_t *fp3_mesh_corners3(const fp3_mesh3 *mesh, uint32_t triangle);
/* One of them as a shape. */
void fp3_mesh_triangle3(const fp3_mesh3 *mesh, uint32_t triangle, fp3_shape3 *shape);

void fp3_free_mesh3(fp3_mesh3 **mesh);

typedef struct {
    uint32_t triangle;
    fp3_manifold3 manifold; /* the mesh is a */
} fp3_mesh_touch3;

/* One manifold for each triangle that b touches, in an order that depends on the mesh alone. How
 * many there are; the first `most` of them are written. */
uint32_t fp3_collide_mesh3(const fp3_mesh3 *mesh, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                           const fp3_pose3 *pose_b, float reach, uint32_t most,
                           fp3_mesh_touch3 *to);

#endif
