/* SPDX-License-Identifier: Apache-2.0 */
#include "clip3.h"

#define SLOPE 0.0009765625f

/* Outwards through the edge that begins at a corner; not of length 1. */
static fp3_point3 outwards(const fp3_side3 *face, uint32_t i, fp3_point3 normal) {
    const fp3_point3 a = face->corner[i], b = face->corner[i + 1 < face->count ? i + 1 : 0];
    return fp3_cross3(fp3_subtract3(b, a), normal);
}

/* A norm that needs no root: between 1 and 1.8 times the length. */
static float norm(fp3_point3 a) { return (fabsf(a.x) + fabsf(a.y)) + fabsf(a.z); }

static void cut_segment(float first, float last, float slack, fp3_side3 *side) {
    const int is_out = first > slack, other_is_out = last > slack;
    if (is_out && other_is_out) {
        side->count = 0;
    } else if (is_out != other_is_out) {
        const float s = first / (first - last);
        side->corner[is_out ? 0 : 1] =
            fp3_along3(side->corner[0], s, fp3_subtract3(side->corner[1], side->corner[0]));
    }
}

/* One plane of Sutherland and Hodgman, "Reentrant polygon clipping", CACM 17, 1974. A side that
 * goes out crosses the plane itself, whatever the slack. */
static void cut(const float *out, float slack, fp3_side3 *side) {
    fp3_point3 left[FP3_CLIPPED3];
    uint32_t count = 0;
    for (uint32_t i = 0; i < side->count; i++) {
        const uint32_t j = i + 1 < side->count ? i + 1 : 0;
        if (!(out[i] > slack) && count < FP3_CLIPPED3)
            left[count++] = side->corner[i];
        if ((out[i] > slack) != (out[j] > slack) && count < FP3_CLIPPED3) {
            float s = out[i] / (out[i] - out[j]);
            s = s > 0 ? (s < 1 ? s : 1) : 0;
            left[count++] =
                fp3_along3(side->corner[i], s, fp3_subtract3(side->corner[j], side->corner[i]));
        }
    }
    side->count = count;
    for (uint32_t i = 0; i < count; i++)
        side->corner[i] = left[i];
}

void fp3_clip3(const fp3_side3 *face, fp3_point3 normal, float slack, fp3_side3 *side) {
    for (uint32_t i = 0; i < face->count && side->count; i++) {
        const fp3_point3 n = outwards(face, i, normal);
        const float most = slack * norm(n);
        float out[FP3_CLIPPED3];
        int is_any = 0;
        for (uint32_t k = 0; k < side->count; k++) {
            out[k] = fp3_dot3(n, fp3_subtract3(side->corner[k], face->corner[i]));
            is_any |= out[k] > most;
        }
        if (!is_any)
            continue;
        if (side->count > 2)
            cut(out, most, side);
        else if (side->count == 2)
            cut_segment(out[0], out[1], most, side);
        else
            side->count = 0;
    }
}

static fp3_point3 slant(fp3_point3 n) {
    const float x = fabsf(n.x), y = fabsf(n.y), z = fabsf(n.z);
    const fp3_point3 axis = x <= y && x <= z ? (fp3_point3){1, 0, 0}
                            : y <= z         ? (fp3_point3){0, 1, 0}
                                             : (fp3_point3){0, 0, 1};
    const fp3_point3 t = fp3_along3(axis, -fp3_dot3(axis, n), n);
    return fp3_along3(fp3_times3(0.8f, t), 0.6f, fp3_cross3(n, t));
}

static void swap(fp3_touch3 *a, fp3_touch3 *b) {
    const fp3_touch3 c = *a;
    *a = *b;
    *b = c;
}

/* The index of the most, where it is more than `least`; else count. */
static uint32_t most_of(uint32_t count, const float *value, float least) {
    uint32_t best = count;
    for (uint32_t i = 0; i < count; i++)
        if (value[i] > least) {
            least = value[i];
            best = i;
        }
    return best;
}

/* By how much a point is farther from the other surface than the first one, beyond a slope along
 * that way. Whatever overlaps counts as no farther. */
static float beyond(const fp3_touch3 *first, const fp3_touch3 *point, float way) {
    const float least = first->gap > 0 ? first->gap : 0, more = point->gap - least - SLOPE * way;
    return more > 0 ? more : 0;
}

static void choose(fp3_point3 normal, fp3_point3 u, uint32_t *count, fp3_touch3 *touch) {
    float value[FP3_CLIPPED3];
    for (uint32_t i = 0; i < *count; i++)
        value[i] = SLOPE * fp3_dot3(u, touch[i].at) - touch[i].gap;
    swap(&touch[0], &touch[most_of(*count, value, -INFINITY)]);
    const fp3_point3 at = touch[0].at;
    for (uint32_t i = 0; i < *count; i++) {
        const fp3_point3 d = fp3_subtract3(touch[i].at, at);
        value[i] = fp3_dot3(d, d);
        const float way = sqrtf(value[i]), less = beyond(&touch[0], &touch[i], way);
        if (less > 0)
            value[i] = way > less ? (way - less) * (way - less) : 0;
    }
    const uint32_t far = most_of(*count, value, 0);
    if (far == *count) {
        *count = 1;
        return;
    }
    swap(&touch[1], &touch[far]);
    const fp3_point3 e = fp3_subtract3(touch[1].at, at);
    const float least = 1e-4f * fp3_dot3(e, e), size = fp3_size3(e);
    float less[FP3_CLIPPED3] = {0};
    for (uint32_t i = 0; i < *count; i++) {
        less[i] = size * beyond(&touch[0], &touch[i], size);
        value[i] = fp3_dot3(normal, fp3_cross3(e, fp3_subtract3(touch[i].at, at))) - less[i];
    }
    const uint32_t left = most_of(*count, value, least);
    for (uint32_t i = 0; i < *count; i++)
        value[i] = -value[i] - 2 * less[i];
    const uint32_t right = most_of(*count, value, least);
    const int has_left = left < *count, has_right = right < *count;
    const fp3_touch3 second = touch[1], third = touch[has_left ? left : 0];
    uint32_t n = 1; /* anticlockwise: right of the line, its end, left of it */
    const fp3_touch3 first = touch[has_right ? right : 0];
    if (has_right)
        touch[n++] = first;
    touch[n++] = second;
    if (has_left)
        touch[n++] = third;
    *count = n;
}

void fp3_reduce3(fp3_point3 normal, uint32_t *count, fp3_touch3 *touch) {
    const fp3_point3 u = slant(normal);
    if (*count > 4)
        choose(normal, u, count, touch);
    uint32_t best = 0;
    for (uint32_t i = 1; i < *count; i++)
        if (fp3_dot3(u, touch[i].at) > fp3_dot3(u, touch[best].at))
            best = i;
    fp3_touch3 turned[4];
    for (uint32_t i = 0; i < *count; i++)
        turned[i] = touch[(best + i) % *count];
    for (uint32_t i = 0; i < *count; i++)
        touch[i] = turned[i];
}
