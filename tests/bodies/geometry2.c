/* SPDX-License-Identifier: Apache-2.0 */
/* geometry2.c - what the plane geometry of sw/bodies makes of records on its input: one answer each
 * on its output. tests/bodies/plane.py writes and reads them.
 *
 *     build/tests/geometry2 <records >answers */
#include "bodies/shapes/collide2.h"
#include "bodies/shapes/query2.h"

#include <stdio.h>
#include <string.h>

typedef struct {
    uint32_t kind; /* corners; 0: a box, of half sizes and a pose */
    float radius, points[FP3_CORNERS2][2];
} maker;

typedef struct {
    /* 0 collide, 1 an edge of a chain (a's first four points), 2 makers alone, 3 measure, 4 a ray
     * at b from pose_a.at to to_a.at, 5 impact, 6 cast of b along to_b.at */
    uint32_t what;
    maker a, b;
    fp3_pose2 pose_a, pose_b;
    float reach;
    uint32_t ends;
    fp3_pose2 to_a, to_b;
} request;

typedef struct {
    uint32_t failed; /* 1 a, 2 b */
    fp3_shape2 a, b;
    fp3_bounds2 bounds;
    fp3_manifold2 manifold;
    uint32_t is_hit, overlaps;
    fp3_apart2 apart;
    fp3_hit2 hit;
    fp3_mass2 mass, together;
    char text[128];
} answer;

static fp3_status make(const maker *m, fp3_shape2 *made, fp3_error *error) {
    fp3_point2 p[FP3_CORNERS2];
    for (unsigned i = 0; i < FP3_CORNERS2; i++)
        p[i] = (fp3_point2){m->points[i][0], m->points[i][1]};
    const fp3_pose2 pose = {p[1], p[2].x, p[2].y};
    return m->kind == 0   ? fp3_box2(p[0], &pose, m->radius, made, error)
           : m->kind == 1 ? fp3_disc2(p[0], m->radius, made, error)
           : m->kind == 2 ? fp3_capsule2(p[0], p[1], m->radius, made, error)
                          : fp3_polygon2(p, m->kind, m->radius, made, error);
}

static void reply(const request *r, answer *to) {
    fp3_error error;
    memset(to, 0, sizeof *to);
    if (r->what != 1 && make(&r->a, &to->a, &error))
        to->failed |= 1;
    if (make(&r->b, &to->b, &error))
        to->failed |= 2;
    if (to->failed) {
        snprintf(to->text, sizeof to->text, "%.127s", error.text);
        return;
    }
    if (r->what == 0)
        fp3_collide2(&to->a, &r->pose_a, &to->b, &r->pose_b, r->reach, &to->manifold);
    if (r->what == 1) {
        fp3_link2 link = {.radius = r->a.radius, .ends = r->ends};
        memcpy(link.corner, r->a.points, sizeof link.corner);
        fp3_collide_link2(&link, &r->pose_a, &to->b, &r->pose_b, r->reach, &to->manifold);
    }
    if (r->what == 3) {
        to->is_hit = (uint32_t)fp3_separation2(&to->a, &r->pose_a, &to->b, &r->pose_b, &to->apart);
        to->overlaps = (uint32_t)fp3_overlap2(&to->a, &r->pose_a, &to->b, &r->pose_b);
    }
    if (r->what == 4)
        to->is_hit = (uint32_t)fp3_ray2(&to->b, &r->pose_b, r->pose_a.at,
                                        fp3_subtract2(r->to_a.at, r->pose_a.at), &to->hit);
    if (r->what == 5)
        to->is_hit = (uint32_t)fp3_impact2(&to->a, &(fp3_sweep2){r->pose_a, r->to_a}, &to->b,
                                           &(fp3_sweep2){r->pose_b, r->to_b}, r->reach, &to->hit);
    if (r->what == 6)
        to->is_hit = (uint32_t)fp3_cast2(&to->a, &r->pose_a, &to->b, &r->pose_b, r->to_b.at,
                                         r->reach, &to->hit);
    if (r->what == 2) {
        to->bounds = fp3_bound2(&to->b, &r->pose_b, r->reach);
        to->mass = fp3_weigh2(&to->b, 2);
        const fp3_mass2 both[2] = {fp3_weigh2(&to->a, 3), to->mass};
        to->together = fp3_weigh_together2(both, 2);
    }
}

int main(void) {
    static request r;
    static answer to;
    while (fread(&r, sizeof r, 1, stdin) == 1) {
        reply(&r, &to);
        fwrite(&to, sizeof to, 1, stdout);
    }
    return 0;
}
