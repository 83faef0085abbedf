/* SPDX-License-Identifier: Apache-2.0 */
/* values.c - values of bodies by their names, and a hash of all. */
#include "own.h"
#include "turn.h"

#include "base/host.h"
#include "base/nearest.h"

#include <math.h>
#include <string.h>

typedef enum {
    X_X,
    X_Y,
    ANGLE,
    V_X,
    V_Y,
    W,
    FORCE_X,
    FORCE_Y,
    TORQUE,
    MASS,
    INERTIA,
    AT_REST
} value;

/* A name is of one value of a body or of two. */
typedef struct {
    const char *name;
    value first;
    uint32_t width;
} named;

static const named names[] = {
    {"x", X_X, 2},         {"x_x", X_X, 1},         {"x_y", X_Y, 1},         {"angle", ANGLE, 1},
    {"v", V_X, 2},         {"v_x", V_X, 1},         {"v_y", V_Y, 1},         {"w", W, 1},
    {"force", FORCE_X, 2}, {"force_x", FORCE_X, 1}, {"force_y", FORCE_Y, 1}, {"torque", TORQUE, 1},
    {"mass", MASS, 1},     {"inertia", INERTIA, 1}, {"at_rest", AT_REST, 1}};

static fp3_status find(const fp3_bodies *bodies, const char *name, const named **found) {
    const char *best = NULL;
    const fp3_token wanted = {.text = name, .length = strlen(name)};
    for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
        if (strcmp(name, names[i].name) == 0) {
            *found = &names[i];
            return FP3_OK;
        }
        fp3_nearest(wanted, names[i].name, &best);
    }
    return fp3_fail(bodies->error, FP3_E_ARGUMENT, "bodies have no value '%s' (did you mean '%s'?)",
                    name, best ? best : "x");
}

/* The centre of mass from the origin, in the world's axes. */
static void centre_of(const fp3_body *body, double centre[2]) {
    const double c = body->turn[0], s = body->turn[1];
    centre[0] = c * body->centre[0] - s * body->centre[1];
    centre[1] = s * body->centre[0] + c * body->centre[1];
}

static double get(const fp3_body *body, value which) {
    double centre[2];
    centre_of(body, centre);
    switch (which) {
    case X_X:
        return body->at[0] - centre[0];
    case X_Y:
        return body->at[1] - centre[1];
    case ANGLE:
        return body->angle;
    case V_X:
        return body->v[0];
    case V_Y:
        return body->v[1];
    case W:
        return body->w;
    case FORCE_X:
        return body->force[0];
    case FORCE_Y:
        return body->force[1];
    case TORQUE:
        return body->torque;
    case MASS:
        return body->mass;
    case INERTIA:
        return body->inertia;
    default:
        return body->rest;
    }
}

static void set(fp3_body *body, value which, double x) {
    double centre[2], turn[2];
    centre_of(body, centre);
    switch (which) {
    case X_X:
        body->at[0] = x + centre[0];
        break;
    case X_Y:
        body->at[1] = x + centre[1];
        break;
    case ANGLE:
        fp3_turn2_of(x, turn);
        body->at[0] -= centre[0];
        body->at[1] -= centre[1];
        body->turn[0] = (float)turn[0];
        body->turn[1] = (float)turn[1];
        body->angle = x;
        centre_of(body, centre);
        body->at[0] += centre[0];
        body->at[1] += centre[1];
        break;
    case V_X:
        body->v[0] = (float)x;
        break;
    case V_Y:
        body->v[1] = (float)x;
        break;
    case W:
        body->w = (float)x;
        break;
    case FORCE_X:
        body->force[0] = (float)x;
        break;
    case FORCE_Y:
        body->force[1] = (float)x;
        break;
    case TORQUE:
        body->torque = (float)x;
        break;
    case MASS:
        body->mass = (float)x;
        break;
    default:
        body->inertia = (float)x;
    }
}

fp3_status fp3_bodies_read(fp3_bodies *bodies, const char *name, const uint64_t *handles,
                           size_t count, double *values) {
    FP3_HOST;
    const named *which = NULL;
    uint32_t number;
    fp3_status status = find(bodies, name, &which);
    for (size_t i = 0; !status && i < count; i++)
        status = fp3_bodies_numbered(bodies, handles, i, &number);
    for (size_t i = 0; !status && i < count; i++)
        for (uint32_t k = 0; k < which->width; k++)
            *values++ = get(&bodies->body[(uint32_t)handles[i]], which->first + k);
    return status;
}

/* A mass or an inertia has to be a float above 0 whose inverse is one, too. */
#define LEAST 1e-36

static fp3_status check(const fp3_bodies *bodies, const named *which, const uint64_t *handles,
                        size_t i, const double *values) {
    const value first = which->first;
    uint32_t number;
    const fp3_status status = fp3_bodies_numbered(bodies, handles, i, &number);
    if (status)
        return status;
    const fp3_body *body = &bodies->body[number];
    if (first == AT_REST)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "at_rest cannot be written: any other value "
                        "that is written wakes a body");
    if (body->may_not_turn && (first == W || first == INERTIA))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT, "%s %zu: the body may not turn", which->name,
                        i);
    if (body->type == FP3_STATIC && first >= V_X && first <= TORQUE)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT, "%s %zu: the body is static", which->name,
                        i);
    for (uint32_t k = 0; k < which->width; k++) {
        const double x = values[i * which->width + k];
        if (!(fabs(x) <= 1e12))
            return fp3_fail(bodies->error, FP3_E_ARGUMENT, "%s %zu is %g, expected -1e12 to 1e12",
                            names[which - names + (which->width > 1) * (k + 1)].name, i, x);
        if ((first == MASS || first == INERTIA) && (body->type != FP3_DYNAMIC || !(x >= LEAST)))
            return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                            "%s %zu is %g, expected %g to 1e12, of a dynamic body", which->name, i,
                            x, LEAST);
    }
    return FP3_OK;
}

fp3_status fp3_bodies_write(fp3_bodies *bodies, const char *name, const uint64_t *handles,
                            size_t count, const double *values) {
    FP3_HOST;
    const named *which = NULL;
    fp3_status status = find(bodies, name, &which);
    for (size_t i = 0; !status && i < count; i++)
        status = check(bodies, which, handles, i, values);
    if (!status)
        fp3_bodies_wake_around(bodies, handles, count);
    for (size_t i = 0; !status && i < count; i++) {
        const uint32_t number = (uint32_t)handles[i];
        for (uint32_t k = 0; k < which->width; k++)
            set(&bodies->body[number], which->first + k, *values++);
        if (which->first <= ANGLE)
            fp3_bodies_place_boxes(bodies, number);
    }
    return status;
}

/* ---- a hash ---- */

static uint64_t add(uint64_t hash, const void *bytes, size_t size) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ b[i]) * 0x100000001b3u;
    return hash;
}

uint64_t fp3_bodies_hash(const fp3_bodies *bodies) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (uint32_t i = 0; i < bodies->body_count; i++) {
        const fp3_body *b = &bodies->body[i];
        if (!fp3_body_lives(b))
            continue;
        hash = add(hash, b->at, sizeof b->at);
        hash = add(hash, b->turn, sizeof b->turn);
        hash = add(hash, b->v, sizeof b->v);
        hash = add(hash, &b->w, sizeof b->w);
        hash = add(hash, &b->rest, sizeof b->rest);
    }
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        const fp3_touch2 *t = &bodies->touch[k];
        if (!t->points)
            continue;
        hash = add(hash, &t->a, sizeof t->a);
        hash = add(hash, &t->b, sizeof t->b);
        hash = add(hash, t->p, sizeof t->p);
        hash = add(hash, t->f, sizeof t->f);
        hash = add(hash, &t->r, sizeof t->r);
    }
    return hash;
}
