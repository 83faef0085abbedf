/* SPDX-License-Identifier: Apache-2.0 */
/* obj.h - points and faces of a file in Wavefront's format, which programs that model in space
 * write.
 *
 *     fp3_obj mesh = {0};
 *     fp3_status status = fp3_obj_read("hill.obj", &mesh, error);
 *     fp3_obj_free(&mesh);
 *
 * Lines "v X Y Z" are points. Lines "f A B C ..." are faces, by the numbers of points from 1 on, or
 * back from the last one: -1; what stands behind a slash (2/5/1) is not looked at. A face with more
 * than three corners is cut into triangles from its first corner, so it has to be convex. Lines of
 * what has no shape (normals, names, materials and the like) are passed over. A line that a
 * backslash continues is refused.
 */
#ifndef FP3_BODIES_SCENE_OBJ_H
#define FP3_BODIES_SCENE_OBJ_H

#include <fp3/status.h>
#include <stddef.h>
#include <stdint.h>

typedef struct {
    double *point; /* three numbers of each */
    uint32_t (*triangle)[3];
    size_t points, triangles, point_room, triangle_room;
} fp3_obj;

/* FP3_E_ARGUMENT, with "path:line:column: found ..., expected ...". The caller frees *mesh, after a
 * failure too. */
fp3_status fp3_obj_read(const char *path, fp3_obj *mesh, fp3_error *error);
/* Leaves {0}, which may be freed as well. */
void fp3_obj_free(fp3_obj *mesh);

#endif
