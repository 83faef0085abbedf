/* SPDX-License-Identifier: Apache-2.0 */
/* outline.c - see outline.h. */
#include "outline.h"

#include "own3.h"

static int put2(const fp3_shape2 *shape, fp3_outline *made) {
    made->corners = shape->core.count;
    made->radius = (double)shape->radius;
    for (uint32_t k = 0; k < made->corners; k++) {
        made->corner[k][0] = (double)shape->core.corner.x[k];
        made->corner[k][1] = (double)shape->core.corner.y[k];
    }
    return 1;
}

static int put3(const fp3_form3 *form, fp3_outline *made) {
    const fp3_shape3 *shape = &form->shape;
    made->corners = shape->count;
    made->radius = (double)shape->radius;
    for (uint32_t k = 0; k < made->corners && form->kind == FP3_FORM_HULL; k++) {
        const fp3_point3 c = shape->corner[k];
        const double corner[3] = {(double)c.x, (double)c.y, (double)c.z};
        for (int i = 0; i < 3; i++)
            made->corner[k][i] = corner[i];
    }
    return form->kind == FP3_FORM_HULL;
}

fp3_status fp3_bodies_outlines(const fp3_bodies *bodies, fp3_outline_fn *one, void *user) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < bodies->shape_count; i++) {
        const fp3_attached *shape = &bodies->shape[i];
        if (!(shape->generation & 1))
            continue;
        fp3_outline made = {.body = fp3_bodies_handle(bodies, shape->body),
                            .type = (fp3_body_type)bodies->body[shape->body].type,
                            .is_sensor = shape->is_sensor};
        if (!(bodies->space ? put3(shape->form, &made) : put2(&shape->given, &made)))
            continue;
        status = one(user, &made);
    }
    return status;
}

fp3_status fp3_bodies_outline_joints(const fp3_bodies *bodies, fp3_outline_joint_fn *one,
                                     void *user) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < bodies->joint_count; i++) {
        const fp3_joint_def *def = &bodies->joint[i].def;
        if (bodies->joint[i].generation & 1)
            status =
                one(user, &(fp3_outline_joint){
                              .type = def->type,
                              .joint = (uint64_t)bodies->joint[i].generation << 32 | i,
                              .a = def->a,
                              .b = def->b,
                              .anchor_a = {def->anchor_a[0], def->anchor_a[1], def->anchor_a[2]},
                              .anchor_b = {def->anchor_b[0], def->anchor_b[1], def->anchor_b[2]}});
    }
    return status;
}
