/* SPDX-License-Identifier: Apache-2.0 */
/* layout.c - groups of objects: placed, found again. */
#include "layout.h"

#include "gen/registers.h"
#include <stdlib.h>
#include <string.h>

fp3_status fp3_layout_make(const fp3_config *config, uint32_t count, fp3_layout *layout,
                           fp3_error *error) {
    const uint32_t schedulers = fp3_config_schedulers(config);
    *layout = (fp3_layout){.groups = calloc(count, sizeof *layout->groups),
                           .count = count,
                           .schedulers = calloc(schedulers, sizeof *layout->schedulers),
                           .duty = calloc(schedulers, sizeof *layout->duty)};
    for (uint32_t i = 0; layout->groups && i < count; i++)
        layout->groups[i].rest = layout->groups[i].removed = -1;
    if (layout->groups && layout->schedulers && layout->duty)
        return FP3_OK;
    if (!layout->groups)
        layout->count = 0;
    fp3_layout_free(layout);
    return fp3_no_memory(error);
}

void fp3_layout_free(fp3_layout *layout) {
    for (uint32_t i = 0; i < layout->count; i++) {
        fp3_image_free(&layout->groups[i].image);
        fp3_visit_free(&layout->groups[i].visit);
        free(layout->groups[i].is_ahead);
        free(layout->groups[i].slot);
        free(layout->groups[i].who);
        for (uint32_t k = 0; k < layout->groups[i].foreign_count; k++) {
            free((char *)layout->groups[i].foreign[k].word);
            free((char *)layout->groups[i].foreign[k].of);
        }
        free(layout->groups[i].foreign);
        fp3_lists_close(&layout->groups[i].lists);
    }
    free(layout->groups);
    free(layout->schedulers);
    free(layout->duty);
    *layout = (fp3_layout){0};
}

/* ---- placing ---- */

/* The smallest n with 1 << n >= count. */
static uint32_t log2_of(uint32_t count) {
    uint32_t n = 0;
    while (1u << n < count)
        n++;
    return n;
}

/* All the words of the store that there is room for, up to its registers. */
static uint32_t record_of(const fp3_members *group, const fp3_config *config) {
    const uint32_t rows = fp3_placement_fullest(config, group->objects, group->scheduler_count);
    uint32_t log2 = log2_of(config->registers);
    if (log2 < FP3_RECORD_LOG2)
        log2 = FP3_RECORD_LOG2;
    while (config->interleave && rows << log2 > config->store_words)
        log2--;
    if (!group->lists.shape.is_any || !group->visit)
        return log2;
    /* Lists of neighbours take what records do not need. */
    return group->visit->log2 < FP3_RECORD_LOG2 ? FP3_RECORD_LOG2 : group->visit->log2;
}

static void settle(fp3_layout *layout, const fp3_config *config, const uint32_t *group_of) {
    const uint32_t schedulers = fp3_config_schedulers(config);
    uint32_t *next = layout->schedulers, first = 0;
    for (uint32_t i = 0; i < layout->count; i++) {
        fp3_members *group = &layout->groups[i];
        group->first = first;
        first += group->objects;
        group->schedulers = next;
        group->scheduler_count = 0;
        for (uint32_t scheduler = 0; scheduler < schedulers; scheduler++)
            if (group_of[scheduler] == i) {
                layout->duty[scheduler] = (fp3_duty){i, group->scheduler_count++};
                *next++ = scheduler;
            }
        group->columns = group->scheduler_count * config->lanes;
        group->log2 = record_of(group, config);
    }
}

fp3_status fp3_layout_place(fp3_layout *layout, const fp3_config *config, uint32_t visit,
                            fp3_error *error) {
    fp3_to_place *list = calloc(layout->count, sizeof *list);
    uint32_t *group_of = calloc(fp3_config_schedulers(config), sizeof *group_of);
    fp3_status status = list && group_of ? FP3_OK : fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < layout->count; i++) {
        const fp3_members *group = &layout->groups[i];
        list[i] = (fp3_to_place){&group->program, group->objects, group->needs};
    }
    if (!status)
        status = fp3_placement_make(config, visit, list, layout->count, group_of, error);
    if (!status)
        settle(layout, config, group_of);
    free(list);
    free(group_of);
    return status;
}

void fp3_layout_place_apart(fp3_layout *layout, const fp3_config *config) {
    const uint32_t schedulers = fp3_config_schedulers(config);
    uint32_t first = 0;
    for (uint32_t scheduler = 0; scheduler < schedulers; scheduler++) {
        layout->schedulers[scheduler] = scheduler;
        layout->duty[scheduler] = (fp3_duty){0, scheduler};
    }
    for (uint32_t i = 0; i < layout->count; i++) {
        fp3_members *group = &layout->groups[i];
        group->first = first;
        first += group->objects;
        group->schedulers = layout->schedulers;
        group->scheduler_count = schedulers;
        group->columns = schedulers * config->lanes;
        group->log2 = record_of(group, config);
    }
}

int fp3_layout_is_joined(const fp3_layout *layout) {
    for (uint32_t i = 0; i < layout->count; i++)
        if (layout->groups[i].foreign_count || layout->groups[i].rest >= 0)
            return 1;
    return 0;
}

fp3_status fp3_layout_arrange(fp3_members *group, uint32_t *slot, uint32_t away, fp3_error *error) {
    uint32_t *who = malloc((group->objects + (size_t)1) * sizeof *who);
    if (!who)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < group->objects; i++)
        who[slot[i]] = i;
    free(group->slot);
    free(group->who);
    group->slot = slot;
    group->who = who;
    group->away = away;
    return FP3_OK;
}

/* ---- finding ---- */

int fp3_layout_is_same(const fp3_layout *a, const fp3_layout *b) {
    if (a->count != b->count)
        return 0;
    for (uint32_t i = 0; i < a->count; i++) {
        const fp3_members *x = &a->groups[i], *y = &b->groups[i];
        if (x->slot || y->slot || x->objects != y->objects || x->log2 != y->log2 ||
            x->scheduler_count != y->scheduler_count ||
            memcmp(x->schedulers, y->schedulers, x->scheduler_count * sizeof *x->schedulers) != 0)
            return 0;
    }
    return 1;
}

const fp3_members *fp3_layout_group_of(const fp3_layout *layout, size_t object) {
    uint32_t i = layout->count - 1;
    while (layout->groups[i].first > object)
        i--;
    return &layout->groups[i];
}

/* Of the group's objects, those in the rows in front. */
static uint32_t in_front(const fp3_members *group) { return group->objects - group->away; }

/* The first object of a column, where objects follow each other in each. */
static uint32_t column_begin(const fp3_members *group, uint32_t column) {
    const uint32_t more = in_front(group) % group->columns;
    return column * (in_front(group) / group->columns) + (column < more ? column : more);
}

/* How many of count things a column has, if they are dealt out or divided: the first columns have
 * one more. */
static uint32_t share_of(const fp3_members *group, uint32_t count, uint32_t column) {
    return count / group->columns + (column < count % group->columns);
}

fp3_where fp3_layout_where(const fp3_layout *layout, const fp3_config *config, size_t object) {
    const fp3_members *group = fp3_layout_group_of(layout, object);
    const uint32_t number = (uint32_t)object - group->first;
    const uint32_t front = in_front(group);
    const uint32_t slot = group->slot && number < group->objects ? group->slot[number] : number;
    const int is_behind = group->lists.shape.is_any && slot >= front;
    const uint32_t i = is_behind ? slot - front : slot;
    const uint32_t each = front / group->columns, more = front % group->columns;
    uint32_t column = i % group->columns, row = i / group->columns;
    if (is_behind) {
        row += share_of(group, front, column);
    } else if (group->lists.shape.is_any) {
        column = i / (each + 1) < more ? i / (each + 1) : more + (i - more * (each + 1)) / each;
        row = i - column_begin(group, column);
    }
    return (fp3_where){group->schedulers[column / config->lanes], column % config->lanes, row};
}

uint64_t fp3_layout_published(const fp3_members *group) {
    return group->lists.shape.is_any ? group->lists.shape.published & group->visit->stored : 0;
}

uint32_t fp3_layout_who(const fp3_layout *layout, const fp3_config *config,
                        const fp3_where *where) {
    const fp3_duty *duty = &layout->duty[where->scheduler];
    const fp3_members *group = &layout->groups[duty->group];
    const uint32_t column = duty->rank * config->lanes + where->lane;
    const uint32_t slot = column_begin(group, column) + where->row;
    if (group->lists.shape.is_any)
        return group->first + (group->who ? group->who[slot] : slot);
    return group->first + where->row * group->columns + column;
}

uint32_t fp3_layout_rows(const fp3_layout *layout, const fp3_config *config, uint32_t scheduler,
                         uint32_t lane) {
    const fp3_duty *duty = &layout->duty[scheduler];
    const fp3_members *group = &layout->groups[duty->group];
    return share_of(group, in_front(group), duty->rank * config->lanes + lane);
}

uint32_t fp3_layout_rows_with_guests(const fp3_layout *layout, const fp3_config *config,
                                     uint32_t lane) {
    const fp3_members *group = &layout->groups[0];
    return fp3_layout_rows(layout, config, 0, lane) +
           share_of(group, group->rows - in_front(group), lane);
}

uint32_t fp3_layout_objects(const fp3_layout *layout, const fp3_config *config,
                            uint32_t scheduler) {
    uint32_t objects = 0;
    for (uint32_t lane = 0; lane < config->lanes; lane++)
        objects += fp3_layout_rows(layout, config, scheduler, lane);
    return objects;
}
