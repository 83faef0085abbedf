/* SPDX-License-Identifier: Apache-2.0 */
/* shape2.c - see shape2.h. */
#include "bodies/shapes/shape2.h"

#include <math.h>

/* A corner that is nearer to the line of its neighbours, in parts of the extent, is none: edges
 * then differ by much more than their normals' rounding. */
static const float FLAT = 1.0f / 16384;

/* ---- makers ---- */

/* Not a number, too: it is in no range. */
static int is_within(float value, float least, float most) {
    return value >= least && value <= most;
}

static int is_near(fp3_point2 p) {
    return is_within(p.x, -FP3_SIZE2_MOST, FP3_SIZE2_MOST) &&
           is_within(p.y, -FP3_SIZE2_MOST, FP3_SIZE2_MOST);
}

static fp3_status check_points(const fp3_point2 *points, uint32_t count, float radius,
                               fp3_error *error) {
    for (uint32_t i = 0; i < count; i++)
        if (!is_near(points[i]))
            return fp3_fail(error, FP3_E_ARGUMENT,
                            "corner %u of a shape: (%g, %g) is not within %g", (unsigned)i,
                            (double)points[i].x, (double)points[i].y, (double)FP3_SIZE2_MOST);
    if (radius != 0 && !is_within(radius, FP3_SIZE2_LEAST, FP3_SIZE2_MOST))
        return fp3_fail(error, FP3_E_ARGUMENT, "radius %g of a shape is not 0 or from %g to %g",
                        (double)radius, (double)FP3_SIZE2_LEAST, (double)FP3_SIZE2_MOST);
    return FP3_OK;
}

static fp3_point2 outwards(fp3_point2 from, fp3_point2 to) {
    const fp3_point2 edge = fp3_subtract2(to, from);
    const float length = sqrtf(fp3_dot2(edge, edge));
    return (fp3_point2){edge.y / length, -edge.x / length};
}

static void set(fp3_points2 *points, uint32_t i, fp3_point2 to) {
    points->x[i] = to.x;
    points->y[i] = to.y;
}

/* What follows from the corners. */
static void measure(fp3_shape2 *shape) {
    const uint32_t count = shape->core.count;
    float square = 0;
    fp3_point2 sum = {0, 0};
    for (uint32_t i = 0; i < count; i++) {
        const fp3_point2 corner = fp3_at2(&shape->core.corner, i);
        const float far = fp3_dot2(corner, corner);
        square = far > square ? far : square;
        sum = fp3_add2(sum, corner);
    }
    shape->middle = (fp3_point2){sum.x / (float)count, sum.y / (float)count};
    /* Rounded up: three roundings of 2^-24 each are behind it. */
    shape->extent = (sqrtf(square) + shape->radius) * (1 + 0x1p-20f);
}

static void complete(const fp3_point2 *corners, uint32_t count, float radius, fp3_shape2 *made) {
    *made = (fp3_shape2){.core.count = count, .radius = radius};
    for (uint32_t i = 0; i < FP3_CORNERS2; i++) {
        const uint32_t k = i < count ? i : count - 1;
        set(&made->core.corner, i, corners[k]);
        if (count > 1)
            set(&made->core.normal, i, outwards(corners[k], corners[k + 1 < count ? k + 1 : 0]));
    }
    measure(made);
}

void fp3_shift2(const fp3_shape2 *shape, fp3_point2 by, fp3_shape2 *made) {
    *made = *shape;
    for (uint32_t i = 0; i < FP3_CORNERS2; i++)
        set(&made->core.corner, i, fp3_subtract2(fp3_at2(&shape->core.corner, i), by));
    measure(made);
}

fp3_status fp3_disc2(fp3_point2 centre, float radius, fp3_shape2 *made, fp3_error *error) {
    const fp3_status status = check_points(&centre, 1, radius, error);
    if (status)
        return status;
    if (radius == 0)
        return fp3_fail(error, FP3_E_ARGUMENT, "a disc has radius 0");
    complete(&centre, 1, radius, made);
    return FP3_OK;
}

fp3_status fp3_capsule2(fp3_point2 a, fp3_point2 b, float radius, fp3_shape2 *made,
                        fp3_error *error) {
    const fp3_point2 ends[] = {a, b}, way = fp3_subtract2(b, a);
    const fp3_status status = check_points(ends, 2, radius, error);
    if (status)
        return status;
    if (!(fp3_dot2(way, way) >= FP3_SIZE2_LEAST * FP3_SIZE2_LEAST))
        return fp3_fail(error, FP3_E_ARGUMENT, "the ends of a capsule are one point");
    complete(ends, 2, radius, made);
    return FP3_OK;
}

fp3_status fp3_box2(fp3_point2 half, const fp3_pose2 *pose, float radius, fp3_shape2 *made,
                    fp3_error *error) {
    if (!is_within(half.x, FP3_SIZE2_LEAST, FP3_SIZE2_MOST) ||
        !is_within(half.y, FP3_SIZE2_LEAST, FP3_SIZE2_MOST))
        return fp3_fail(error, FP3_E_ARGUMENT, "half a box is %g by %g, not from %g to %g",
                        (double)half.x, (double)half.y, (double)FP3_SIZE2_LEAST,
                        (double)FP3_SIZE2_MOST);
    if (!(fabsf(pose->c * pose->c + pose->s * pose->s - 1) <= 1e-3f))
        return fp3_fail(error, FP3_E_ARGUMENT, "a box is turned by (%g, %g), which is no turn",
                        (double)pose->c, (double)pose->s);
    const fp3_point2 at[4] = {
        {-half.x, -half.y}, {half.x, -half.y}, {half.x, half.y}, {-half.x, half.y}};
    fp3_point2 corners[4];
    for (unsigned i = 0; i < 4; i++)
        corners[i] = fp3_place2(pose, at[i]);
    const fp3_status status = check_points(corners, 4, radius, error);
    if (status)
        return status;
    for (unsigned i = 0; i < 4; i++) { /* far from the origin a small box has no corners left */
        const fp3_point2 edge = fp3_subtract2(corners[(i + 1) % 4], corners[i]);
        const float wide = 2 * (i % 2 ? half.y : half.x);
        if (!(fabsf(sqrtf(fp3_dot2(edge, edge)) - wide) <= 0.01f * wide))
            return fp3_fail(error, FP3_E_ARGUMENT, "a box of %g by %g is too small so far away",
                            2 * (double)half.x, 2 * (double)half.y);
    }
    complete(corners, 4, radius, made);
    const fp3_point2 sides[4] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
    for (unsigned i = 0; i < FP3_CORNERS2; i++) /* exact where the box is not turned */
        set(&made->core.normal, i, fp3_turn2(pose, sides[i < 4 ? i : 3]));
    return FP3_OK;
}

static int is_before(fp3_point2 a, fp3_point2 b) { return a.x < b.x || (a.x == b.x && a.y < b.y); }

/* How far c is to the left of the line from a to b. */
static double left_of(fp3_point2 a, fp3_point2 b, fp3_point2 c) {
    const double x = (double)b.x - (double)a.x, y = (double)b.y - (double)a.y;
    const double area = x * ((double)c.y - (double)a.y) - y * ((double)c.x - (double)a.x);
    const double length = sqrt(x * x + y * y);
    return length > 0 ? area / length : 0;
}

/* The hull of sorted points: below from left to right, then above back. */
static uint32_t wrap(const fp3_point2 *sorted, uint32_t count, fp3_point2 *hull) {
    uint32_t size = 0;
    for (unsigned side = 0; side < 2; side++) {
        const uint32_t first = size;
        for (uint32_t k = 0; k < count; k++) {
            const fp3_point2 p = sorted[side ? count - 1 - k : k];
            while (size >= first + 2 && left_of(hull[size - 2], hull[size - 1], p) <= 0)
                size--;
            hull[size++] = p;
        }
        size--; /* the other side begins with it */
    }
    return size;
}

/* Leaves out the flattest corner, until none is flat. */
static uint32_t sharpen(fp3_point2 *hull, uint32_t size, double flat) {
    while (size >= 3) {
        uint32_t flattest = 0;
        double least = -1;
        for (uint32_t i = 0; i < size; i++) {
            const double height =
                -left_of(hull[(i + size - 1) % size], hull[(i + 1) % size], hull[i]);
            if (i == 0 || height < least) {
                least = height;
                flattest = i;
            }
        }
        if (least >= flat)
            return size;
        for (uint32_t i = flattest; i + 1 < size; i++)
            hull[i] = hull[i + 1];
        size--;
    }
    return size;
}

fp3_status fp3_polygon2(const fp3_point2 *points, uint32_t count, float radius, fp3_shape2 *made,
                        fp3_error *error) {
    if (count < 3 || count > FP3_CORNERS2)
        return fp3_fail(error, FP3_E_ARGUMENT, "a polygon has 3 to %d points, not %u", FP3_CORNERS2,
                        (unsigned)count);
    const fp3_status status = check_points(points, count, radius, error);
    if (status)
        return status;
    fp3_point2 sorted[FP3_CORNERS2], hull[2 * FP3_CORNERS2];
    float wide = 0;
    for (uint32_t i = 0; i < count; i++) {
        uint32_t k = i;
        for (; k > 0 && is_before(points[i], sorted[k - 1]); k--)
            sorted[k] = sorted[k - 1];
        sorted[k] = points[i];
        const fp3_point2 way = fp3_subtract2(points[i], points[0]);
        const float x = fabsf(way.x), y = fabsf(way.y), far = x > y ? x : y;
        wide = far > wide ? far : wide;
    }
    double flat = (double)FLAT * (double)wide;
    flat = flat > (double)FP3_SIZE2_LEAST ? flat : (double)FP3_SIZE2_LEAST;
    const uint32_t size = sharpen(hull, wrap(sorted, count, hull), flat);
    if (size < 3)
        return fp3_fail(error, FP3_E_ARGUMENT, "the points of a polygon are on a line");
    complete(hull, size, radius, made);
    return FP3_OK;
}

/* ---- bounds ---- */

fp3_bounds2 fp3_bound2(const fp3_shape2 *shape, const fp3_pose2 *pose, float margin) {
    const float more = shape->radius + margin;
    fp3_point2 low = fp3_turn2(pose, fp3_at2(&shape->core.corner, 0)), high = low;
    for (uint32_t i = 1; i < shape->core.count; i++) {
        const fp3_point2 p = fp3_turn2(pose, fp3_at2(&shape->core.corner, i));
        low.x = p.x < low.x ? p.x : low.x;
        low.y = p.y < low.y ? p.y : low.y;
        high.x = p.x > high.x ? p.x : high.x;
        high.y = p.y > high.y ? p.y : high.y;
    }
    return (fp3_bounds2){{pose->at.x + (low.x - more), pose->at.y + (low.y - more)},
                         {pose->at.x + (high.x + more), pose->at.y + (high.y + more)}};
}

/* ---- mass ---- */

/* The angle of (c, s) for s >= 0, from 0 to pi: halved until the series is short. */
static double angle(double c, double s) {
    if (c < 0)
        return 0x1.921fb54442d18p+1 - angle(-c, s);
    double t = s / (c + sqrt(c * c + s * s)), sum = 0;
    t = t / (1 + sqrt(1 + t * t));
    t = t / (1 + sqrt(1 + t * t)); /* below 0.2: an eighth of the angle */
    for (int k = 23; k >= 1; k -= 2)
        sum = (k % 4 == 1 ? 1.0 : -1.0) / k + t * t * sum;
    return 8 * t * sum;
}

typedef struct {
    double area, x, y, square; /* moments: of 1, of x and y, of their squares' sum */
} moments;

/* From the origin to an edge. */
static void add_triangle(moments *m, const double *p, const double *q) {
    const double area = (p[0] * q[1] - p[1] * q[0]) / 2;
    const double x = p[0] + q[0], y = p[1] + q[1];
    m->area += area;
    m->x += area * x / 3;
    m->y += area * y / 3;
    m->square +=
        area / 6 *
        (p[0] * p[0] + p[1] * p[1] + q[0] * q[0] + q[1] * q[1] + p[0] * q[0] + p[1] * q[1]);
}

/* A strip of width r outside an edge with the normal n. */
static void add_strip(moments *m, const double *p, const double *q, const double *n, double r) {
    const double ex = q[0] - p[0], ey = q[1] - p[1], length = sqrt(ex * ex + ey * ey);
    const double area = length * r;
    const double x = (p[0] + q[0]) / 2 + n[0] * r / 2, y = (p[1] + q[1]) / 2 + n[1] * r / 2;
    m->area += area;
    m->x += area * x;
    m->y += area * y;
    m->square += area * (x * x + y * y + (length * length + r * r) / 12);
}

/* The sector around a corner between two normals. */
static void add_sector(moments *m, const double *p, const double *from, const double *to,
                       double turn, double r) {
    const double area = turn * r * r / 2, third = r * r * r / 3;
    const double x = third * (to[1] - from[1]), y = third * (from[0] - to[0]);
    m->area += area;
    m->x += area * p[0] + x;
    m->y += area * p[1] + y;
    m->square +=
        turn * r * r * r * r / 4 + 2 * (p[0] * x + p[1] * y) + area * (p[0] * p[0] + p[1] * p[1]);
}

fp3_mass2 fp3_weigh2(const fp3_shape2 *shape, double density) {
    const uint32_t count = shape->core.count;
    const double r = (double)shape->radius;
    const fp3_point2 at = shape->middle; /* the origin of the moments: nothing cancels far away */
    double p[FP3_CORNERS2][2], n[FP3_CORNERS2][2];
    moments m = {0, 0, 0, 0};
    for (uint32_t i = 0; i < count; i++) {
        p[i][0] = (double)shape->core.corner.x[i] - (double)at.x;
        p[i][1] = (double)shape->core.corner.y[i] - (double)at.y;
    }
    for (uint32_t i = 0; i < count && count > 1; i++) {
        const double *const a = p[i], *const b = p[i + 1 < count ? i + 1 : 0];
        const double x = b[0] - a[0], y = b[1] - a[1], length = sqrt(x * x + y * y);
        n[i][0] = length > 0 ? y / length : 0;
        n[i][1] = length > 0 ? -x / length : 0;
        add_triangle(&m, a, b);
        add_strip(&m, a, b, n[i], r);
    }
    const double round[2] = {1, 0};
    if (count == 1)
        add_sector(&m, p[0], round, round, 0x1.921fb54442d18p+2, r);
    for (uint32_t i = 0; i < count && count > 1; i++) {
        const double *const a = n[i ? i - 1 : count - 1], *const b = n[i];
        const double s = a[0] * b[1] - a[1] * b[0];
        add_sector(&m, p[i], a, b, angle(a[0] * b[0] + a[1] * b[1], s > 0 ? s : 0), r);
    }
    const double x = m.area > 0 ? m.x / m.area : 0, y = m.area > 0 ? m.y / m.area : 0;
    const double inertia = m.square - m.area * (x * x + y * y);
    return (fp3_mass2){density * m.area, (double)at.x + x, (double)at.y + y, density * inertia};
}

fp3_mass2 fp3_weigh_together2(const fp3_mass2 *parts, size_t count) {
    fp3_mass2 all = {0, 0, 0, 0};
    for (size_t i = 0; i < count; i++) {
        all.mass += parts[i].mass;
        all.x += parts[i].mass * parts[i].x;
        all.y += parts[i].mass * parts[i].y;
    }
    all.x = all.mass > 0 ? all.x / all.mass : 0;
    all.y = all.mass > 0 ? all.y / all.mass : 0;
    for (size_t i = 0; i < count; i++) {
        const double x = parts[i].x - all.x, y = parts[i].y - all.y;
        all.inertia += parts[i].inertia + parts[i].mass * (x * x + y * y);
    }
    return all;
}
