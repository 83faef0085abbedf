/* SPDX-License-Identifier: Apache-2.0 */
/* outline.c - see outline.h. */
#include "outline.h"

#include "own.h"

fp3_status fp3_bodies_outlines(const fp3_bodies *bodies, fp3_outline_fn *one, void *user) {
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < bodies->shape_count; i++) {
        const fp3_attached *shape = &bodies->shape[i];
        if (!(shape->generation & 1))
            continue;
        fp3_outline made = {.body = fp3_bodies_handle(bodies, shape->body),
                            .type = (fp3_body_type)bodies->body[shape->body].type,
                            .corners = shape->given.core.count,
                            .is_sensor = shape->is_sensor,
                            .radius = (double)shape->given.radius};
        for (uint32_t k = 0; k < made.corners; k++) {
            made.corner[k][0] = (double)shape->given.core.corner.x[k];
            made.corner[k][1] = (double)shape->given.core.corner.y[k];
        }
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
            status = one(
                user, &(fp3_outline_joint){.type = def->type,
                                           .joint = (uint64_t)bodies->joint[i].generation << 32 | i,
                                           .a = def->a,
                                           .b = def->b,
                                           .anchor_a = {def->anchor_a[0], def->anchor_a[1], 0},
                                           .anchor_b = {def->anchor_b[0], def->anchor_b[1], 0}});
    }
    return status;
}
