/* SPDX-License-Identifier: Apache-2.0 */
/* hash.c - all of a world that the next steps follow from, as a number. */
#include "own3.h"

static uint64_t add(uint64_t hash, const void *bytes, size_t size) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ b[i]) * 0x100000001b3u;
    return hash;
}

static uint64_t add_patch(uint64_t hash, const fp3_patch3 *p) {
    hash = add(hash, &p->a, sizeof p->a);
    hash = add(hash, &p->b, sizeof p->b);
    hash = add(hash, &p->part, sizeof p->part);
    hash = add(hash, p->p, sizeof p->p);
    hash = add(hash, p->f, sizeof p->f);
    hash = add(hash, &p->twist, sizeof p->twist);
    return add(hash, p->roll, sizeof p->roll);
}

uint64_t fp3_bodies_hash(const fp3_bodies *bodies) {
    uint64_t hash = 0xcbf29ce484222325u;
    for (uint32_t i = 0; i < bodies->body_count; i++) {
        const fp3_body *b = &bodies->body[i];
        if (!fp3_body_lives(b))
            continue;
        if (bodies->space) {
            const fp3_body3 *space = &bodies->space->body[i];
            hash = add(hash, b->at, sizeof b->at);
            hash = add(hash, space->q, sizeof space->q);
            hash = add(hash, b->v, sizeof b->v);
            hash = add(hash, space->spin, sizeof space->spin);
        } else {
            hash = add(hash, b->at, 2 * sizeof *b->at);
            hash = add(hash, b->turn, sizeof b->turn);
            hash = add(hash, b->v, 2 * sizeof *b->v);
            hash = add(hash, &b->w, sizeof b->w);
        }
        hash = add(hash, &b->rest, sizeof b->rest);
    }
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        const fp3_touch2 *t = &bodies->touch[k];
        for (uint32_t i = 0; bodies->space && i < t->patches; i++)
            hash = add_patch(hash, &bodies->space->patch[t->first_patch + i]);
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
