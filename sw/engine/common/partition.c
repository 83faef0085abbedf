/* SPDX-License-Identifier: Apache-2.0 */
/* partition.c - see partition.h.
 *
 * The objects of some lanes are divided in two, for one half of the lanes and the other: a walk in
 * breadth begins at an object far from the others, and the first half are those that it meets
 * first. Then each half likewise. What a walk meets at the same time is as wide as the structure,
 * so a cloth is cut along straight lines, or diagonals that cost the same.
 */
#include "partition.h"

#include "backend.h"

#include <stdlib.h>
#include <string.h>

typedef struct {
    const fp3_engine *engine;
    const fp3_lists *lists;
    uint32_t *order; /* objects, as they stand now */
    uint32_t *walk;  /* those that the walk has met */
    uint32_t *part;  /* of each object: the number of the walk that may meet it */
    uint32_t parts;
} partition;

/* Meets an object that it has not met yet, and is no guest. Who does not live is in no list. */
static uint32_t meet(partition *p, uint32_t object, uint32_t part, uint32_t count) {
    if (object >= p->engine->layout.groups[0].objects || p->part[object] != part)
        return count;
    p->part[object] = part + 1;
    p->walk[count] = object;
    return count + 1;
}

static uint32_t meet_neighbours(partition *p, uint32_t object, uint32_t part, uint32_t count) {
    for (uint32_t k = 0; k < p->lists->shape.list_count; k++) {
        const fp3_list *list = &p->lists->lists[k];
        if (list->begin) /* all others say nothing about who is close */
            for (uint32_t i = list->begin[object]; i < list->begin[object + 1]; i++)
                count = meet(p, list->other[i], part, count);
    }
    return count;
}

/* A walk through the objects at begin .. end of the order, from one of them. The last that is
 * connected with that one. */
static uint32_t walk(partition *p, uint32_t begin, uint32_t end, uint32_t from) {
    const uint32_t part = p->parts += 2;
    uint32_t count = 0, far = from, next = 0;
    for (uint32_t i = begin; i < end; i++)
        p->part[p->order[i]] = part;
    count = meet(p, from, part, count);
    for (uint32_t i = begin; i < end; i++) {
        for (; next < count; next++)
            count = meet_neighbours(p, p->walk[next], part, count);
        far = i == begin ? p->walk[count - 1] : far;
        count = meet(p, p->order[i], part, count);
    }
    return far;
}

/* How many of `count` objects the lanes before this one have: the first lanes have one more. */
static uint32_t before(const partition *p, uint32_t count, uint32_t lane) {
    const uint32_t lanes = p->engine->config->lanes, more = count % lanes;
    return lane * (count / lanes) + (lane < more ? lane : more);
}

/* all: as all lanes have. */
static void divide(partition *p, uint32_t all, uint32_t lane, uint32_t lanes) {
    const uint32_t begin = before(p, all, lane), count = before(p, all, lane + lanes) - begin;
    if (lanes < 2 || count < 2)
        return;
    walk(p, begin, begin + count, walk(p, begin, begin + count, p->order[begin]));
    memcpy(p->order + begin, p->walk, count * sizeof *p->walk);
    divide(p, all, lane, lanes / 2);
    divide(p, all, lane + lanes / 2, lanes - lanes / 2);
}

fp3_status fp3_partition_find(const fp3_engine *engine, uint32_t *slot) {
    const fp3_members *group = &engine->layout.groups[0];
    const fp3_living *living = group->lists.living;
    const uint32_t objects = group->objects, count = living ? living->count : objects;
    uint32_t *words = malloc(3 * (size_t)objects * sizeof *words), behind = count;
    if (!words)
        return fp3_no_memory(engine->def.error);
    partition p = {engine, &group->lists, words, words + objects, words + 2 * (size_t)objects, 0};
    for (uint32_t i = 0; i < objects; i++) {
        p.order[i] = living && i < count ? living->who[i] : i;
        p.part[i] = 0;
    }
    divide(&p, count, 0, engine->config->lanes);
    for (uint32_t i = 0; i < count; i++)
        slot[p.order[i]] = i;
    for (uint32_t i = 0; living && i < objects; i++)
        if (!living->is[i])
            slot[i] = behind++;
    free(words);
    return FP3_OK;
}
