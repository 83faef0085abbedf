/* SPDX-License-Identifier: Apache-2.0 */
/* values.c - values of bodies by their names, and a hash of all. */
#include "own3.h"
#include "turn.h"

#include "base/host.h"
#include "base/nearest.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

typedef enum { X, ANGLE, Q, V, W, SPIN, FORCE, TORQUE, MASS, INERTIA, AT_REST, VALUES } value;

/* How many numbers each is, in a plane and in space; 0: there is no such value. */
static const struct {
    const char *name;
    uint32_t width[2];
} values_of[VALUES] = {{"x", {2, 3}},       {"angle", {1, 0}},  {"q", {0, 4}},
                       {"v", {2, 3}},       {"w", {1, 0}},      {"spin", {0, 3}},
                       {"force", {2, 3}},   {"torque", {1, 3}}, {"mass", {1, 1}},
                       {"inertia", {1, 3}}, {"at_rest", {1, 1}}};

/* A name is of all numbers of a value, or of one: v, v_x. */
typedef struct {
    char name[16];
    value of;
    uint32_t first, width;
} named;

static fp3_status find(const fp3_bodies *bodies, const char *name, named *found) {
    const char *best = NULL;
    const fp3_token wanted = {.text = name, .length = strlen(name)};
    const int is_space = bodies->space != NULL;
    static const char *const axis[2] = {"xyz", "wxyz"};
    for (int v = 0; v < VALUES; v++) {
        const uint32_t width = values_of[v].width[is_space];
        const char *own = values_of[v].name;
        *found = (named){.of = (value)v, .width = width};
        snprintf(found->name, sizeof found->name, "%s", own);
        if (width && strcmp(name, own) == 0)
            return FP3_OK;
        for (uint32_t k = 0; width > 1 && k < width; k++) {
            snprintf(found->name, sizeof found->name, "%s_%c", own, axis[width == 4][k]);
            found->first = k;
            found->width = 1;
            if (strcmp(name, found->name) == 0)
                return FP3_OK;
        }
        if (width)
            fp3_nearest(wanted, own, &best);
    }
    /* What a plane calls otherwise. */
    if (strcmp(name, "angle") == 0 || strcmp(name, "q") == 0)
        best = is_space ? "q" : "angle";
    if (strcmp(name, "w") == 0 || strcmp(name, "spin") == 0)
        best = is_space ? "spin" : "w";
    return fp3_fail(bodies->error, FP3_E_ARGUMENT, "bodies have no value '%s' (did you mean '%s'?)",
                    name, best ? best : "x");
}

/* The centre of mass from the origin, in the world's axes. */
static void centre_of(const fp3_bodies *bodies, uint32_t number, double centre[3]) {
    const fp3_body *body = &bodies->body[number];
    if (bodies->space) {
        const float origin[3] = {0, 0, 0};
        double back[3];
        fp3_space_arm(bodies, number, origin, back);
        for (int i = 0; i < 3; i++)
            centre[i] = -back[i];
        return;
    }
    const double c = body->turn[0], s = body->turn[1];
    centre[0] = c * body->centre[0] - s * body->centre[1];
    centre[1] = s * body->centre[0] + c * body->centre[1];
    centre[2] = 0;
}

static double get(const fp3_bodies *bodies, uint32_t number, value which, uint32_t k) {
    const fp3_body *body = &bodies->body[number];
    const fp3_body3 *space = bodies->space ? &bodies->space->body[number] : NULL;
    double centre[3];
    switch (which) {
    case X:
        centre_of(bodies, number, centre);
        return body->at[k] - centre[k];
    case ANGLE:
        return body->angle;
    case Q:
        return space->q[k];
    case V:
        return body->v[k];
    case W:
        return body->w;
    case SPIN:
        return space->spin[k];
    case FORCE:
        return body->force[k];
    case TORQUE:
        return space ? space->torque[k] : body->torque;
    case MASS:
        return body->mass;
    case INERTIA:
        return space ? space->moment[k] : body->inertia;
    default:
        return body->rest;
    }
}

/* A new turn: the origin stays where it is. */
static void turn_to(fp3_bodies *bodies, uint32_t number, double angle, const double q[4]) {
    fp3_body *body = &bodies->body[number];
    double before[3], after[3], turn[2];
    centre_of(bodies, number, before);
    if (bodies->space) {
        memcpy(bodies->space->body[number].q, q, sizeof bodies->space->body[number].q);
    } else {
        fp3_turn2_of(angle, turn);
        body->turn[0] = (float)turn[0];
        body->turn[1] = (float)turn[1];
        body->angle = angle;
    }
    centre_of(bodies, number, after);
    for (int i = 0; i < 3; i++) {
        body->at[i] -= before[i];
        body->at[i] += after[i];
    }
}

static void set(fp3_bodies *bodies, uint32_t number, value which, uint32_t k, double x) {
    fp3_body *body = &bodies->body[number];
    fp3_body3 *space = bodies->space ? &bodies->space->body[number] : NULL;
    double centre[3];
    switch (which) {
    case X:
        centre_of(bodies, number, centre);
        body->at[k] = x + centre[k];
        break;
    case ANGLE:
        turn_to(bodies, number, x, NULL);
        break;
    case V:
        body->v[k] = (float)x;
        break;
    case W:
        body->w = (float)x;
        break;
    case SPIN:
        space->spin[k] = (float)x;
        break;
    case FORCE:
        body->force[k] = (float)x;
        break;
    case TORQUE:
        *(space ? &space->torque[k] : &body->torque) = (float)x;
        break;
    case MASS:
        body->mass = (float)x;
        break;
    default:
        *(space ? &space->moment[k] : &body->inertia) = (float)x;
    }
}

fp3_status fp3_bodies_read(fp3_bodies *bodies, const char *name, const uint64_t *handles,
                           size_t count, double *values) {
    FP3_HOST;
    named which;
    uint32_t number;
    fp3_status status = find(bodies, name, &which);
    for (size_t i = 0; !status && i < count; i++)
        status = fp3_bodies_numbered(bodies, handles, i, &number);
    for (size_t i = 0; !status && i < count; i++)
        for (uint32_t k = 0; k < which.width; k++)
            *values++ = get(bodies, (uint32_t)handles[i], which.of, which.first + k);
    return status;
}

/* A mass or an inertia has to be a float above 0 whose inverse is one, too. */
#define LEAST 1e-36

static fp3_status check(const fp3_bodies *bodies, const named *which, const uint64_t *handles,
                        size_t i, const double *values) {
    const value of = which->of;
    uint32_t number;
    const fp3_status status = fp3_bodies_numbered(bodies, handles, i, &number);
    if (status)
        return status;
    const fp3_body *body = &bodies->body[number];
    if (of == AT_REST)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "at_rest cannot be written: any other value "
                        "that is written wakes a body");
    if (body->may_not_turn && (of == W || of == SPIN || of == INERTIA))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT, "%s[%zu]: the body may not turn",
                        which->name, i);
    if (body->type == FP3_STATIC && of >= V && of <= TORQUE)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT, "%s[%zu]: the body is static", which->name,
                        i);
    if (of == INERTIA && which->width == 1 && bodies->space &&
        !(bodies->space->body[number].moment[0] > 0))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "%s[%zu]: the body has no inertia, expected all three numbers", which->name,
                        i);
    double square = 0;
    for (uint32_t k = 0; k < which->width; k++) {
        const double x = values[i * which->width + k];
        square += x * x;
        if (!(fabs(x) <= 1e12))
            return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                            "%s%s%.1s[%zu] is %g, expected -1e12 to 1e12", which->name,
                            which->width > 1 ? "_" : "",
                            which->width > 1 ? (which->width == 4 ? "wxyz" : "xyz") + k : "", i, x);
        if ((of == MASS || of == INERTIA) && (body->type != FP3_DYNAMIC || !(x >= LEAST)))
            return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                            "%s[%zu] is %g, expected %g to 1e12, of a dynamic body", which->name, i,
                            x, LEAST);
    }
    if (of == Q && which->width == 1)
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "%s cannot be written alone: expected all four numbers of q", which->name);
    if (of == Q && !(square >= 1e-6 && square <= 1e6))
        return fp3_fail(bodies->error, FP3_E_ARGUMENT,
                        "q[%zu] has the length %g, expected 1e-3 to 1e3", i, sqrt(square));
    return FP3_OK;
}

static void set_all(fp3_bodies *bodies, uint32_t number, const named *which, const double *values) {
    if (which->of == Q) {
        const double size = sqrt((values[0] * values[0] + values[1] * values[1]) +
                                 (values[2] * values[2] + values[3] * values[3]));
        turn_to(bodies, number, 0,
                (const double[]){values[0] / size, values[1] / size, values[2] / size,
                                 values[3] / size});
        return;
    }
    for (uint32_t k = 0; k < which->width; k++)
        set(bodies, number, which->of, which->first + k, values[k]);
}

fp3_status fp3_bodies_write(fp3_bodies *bodies, const char *name, const uint64_t *handles,
                            size_t count, const double *values) {
    FP3_HOST;
    named which;
    fp3_status status = find(bodies, name, &which);
    for (size_t i = 0; !status && i < count; i++)
        status = check(bodies, &which, handles, i, values);
    if (!status)
        fp3_bodies_wake_around(bodies, handles, count);
    for (size_t i = 0; !status && i < count; i++) {
        const uint32_t number = (uint32_t)handles[i];
        set_all(bodies, number, &which, values + i * which.width);
        if (which.of == X || which.of == ANGLE || which.of == Q)
            fp3_bodies_place_boxes(bodies, number);
    }
    return status;
}
