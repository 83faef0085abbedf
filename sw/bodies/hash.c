/* SPDX-License-Identifier: Apache-2.0 */
/* hash.c - where bodies of a world are, how they move, who sleeps, and the impulses of contacts, as
 * a number. A step also depends on what does not follow from these (fields.h): masses, joints and
 * their impulses, forces, settings. */
#include "own3.h"

static uint64_t add(uint64_t hash, const void *bytes, size_t size) {
    const unsigned char *b = bytes;
    for (size_t i = 0; i < size; i++)
        hash = (hash ^ b[i]) * 0x100000001b3u;
    return hash;
}

static void add_patch(fp3_words_fn *add, void *user, const fp3_patch3 *p) {
    add(user, &p->a, sizeof p->a);
    add(user, &p->b, sizeof p->b);
    add(user, &p->part, sizeof p->part);
    add(user, p->p, sizeof p->p);
    add(user, p->f, sizeof p->f);
    add(user, &p->twist, sizeof p->twist);
    add(user, p->roll, sizeof p->roll);
}

void fp3_bodies_words(const fp3_bodies *bodies, fp3_words_fn *add, void *user) {
    for (uint32_t i = 0; i < bodies->body_count; i++) {
        const fp3_body *b = &bodies->body[i];
        if (!fp3_body_lives(b))
            continue;
        if (bodies->space) {
            const fp3_body3 *space = &bodies->space->body[i];
            add(user, b->at, sizeof b->at);
            add(user, space->q, sizeof space->q);
            add(user, b->v, sizeof b->v);
            add(user, space->spin, sizeof space->spin);
        } else {
            add(user, b->at, 2 * sizeof *b->at);
            add(user, b->turn, sizeof b->turn);
            add(user, b->v, 2 * sizeof *b->v);
            add(user, &b->w, sizeof b->w);
        }
        add(user, &b->rest, sizeof b->rest);
    }
    for (uint32_t k = 0; k < bodies->touch_count; k++) {
        const fp3_touch2 *t = &bodies->touch[k];
        for (uint32_t i = 0; bodies->space && i < t->patches; i++)
            add_patch(add, user, &bodies->space->patch[t->first_patch + i]);
        if (!t->points)
            continue;
        add(user, &t->a, sizeof t->a);
        add(user, &t->b, sizeof t->b);
        add(user, t->p, sizeof t->p);
        add(user, t->f, sizeof t->f);
        add(user, &t->r, sizeof t->r);
    }
}

void fp3_words_hash(void *user, const void *data, size_t size) {
    uint64_t *hash = user;
    *hash = add(*hash, data, size);
}

uint64_t fp3_bodies_hash(const fp3_bodies *bodies) {
    uint64_t hash = 0xcbf29ce484222325u;
    fp3_bodies_words(bodies, fp3_words_hash, &hash);
    return hash;
}
