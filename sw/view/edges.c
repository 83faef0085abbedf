/* SPDX-License-Identifier: Apache-2.0 */
/* edges.c - see edges.h. */
#include "edges.h"

#include <math.h>
#include <stdlib.h>

#define FLAT 0.999999 /* cosine of the angle between two normals above which there is no edge */
#define SMOOTH 0.866  /* ... and above which it is not sharp */
#define SMALL 0.05    /* a ball at a corner, as a share of how far the shape reaches */

typedef struct {
    uint32_t low, high;
    size_t triangle;
    unsigned side;
} half;

static int by_ends(const void *a, const void *b) {
    const half *p = a, *q = b;
    return p->low != q->low             ? (p->low < q->low ? -1 : 1)
           : p->high != q->high         ? (p->high < q->high ? -1 : 1)
           : p->triangle != q->triangle ? (p->triangle < q->triangle ? -1 : 1)
                                        : (int)p->side - (int)q->side;
}

/* Of length 1; NaN if its corners are on a line. */
static void normal_of(const fp3_view_recording *r, size_t triangle, double n[3]) {
    const uint32_t *c = r->triangles[triangle].corners;
    double u[3], v[3];
    for (int k = 0; k < 3; k++) {
        u[k] = r->corners[c[1]][k] - r->corners[c[0]][k];
        v[k] = r->corners[c[2]][k] - r->corners[c[0]][k];
    }
    for (int k = 0; k < 3; k++)
        n[k] = u[(k + 1) % 3] * v[(k + 2) % 3] - u[(k + 2) % 3] * v[(k + 1) % 3];
    const double size = sqrt(n[0] * n[0] + n[1] * n[1] + n[2] * n[2]);
    for (int k = 0; k < 3; k++)
        n[k] /= size;
}

/* The cosine of the angle between the triangles beside it; -1: they are not two. */
static double bend_of(const fp3_view_recording *r, const half *sides, size_t count) {
    double a[3], b[3];
    if (count != 2)
        return -1;
    normal_of(r, sides[0].triangle, a);
    normal_of(r, sides[1].triangle, b);
    return a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
}

static size_t add_edges(fp3_view_recording *r, const half *sides, size_t count, size_t made) {
    for (size_t i = 0, n; i < count; i += n) {
        for (n = 1; i + n < count && sides[i + n].low == sides[i].low &&
                    sides[i + n].high == sides[i].high;)
            n++;
        const double bend = bend_of(r, sides + i, n);
        const int is_sharp = !(bend > SMOOTH);
        for (size_t k = i; k < i + n; k++)
            r->triangles[sides[k].triangle].rims |= (uint32_t)is_sharp << sides[k].side;
        if (!(bend > FLAT))
            r->edges[made++] = (fp3_view_edge){{sides[i].low, sides[i].high}, is_sharp};
    }
    return made;
}

static size_t sides_of(const fp3_view_recording *r, const fp3_view_shape *s, half *sides) {
    for (size_t i = 0; i < 3 * s->triangles; i++) {
        const uint32_t *c = r->triangles[s->triangle + i / 3].corners;
        const uint32_t a = c[i % 3], b = c[(i + 1) % 3];
        sides[i] = (half){a < b ? a : b, a < b ? b : a, s->triangle + i / 3, i % 3};
    }
    return 3 * s->triangles;
}

/* Of a shape without triangles. A hull has none in recordings that were made before they had any: a
 * ball is at each of its corners. */
static size_t add_points(fp3_view_recording *r, fp3_view_shape *s, size_t made) {
    double ends[2] = {INFINITY, -INFINITY}, most = 0;
    for (size_t i = s->first; i < s->first + s->corners; i++) {
        const double *c = r->corners[i];
        ends[0] = fmin(ends[0], c[2]);
        ends[1] = fmax(ends[1], c[2]);
        most = fmax(most, c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
    }
    if (s->corners < 3 || ends[0] == ends[1]) { /* polygons have no third number */
        r->edges[made] =
            (fp3_view_edge){{(uint32_t)s->first, (uint32_t)(s->first + s->corners - 1)}, 1};
        return made + 1;
    }
    s->radius = fmax(s->radius, SMALL * sqrt(most));
    for (size_t i = s->first; i < s->first + s->corners; i++)
        r->edges[made++] = (fp3_view_edge){{(uint32_t)i, (uint32_t)i}, 1};
    return made;
}

fp3_status fp3_view_edges_find(fp3_view_recording *r, fp3_error *error) {
    size_t most = 0, made = 0, corners = 0;
    for (size_t i = 0; i < r->shape_count; i++) {
        corners += r->shapes[i].corners;
        most = r->shapes[i].triangles > most ? r->shapes[i].triangles : most;
    }
    half *sides = malloc((3 * most + 1) * sizeof *sides);
    r->edges = malloc((3 * r->triangle_count + corners + 1) * sizeof *r->edges);
    for (size_t i = 0; i < r->shape_count && sides && r->edges; i++) {
        fp3_view_shape *s = &r->shapes[i];
        const size_t count = sides_of(r, s, sides);
        s->edge = made;
        qsort(sides, count, sizeof *sides, by_ends);
        made = add_edges(r, sides, count, made);
        if (!count)
            made = add_points(r, s, made);
        s->edges = made - s->edge;
    }
    const int is_good = sides && r->edges;
    free(sides);
    return is_good ? FP3_OK : fp3_no_memory(error);
}
