/* SPDX-License-Identifier: Apache-2.0 */
/* form3.h - what shapes in space are made of, shared by all bodies that have them.
 *
 * A form is about its body's origin, and never changes.
 */
#ifndef FP3_BODIES_FORM3_H
#define FP3_BODIES_FORM3_H

#include "shapes/collide3.h"
#include "shapes/mass3.h"
#include "shapes/mesh3.h"
#include "shapes/query3.h"

#include <fp3/bodies.h>

typedef enum { FP3_FORM_HULL, FP3_FORM_PLANE, FP3_FORM_MESH } fp3_form_kind;

typedef struct fp3_form3 {
    fp3_form_kind kind;
    uint32_t uses;
    fp3_shape3 shape; /* of a hull; else a point with all that is common */
    fp3_mass3 mass;   /* with density 1 */
    fp3_plane3 plane;
    fp3_mesh3 *mesh;
    fp3_bounds3 bounds;   /* of a mesh */
    fp3_shape_def *given; /* what it was made of; of a mesh NULL */
    uint32_t number;      /* among those of a file, while it is written */
} fp3_form3;

/* Of a definition. The caller gives *form back. FP3_E_ARGUMENT: it is no shape in space. */
fp3_status fp3_form_make(const fp3_shape_def *def, fp3_form3 **form, fp3_error *error);
fp3_status fp3_form_make_mesh(const double *points, size_t count, const uint32_t *triangles,
                              size_t triangle_count, fp3_form3 **form, fp3_error *error);
/* Heights on a grid become triangles (fp3_bodies_attach_heights). */
fp3_status fp3_form_make_heights(size_t columns, size_t rows, double dx, double dy,
                                 const double *heights, fp3_form3 **form, fp3_error *error);
static inline void fp3_form_keep(fp3_form3 *form) {
    if (form)
        form->uses++;
}
/* When all have given it back it is freed. form may be NULL. */
void fp3_form_give_back(fp3_form3 *form);

/* Where it touches another one, or will soon: manifolds from a to b, in an order that depends on
 * the forms alone, each with the triangle of ground that it is of. How many there are; `most` are
 * written. */
uint32_t fp3_form_collide(const fp3_form3 *a, const fp3_pose3 *pose_a, const fp3_form3 *b,
                          const fp3_pose3 *pose_b, float reach, uint32_t most, fp3_mesh_touch3 *to);

/* What a shape meets first on its way, or a ray from the origin if it is NULL; and how far a shape
 * is away: as query3.h has them for hulls. A mesh is asked triangle by triangle. */
int fp3_form_cast(const fp3_form3 *form, const fp3_pose3 *pose, const fp3_shape3 *moving,
                  const fp3_pose3 *turn, fp3_point3 way, float slop, fp3_hit3 *hit);
int fp3_form_separation(const fp3_form3 *form, const fp3_pose3 *pose, const fp3_shape3 *shape,
                        const fp3_pose3 *turn, fp3_apart3 *apart);

#endif
