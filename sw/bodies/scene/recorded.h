/* SPDX-License-Identifier: Apache-2.0 */
/* recorded.h - what a recording keeps of bodies beside their values: shapes, joints, contacts.
 *
 * Places and ways have three numbers, so that bodies in space have room; z is 0 in the plane.
 */
#ifndef FP3_BODIES_SCENE_RECORDED_H
#define FP3_BODIES_SCENE_RECORDED_H

#include "scene.h"

#include "record/sink.h"

#define FP3_BODIES_TABLES 8

typedef struct {
    const fp3_bodies_scene *scene;
    size_t first, count; /* the bodies that are recorded */
    uint32_t *shapes, *triangles, *joints, *contacts;
    double *radii, *corners, *anchors, *points;
    uint64_t *handles; /* of the joints */
    size_t shape_count, corner_count, triangle_count, joint_count, contact_count;
    uint32_t shape_room, radius_room, corner_room, triangle_room, joint_room, handle_room,
        anchor_room, contact_room, point_room;
    fp3_extra extras[FP3_BODIES_TABLES];
    fp3_error *error;
} fp3_bodies_tables;

/* Shapes and joints, as they are when the run begins. The caller closes *tables, after a failure
 * too. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_bodies_tables_open(const fp3_bodies_scene *scene, size_t first, size_t count,
                                  fp3_bodies_tables *tables, fp3_error *error);
/* At snapshot `number`: which joints are there and, if it is asked for, what touches. */
fp3_status fp3_bodies_tables_look(fp3_bodies_tables *tables, uint64_t number, int has_contacts);
/* Sets extras, which hold until the next call or the end. */
void fp3_bodies_tables_gather(fp3_bodies_tables *tables);
void fp3_bodies_tables_close(fp3_bodies_tables *tables);

#endif
