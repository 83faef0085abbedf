/* SPDX-License-Identifier: Apache-2.0 */
/* forms.c - the forms of a world's shapes, as a checkpoint has them: what they were made of. So a
 * file cannot say what no maker would make. */
#include "fields.h"

#include <stdlib.h>
#include <string.h>

static fp3_status room(fp3_bodies *bodies, int part, size_t wanted) {
    const fp3_kept_part p = fp3_part_of(bodies, part);
    return wanted < FP3_NOBODY
               ? fp3_bodies_room(p.array, p.room, p.size, wanted + 1, bodies->error)
               : fp3_fail(bodies->error, FP3_E_ARGUMENT,
                          "a checkpoint has at most 2^32 corners and triangles of all shapes");
}

static int is_there(const fp3_attached *shape) { return shape->generation & 1; }

/* ---- into a file ---- */

static void put_corners(fp3_kept_forms *k, const fp3_form3 *form, uint32_t count) {
    for (uint32_t i = 0; i < count; i++)
        memcpy(k->corner[k->corners + i], form->given->corner[i], sizeof *k->corner);
    k->corners += count;
}

static void put_mesh(fp3_kept_forms *k, const fp3_mesh3 *mesh) {
    for (uint32_t i = 0; i < fp3_mesh_points3(mesh); i++) {
        const fp3_point3 p = fp3_mesh_point3(mesh, i);
        const double at[3] = {p.x, p.y, p.z};
        memcpy(k->corner[k->corners++], at, sizeof at);
    }
    for (uint32_t i = 0; i < fp3_mesh_triangles3(mesh); i++)
        memcpy(k->triangle[k->triangles++], fp3_mesh_corners3(mesh, i), sizeof *k->triangle);
}

/* Numbers that a shape of this type does not look at are 0: the caller's may be anything. */
static fp3_kept_form describe(const fp3_form3 *form) {
    fp3_kept_form made = {.type = FP3_KEPT_MESH};
    const fp3_shape_def *def = form->given;
    if (!def) {
        made.corners = fp3_mesh_points3(form->mesh);
        made.triangles = fp3_mesh_triangles3(form->mesh);
        return made;
    }
    const int is_box = def->type == FP3_BOX, is_plane = def->type == FP3_PLANE;
    made.type = def->type;
    if (!is_plane)
        made.radius = def->radius;
    if (is_box || is_plane || def->type == FP3_SPHERE)
        memcpy(made.centre, def->centre, sizeof made.centre);
    else
        made.corners = def->corners;
    if (is_box) {
        memcpy(made.half, def->half, sizeof made.half);
        memcpy(made.q, def->q, sizeof made.q);
    }
    if (is_plane)
        memcpy(made.normal, def->normal, sizeof made.normal);
    return made;
}

static fp3_status put(fp3_bodies *bodies, fp3_form3 *form) {
    fp3_kept_forms *k = &bodies->space->kept;
    const fp3_kept_form made = describe(form);
    fp3_status status = room(bodies, FP3_PART_FORMS, k->forms + (size_t)1);
    if (!status)
        status = room(bodies, FP3_PART_CORNERS, k->corners + (size_t)made.corners);
    if (!status)
        status = room(bodies, FP3_PART_TRIANGLES, k->triangles + (size_t)made.triangles);
    if (status)
        return status;
    form->number = k->forms;
    k->form[k->forms++] = made;
    if (form->mesh)
        put_mesh(k, form->mesh);
    else
        put_corners(k, form, made.corners);
    return FP3_OK;
}

fp3_status fp3_forms_number(fp3_bodies *bodies) {
    fp3_kept_forms *k = &bodies->space->kept;
    k->forms = k->corners = k->triangles = 0;
    fp3_status status = room(bodies, FP3_PART_FORM_OF, bodies->shape_count);
    for (uint32_t i = 0; i < bodies->shape_count; i++)
        if (is_there(&bodies->shape[i]))
            bodies->shape[i].form->number = FP3_NOBODY;
    for (uint32_t i = 0; !status && i < bodies->shape_count; i++) {
        fp3_form3 *form = is_there(&bodies->shape[i]) ? bodies->shape[i].form : NULL;
        if (form && form->number == FP3_NOBODY)
            status = put(bodies, form);
        k->of[i] = form && !status ? form->number : FP3_NOBODY;
    }
    return status;
}

/* ---- from a file ---- */

static fp3_status make_mesh(const fp3_kept_form *from, double (*corner)[3],
                            const uint32_t (*triangle)[3], fp3_form3 **form, fp3_error *error) {
    return fp3_form_make_mesh(&corner[0][0], from->corners, &triangle[0][0], from->triangles, form,
                              error);
}

static fp3_status make_shape(const fp3_kept_form *from, double (*corner)[3], fp3_form3 **form,
                             fp3_error *error) {
    fp3_shape_def def = fp3_shape_circle(0);
    def.type = from->type <= FP3_PLANE ? (fp3_shape_type)from->type : FP3_CIRCLE;
    def.radius = from->radius;
    memcpy(def.centre, from->centre, sizeof def.centre);
    memcpy(def.half, from->half, sizeof def.half);
    memcpy(def.q, from->q, sizeof def.q);
    memcpy(def.normal, from->normal, sizeof def.normal);
    def.corners = from->corners;
    for (uint32_t i = 0; i < def.corners && i < FP3_HULL_CORNERS; i++)
        memcpy(def.corner[i], corner[i], sizeof def.corner[i]);
    return fp3_form_make(&def, form, error);
}

static fp3_status make_all(const fp3_kept_forms *k, fp3_form3 **form, fp3_error *error) {
    size_t corner = 0, triangle = 0;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < k->forms; i++) {
        const fp3_kept_form *from = &k->form[i];
        if (corner + from->corners > k->corners || triangle + from->triangles > k->triangles)
            return fp3_fail(error, FP3_E_ARGUMENT, "form %u has more corners than there are", i);
        status = from->type == FP3_KEPT_MESH
                     ? make_mesh(from, k->corner + corner,
                                 (const uint32_t(*)[3])k->triangle + triangle, &form[i], error)
                     : make_shape(from, k->corner + corner, &form[i], error);
        corner += from->corners;
        triangle += from->triangles;
    }
    return status;
}

/* What is ground has no body that moves by forces. */
static int may_have(const fp3_bodies *bodies, const fp3_attached *shape, const fp3_form3 *form) {
    return shape->body < bodies->body_count &&
           (form->kind == FP3_FORM_HULL || bodies->body[shape->body].type != FP3_DYNAMIC);
}

fp3_status fp3_forms_make(fp3_bodies *bodies, fp3_error *error) {
    const fp3_kept_forms *k = &bodies->space->kept;
    fp3_form3 **form = calloc(k->forms + (size_t)1, sizeof(fp3_form3 *));
    fp3_status status = form ? make_all(k, form, error) : fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < bodies->shape_count; i++) {
        fp3_attached *shape = &bodies->shape[i];
        const uint32_t of = k->of[i];
        if (!is_there(shape))
            continue;
        if (of >= k->forms || !may_have(bodies, shape, form[of])) {
            status = fp3_fail(error, FP3_E_ARGUMENT, "shape %u has none of its forms", i);
            break;
        }
        shape->form = form[of];
        fp3_form_keep(shape->form);
    }
    for (uint32_t i = 0; form && i < k->forms; i++)
        fp3_form_give_back(form[i]);
    free(form);
    return status;
}

void fp3_forms_forget(fp3_bodies *bodies) {
    fp3_kept_forms *k = &bodies->space->kept;
    free(k->form);
    free(k->corner);
    free(k->triangle);
    free(k->of);
    *k = (fp3_kept_forms){0};
}
