/* SPDX-License-Identifier: Apache-2.0 */
/* open.c - a world is opened and closed; its memory. */
#include "guess.h"
#include "heavy.h"
#include "own3.h"
#include "share.h"

#include "base/definition.h"
#include "base/host.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

void fp3_bodies_set_default(fp3_bodies_def *def, size_t size) {
    if (!fp3_definition_begin(def, size, sizeof *def))
        return;
    def->dimensions = 2;
    def->gravity[1] = -9.81;
    def->h = 1.0 / 60;
    def->substeps = 4;
    def->threads = 1;
    def->size = 1;
    def->push = 3;
    def->bounce = 1;
    def->rest_speed = 0.05;
    def->rest_time = 0.5;
}

void fp3_body_set_default(fp3_body_def *def, size_t size) {
    memset(def, 0, size);
    if (size != sizeof *def)
        return;
    def->type = FP3_DYNAMIC;
    def->gravity = 1;
    def->q[0] = 1;
}

void fp3_shape_set_default(fp3_shape_def *def, size_t size) {
    if (size != sizeof *def) {
        memset(def, 0, size);
        return;
    }
    *def = (fp3_shape_def){.type = FP3_CIRCLE,
                           .radius = 0.5,
                           .density = 1,
                           .q = {1, 0, 0, 0},
                           .normal = {0, 1, 0},
                           .friction = 0.6,
                           .category = 1,
                           .mask = UINT32_MAX};
}

static fp3_status check(const fp3_bodies_def *def, fp3_error *error) {
    const double small = ldexp(1, -20), large = ldexp(1, 20);
    const int is_space = def->dimensions == 3;
    const fp3_bodies_range ranges[] = {
        {"dimensions", def->dimensions, 2, 3},
        {"h", def->h, small, 1},
        {"substeps", def->substeps, 1, FP3_SUBSTEPS},
        {"threads", def->threads, 0, 1024},
        {"size", def->size, small, large},
        {"gravity[0]", def->gravity[0], -1e9, 1e9},
        {"gravity[1]", def->gravity[1], -1e9, 1e9},
        {"gravity[2]", def->gravity[2], is_space ? -1e9 : 0, is_space ? 1e9 : 0},
        {"push", def->push, 0, 1e9},
        {"bounce", def->bounce, 0, 1e9},
        {"rest_speed", def->rest_speed, 0, 1e9},
        {"rest_time", def->rest_time, 0, 1e9},
    };
    const fp3_status status =
        fp3_ranges_check(ranges, sizeof ranges / sizeof *ranges, "", is_space, error);
    if (status)
        return status;
    if (def->engine && def->threads != 1)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "threads is %u, expected 1 with an engine: it executes laws in one thread",
                        def->threads);
    if ((def->laws || def->config || def->may_compile) && !def->engine)
        return fp3_fail(error, FP3_E_ARGUMENT,
                        "%s: expected an engine, too, which executes laws (\"fast\")",
                        def->laws     ? "laws"
                        : def->config ? "config"
                                      : "may_compile");
    return FP3_OK;
}

fp3_status fp3_bodies_open(const fp3_bodies_def *def, fp3_bodies **bodies) {
    FP3_HOST;
    fp3_error *error = def->error;
    *bodies = NULL;
    fp3_status status =
        fp3_definition_check(def, sizeof *def, "fp3_bodies_def", fp3_definition_error(def, error));
    if (!status)
        status = check(def, error);
    if (status)
        return status;
    fp3_bodies *made = calloc(1, sizeof *made);
    if (!made)
        return fp3_no_memory(error);
    made->identity = malloc(sizeof *made->identity);
    if (!made->identity) {
        free(made);
        return fp3_no_memory(error);
    }
    *made->identity = 1;
    made->def = *def;
    made->def.push *= def->size;
    made->def.bounce *= def->size;
    made->def.rest_speed *= def->size;
    made->error = def->error;
    made->boxes.dimensions = def->dimensions;
    const fp3_solver3 *space = NULL;
    status = fp3_solvers_choose(&made->solver, &space, error);
    if (!status && def->dimensions == 3)
        status = fp3_space_open(space, &made->space, error);
    const uint32_t threads = def->threads ? def->threads : fp3_threads_processors();
    if (!status)
        status = fp3_substeps_make(made);
    if (!status && threads > 1)
        status = fp3_threads_make(threads, &made->threads, error);
    if (!status && def->engine)
        status = fp3_laws_open(def, &made->laws, error);
    *bodies = made;
    if (status)
        fp3_bodies_close(bodies);
    return status;
}

void fp3_bodies_close(fp3_bodies **bodies) {
    fp3_bodies *b = *bodies;
    *bodies = NULL;
    if (!b)
        return;
    void *const arrays[] = {b->near,      b->substeps,  b->cut,          b->is_held, b->body,
                            b->shape,     b->boxes.box, b->boxes.filter, b->touch,   b->key,
                            b->in_slot,   b->speed,     b->way,          b->base,    b->pull,
                            b->heft,      b->merged,    b->joint,        b->apart,   b->apart_first,
                            b->change[0], b->change[1], b->change[2],    b->now,     b->before};
    fp3_threads_free(&b->threads); /* they may still read the stages */
    for (uint32_t i = 0; b->space && i < b->shape_count; i++)
        fp3_form_give_back(b->shape[i].form);
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++)
        free(arrays[i]);
    fp3_space_close(&b->space);
    fp3_rows_free(&b->contacts);
    for (int i = 0; i < FP3_JOINT_LAWS; i++)
        fp3_rows_free(&b->joined[i]);
    fp3_heavy_free(b);
    fp3_guess_free(b);
    fp3_share_free(b);
    fp3_laps_free(&b->laps);
    fp3_laws_close(&b->laws);
    fp3_identity_give_back(b->identity);
    free(b);
}
