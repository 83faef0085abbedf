/* SPDX-License-Identifier: Apache-2.0 */
/* mesh3.c - a tree of boxes over the triangles, halved at the middle of the longest side. */
#include "mesh3.h"

#include <stdlib.h>
#include <string.h>

enum { LEAF = 4, DEEPEST = 64, NOBODY = -1 };
#define FLAT 1e-3f /* a sine: a normal that leans less is a triangle's own */
#define MOST_TRIANGLES (UINT32_C(1) << 28)

typedef struct {
    fp3_point3 low, high;
    uint32_t first, count; /* of triangles, in the tree's order; or count 0: the other child */
} node;

struct fp3_mesh3 {
    uint32_t points, triangles, nodes;
    fp3_point3 *point, *normal;
    uint32_t (*corner)[3];
    int32_t (*beside)[3]; /* over the edge from a corner to the next: a triangle, or NOBODY */
    uint32_t *order;
    node *node;
};

/* ---- making ---- */

typedef struct {
    uint32_t low, high, edge; /* edge: 3 times the triangle, and which of its edges */
} edge;

static int by_ends(const void *a, const void *b) {
    const edge *p = a, *q = b;
    return p->low != q->low     ? (p->low < q->low ? -1 : 1)
           : p->high != q->high ? (p->high < q->high ? -1 : 1)
           : p->edge != q->edge ? (p->edge < q->edge ? -1 : 1)
                                : 0;
}

static int find_neighbours(fp3_mesh3 *m) {
    const size_t count = 3 * (size_t)m->triangles;
    edge *all = malloc(count * sizeof *all);
    if (!all)
        return 0;
    for (size_t i = 0; i < count; i++) {
        const uint32_t a = m->corner[i / 3][i % 3], b = m->corner[i / 3][(i + 1) % 3];
        all[i] = (edge){a < b ? a : b, a < b ? b : a, (uint32_t)i};
        m->beside[i / 3][i % 3] = NOBODY;
    }
    qsort(all, count, sizeof *all, by_ends);
    for (size_t i = 0, n; i < count; i += n) {
        for (n = 1;
             i + n < count && all[i + n].low == all[i].low && all[i + n].high == all[i].high;)
            n++;
        const uint32_t p = all[i].edge, q = all[i + n - 1].edge;
        if (n == 2 && m->corner[p / 3][p % 3] != m->corner[q / 3][q % 3]) {
            m->beside[p / 3][p % 3] = (int32_t)(q / 3);
            m->beside[q / 3][q % 3] = (int32_t)(p / 3);
        }
    }
    free(all);
    return 1;
}

typedef struct {
    float at;
    uint32_t triangle;
} place;

static int by_place(const void *a, const void *b) {
    const place *p = a, *q = b;
    return p->at != q->at               ? (p->at < q->at ? -1 : 1)
           : p->triangle != q->triangle ? (p->triangle < q->triangle ? -1 : 1)
                                        : 0;
}

static void widen(node *n, fp3_point3 p) {
    n->low = (fp3_point3){p.x < n->low.x ? p.x : n->low.x, p.y < n->low.y ? p.y : n->low.y,
                          p.z < n->low.z ? p.z : n->low.z};
    n->high = (fp3_point3){p.x > n->high.x ? p.x : n->high.x, p.y > n->high.y ? p.y : n->high.y,
                           p.z > n->high.z ? p.z : n->high.z};
}

/* A node of these triangles: its first child is next to it, `first` of an inner one is the second.
 */
static void grow(fp3_mesh3 *m, place *work, uint32_t first, uint32_t count) {
    const uint32_t own = m->nodes++;
    node n = {.first = first, .count = count};
    n.low = n.high = m->point[m->corner[m->order[first]][0]];
    for (uint32_t i = 0; i < count; i++)
        for (uint32_t k = 0; k < 3; k++)
            widen(&n, m->point[m->corner[m->order[first + i]][k]]);
    if (count > LEAF) {
        const fp3_point3 wide = fp3_subtract3(n.high, n.low);
        const uint32_t axis = wide.x >= wide.y && wide.x >= wide.z ? 0 : wide.y >= wide.z ? 1 : 2;
        for (uint32_t i = 0; i < count; i++) {
            const uint32_t t = m->order[first + i], *c = m->corner[t];
            work[i] = (place){(fp3_part3(m->point[c[0]], axis) + fp3_part3(m->point[c[1]], axis)) +
                                  fp3_part3(m->point[c[2]], axis),
                              t};
        }
        qsort(work, count, sizeof *work, by_place);
        for (uint32_t i = 0; i < count; i++)
            m->order[first + i] = work[i].triangle;
        grow(m, work, first, count / 2);
        n.first = m->nodes;
        n.count = 0;
        grow(m, work, first + count / 2, count - count / 2);
    }
    m->node[own] = n;
}

static fp3_status check(fp3_mesh3 *m, uint32_t points, fp3_error *error) {
    if (!fp3_shape3_takes(points, m->point, 0))
        return fp3_fail(error, FP3_E_ARGUMENT, "a mesh's points must be finite and at most 1e6");
    for (uint32_t i = 0; i < m->triangles; i++) {
        fp3_shape3 shape;
        fp3_point3 p[3];
        for (uint32_t k = 0; k < 3; k++) {
            if (m->corner[i][k] >= points)
                return fp3_fail(error, FP3_E_ARGUMENT, "triangle %u has corner %u of %u points", i,
                                m->corner[i][k], points);
            p[k] = m->point[m->corner[i][k]];
        }
        if (fp3_triangle3(p, 0, &shape, NULL))
            return fp3_fail(error, FP3_E_ARGUMENT, "triangle %u has its corners on a line", i);
        m->normal[i] = shape.normal[0];
    }
    return FP3_OK;
}

static fp3_status fill(fp3_mesh3 *m, uint32_t points, const fp3_point3 *point,
                       const uint32_t (*corner)[3], fp3_error *error) {
    const size_t count = m->triangles;
    m->point = malloc((points + (size_t)1) * sizeof *m->point);
    m->normal = malloc(count * sizeof *m->normal);
    m->corner = malloc(count * sizeof *m->corner);
    m->beside = malloc(count * sizeof *m->beside);
    m->order = malloc(count * sizeof *m->order);
    m->node =
        malloc(count * sizeof *m->node); /* leaves have two triangles at least, or are alone */
    place *work = malloc(count * sizeof *work);
    fp3_status status = FP3_OK;
    if (!m->point || !m->normal || !m->corner || !m->beside || !m->order || !m->node || !work)
        status = fp3_no_memory(error);
    if (status == FP3_OK) {
        memcpy(m->point, point, points * sizeof *point);
        memcpy(m->corner, corner, count * sizeof *corner);
        status = check(m, points, error);
    }
    if (status == FP3_OK && !find_neighbours(m))
        status = fp3_no_memory(error);
    if (status == FP3_OK) {
        for (uint32_t i = 0; i < m->triangles; i++)
            m->order[i] = i;
        grow(m, work, 0, m->triangles);
    }
    free(work);
    return status;
}

fp3_status fp3_make_mesh3(uint32_t points, const fp3_point3 *point, uint32_t triangles,
                          const uint32_t (*corner)[3], fp3_mesh3 **mesh, fp3_error *error) {
    *mesh = NULL;
    if (triangles == 0 || triangles > MOST_TRIANGLES)
        return fp3_fail(error, FP3_E_ARGUMENT, "a mesh needs from 1 to 2^28 triangles, not %u",
                        triangles);
    fp3_mesh3 *m = calloc(1, sizeof *m);
    if (!m)
        return fp3_no_memory(error);
    m->points = points;
    m->triangles = triangles;
    const fp3_status status = fill(m, points, point, corner, error);
    if (status)
        fp3_free_mesh3(&m);
    *mesh = m;
    return status;
}

fp3_status fp3_make_heights3(uint32_t columns, uint32_t rows, float dx, float dy,
                             const float *height, fp3_mesh3 **mesh, fp3_error *error) {
    *mesh = NULL;
    if (columns < 2 || rows < 2 || columns > 10000 || rows > 10000 || !(dx > 0) || !(dy > 0))
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "heights need from 2 to 10,000 columns and rows, and spacings above 0");
    const size_t cells = (columns - (size_t)1) * (rows - (size_t)1);
    fp3_point3 *point = malloc((size_t)columns * rows * sizeof *point);
    uint32_t(*corner)[3] = malloc(2 * cells * sizeof *corner);
    fp3_status status = point && corner ? FP3_OK : fp3_no_memory(error);
    if (status == FP3_OK) {
        size_t n = 0;
        for (uint32_t j = 0; j < rows; j++)
            for (uint32_t i = 0; i < columns; i++) {
                const uint32_t p = j * columns + i;
                point[p].x = (float)i * dx;
                point[p].y = (float)j * dy;
                point[p].z = height[p];
                if (i + 1 == columns || j + 1 == rows)
                    continue;
                memcpy(corner[n++], (const uint32_t[3]){p, p + 1, p + columns + 1}, sizeof *corner);
                memcpy(corner[n++], (const uint32_t[3]){p, p + columns + 1, p + columns},
                       sizeof *corner);
            }
        status = fp3_make_mesh3(columns * rows, point, (uint32_t)n, (const uint32_t(*)[3])corner,
                                mesh, error);
    }
    free(point);
    free(corner);
    return status;
}

void fp3_free_mesh3(fp3_mesh3 **mesh) {
    fp3_mesh3 *m = *mesh;
    *mesh = NULL;
    if (!m)
        return;
    free(m->point);
    free(m->normal);
    free(m->corner);
    free(m->beside);
    free(m->order);
    free(m->node);
    free(m);
}

uint32_t fp3_mesh_triangles3(const fp3_mesh3 *mesh) { return mesh->triangles; }

/* ---- colliding ---- */

/* A triangle as a shape; what does not depend on its corners is there already. */
static const fp3_shape3 TRIANGLE = {.count = 3,
                                    .faces = 2,
                                    .halves = 6,
                                    .first = {0, 1},
                                    .from = {0, 1, 1, 2, 2, 0},
                                    .next = {2, 5, 4, 1, 0, 3},
                                    .face = {0, 1, 0, 1, 0, 1}};

static void take(const fp3_mesh3 *m, uint32_t triangle, fp3_shape3 *shape) {
    float far = 0;
    for (uint32_t k = 0; k < 3; k++) {
        shape->corner[k] = m->point[m->corner[triangle][k]];
        const float size = fp3_size3(shape->corner[k]);
        far = size > far ? size : far;
    }
    shape->extent = far * 1.000001f;
    shape->middle = fp3_times3(
        1.0f / 3, fp3_add3(fp3_add3(shape->corner[0], shape->corner[1]), shape->corner[2]));
    shape->normal[0] = m->normal[triangle];
    shape->normal[1] = fp3_times3(-1.0f, m->normal[triangle]);
    shape->offset[0] = fp3_dot3(shape->normal[0], shape->corner[0]);
    shape->offset[1] = -shape->offset[0];
}

typedef enum { OWN, FACE, NEIGHBOURS } whose;

/* Whose the contact is with this normal, in the mesh's frame. */
static whose whose_normal(const fp3_mesh3 *m, uint32_t triangle, fp3_point3 normal) {
    const fp3_point3 up = m->normal[triangle];
    const float high = fp3_dot3(normal, up);
    const fp3_point3 across = fp3_along3(normal, -high, up);
    if (fp3_dot3(across, across) < FLAT * FLAT)
        return high > 0 ? OWN : FACE;
    float most = -INFINITY;
    uint32_t over = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const fp3_point3 e = fp3_subtract3(m->point[m->corner[triangle][(k + 1) % 3]],
                                           m->point[m->corner[triangle][k]]);
        const float along = fp3_dot3(fp3_cross3(e, up), across) / fp3_size3(e);
        if (along > most) {
            most = along;
            over = k;
        }
    }
    const int32_t other = m->beside[triangle][over];
    if (other == NOBODY)
        return high > 0 ? OWN : FACE;
    /* Between both normals over a ridge. Where it is flat or hollow none leans towards the edge. */
    const fp3_point3 up_there = m->normal[other];
    const float there = fp3_dot3(normal, up_there), between = fp3_dot3(up, up_there);
    if (high < between || there < between)
        return FACE;
    return high >= there ? OWN : NEIGHBOURS;
}

typedef struct {
    const fp3_mesh3 *mesh;
    const fp3_pose3 *pose_a, *pose_b;
    const fp3_shape3 *b;
    fp3_turn3 of_a;
    fp3_point3 middle, low, high; /* of b, in the mesh's frame */
    float reach;
} visit;

uint32_t fp3_mesh_points3(const fp3_mesh3 *mesh) { return mesh->points; }

fp3_point3 fp3_mesh_point3(const fp3_mesh3 *mesh, uint32_t point) { return mesh->point[point]; }

const uint32_t *fp3_mesh_corners3(const fp3_mesh3 *mesh, uint32_t triangle) {
    return mesh->corner[triangle];
}

void fp3_mesh_triangle3(const fp3_mesh3 *mesh, uint32_t triangle, fp3_shape3 *shape) {
    *shape = TRIANGLE;
    take(mesh, triangle, shape);
}

static int collide_one(const visit *v, uint32_t triangle, fp3_shape3 *shape, fp3_manifold3 *to) {
    take(v->mesh, triangle, shape);
    if (fp3_dot3(shape->normal[0], v->middle) < shape->offset[0])
        return 0;
    fp3_collide3(shape, v->pose_a, v->b, v->pose_b, v->reach, to);
    if (to->count == 0)
        return 0;
    const whose of = whose_normal(v->mesh, triangle, fp3_unturned3(&v->of_a, to->normal));
    if (of == FACE)
        fp3_collide_face3(shape, v->pose_a, 0, v->b, v->pose_b, v->reach, to);
    return of != NEIGHBOURS && to->count > 0;
}

static int is_near(const node *n, const visit *v) {
    return n->low.x <= v->high.x && n->high.x >= v->low.x && n->low.y <= v->high.y &&
           n->high.y >= v->low.y && n->low.z <= v->high.z && n->high.z >= v->low.z;
}

uint32_t fp3_collide_mesh3(const fp3_mesh3 *mesh, const fp3_pose3 *pose_a, const fp3_shape3 *b,
                           const fp3_pose3 *pose_b, float reach, uint32_t most,
                           fp3_mesh_touch3 *to) {
    if (!fp3_pose3_is_good(pose_a) || !fp3_pose3_is_good(pose_b))
        return 0;
    visit v = {.mesh = mesh, .pose_a = pose_a, .pose_b = pose_b, .b = b, .reach = reach};
    v.of_a = fp3_turn_of3(pose_a->q);
    const fp3_turn3 of_b = fp3_between3(pose_a, &v.of_a, pose_b);
    const float wide = (b->radius + reach) + 1e-6f * (b->extent + fp3_size3(of_b.at));
    node around = {.low = fp3_placed3(&of_b, b->corner[0])};
    around.high = around.low;
    for (uint32_t i = 1; i < b->count; i++)
        widen(&around, fp3_placed3(&of_b, b->corner[i]));
    v.low = fp3_subtract3(around.low, (fp3_point3){wide, wide, wide});
    v.high = fp3_add3(around.high, (fp3_point3){wide, wide, wide});
    v.middle = fp3_placed3(&of_b, b->middle);
    fp3_shape3 shape = TRIANGLE;
    uint32_t stack[DEEPEST], depth = 0, found = 0;
    stack[depth++] = 0;
    while (depth) {
        const uint32_t at = stack[--depth];
        const node *n = &mesh->node[at];
        if (!is_near(n, &v))
            continue;
        if (n->count == 0) {
            stack[depth++] = n->first;
            stack[depth++] = at + 1;
        }
        for (uint32_t i = 0; i < n->count; i++) {
            fp3_manifold3 m;
            if (!collide_one(&v, mesh->order[n->first + i], &shape, &m))
                continue;
            if (found < most)
                to[found] = (fp3_mesh_touch3){mesh->order[n->first + i], m};
            found++;
        }
    }
    return found;
}
