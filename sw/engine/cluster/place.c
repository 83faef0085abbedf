/* SPDX-License-Identifier: Apache-2.0 */
/* place.c - an engine for what a rank has, and objects that move from one rank to another. */
#include "engine/common/cells.h"
#include "inside.h"
#include "positions.h"

#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define ROOM_MORE 256 /* for guests, as objects move */
#define APART 0.3     /* of the reach: how far pairs that remember may part within a step */

static int count_near(const fp3_members *group) {
    int count = 0;
    for (uint32_t i = 0; i < group->lists.shape.list_count; i++)
        count += group->lists.lists[i].is_near;
    return count;
}

static void count_shares(const fp3_engine *engine, fp3_ranked *to) {
    uint32_t own = 0;
    memset(to->share, 0, to->ranks->count * sizeof *to->share);
    for (uint32_t i = 0; i < engine->objects; i++) {
        to->share[to->whose[i]]++;
        if (to->whose[i] == fp3_ranks_here(to))
            to->mine[own++] = i;
    }
    to->first = to->sees_all && own ? to->mine[0] : 0;
}

static fp3_status load_own(fp3_engine *engine, fp3_ranked *to) {
    const fp3_layout *layout = &engine->layout;
    fp3_group *groups = calloc(layout->count, sizeof *groups);
    size_t count = 0;
    if (!groups)
        return fp3_ranks_no_memory(engine);
    for (uint32_t g = 0; g < layout->count; g++) {
        size_t own = 0;
        for (uint32_t i = 0; i < layout->groups[g].objects; i++)
            own += to->whose[layout->groups[g].first + i] == fp3_ranks_here(to);
        if (layout->groups[g].lists.shape.is_any)
            own = to->room;
        to->group[g] = own ? (int)count : -1;
        if (own)
            groups[count++] = (fp3_group){.image = layout->groups[g].image, .objects = own};
    }
    fp3_status status = fp3_engine_load_groups(to->own, groups, count);
    free(groups);
    for (uint32_t g = 0; !status && g < layout->count; g++)
        if (to->group[g] >= 0)
            status = fp3_cells_write(to->own,
                                     (fp3_cells){FP3_CELLS_CONSTANT, (uint32_t)to->group[g], 0,
                                                 engine->config->registers},
                                     &to->constants[(size_t)g * engine->config->registers]);
    to->own->clock = engine->clock;
    to->own->made = engine->made;
    return status;
}

/* A list of the own objects; rows: of each object, where it stands. */
static fp3_status give_list(fp3_engine *engine, const fp3_ranked *to, const fp3_list *list,
                            const uint32_t *rows, fp3_list *own) {
    const uint32_t count = to->share[fp3_ranks_here(to)];
    size_t entries = 0;
    for (uint32_t i = 0; i < count; i++)
        entries += fp3_list_length(list, to->mine[i]);
    uint32_t *begin = calloc(to->room + (size_t)1, sizeof *begin),
             *other = malloc((entries + 1) * sizeof *other), n = 0;
    float *field = malloc((entries * list->fields + 1) * sizeof *field);
    fp3_status status = begin && other && field ? FP3_OK : fp3_ranks_no_memory(engine);
    for (uint32_t i = 0; !status && i < to->room; i++) {
        const uint32_t at = i - to->first, mine = at < count ? to->mine[at] : 0;
        const uint32_t length = at < count ? fp3_list_length(list, mine) : 0;
        for (uint32_t turn = 0; turn < length; turn++, n++) {
            other[n] = rows[fp3_list_entry(list, mine, turn)];
            if (list->fields) /* all others have none */
                memcpy(&field[(size_t)n * list->fields],
                       &list->field[((size_t)list->begin[mine] + turn) * list->fields],
                       list->fields * sizeof *field);
        }
        begin[i + 1] = n;
    }
    if (!status)
        status =
            fp3_list_take(own, &(fp3_neighbours){.begin = begin, .other = other, .fields = field},
                          engine->def.error);
    free(begin);
    free(other);
    free(field);
    return status;
}

static fp3_status give_lists(fp3_engine *engine, fp3_ranked *to) {
    const fp3_lists *lists = &engine->layout.groups[0].lists;
    fp3_members *group = &to->own->layout.groups[0];
    uint32_t *rows = malloc((engine->objects + (size_t)1) * sizeof *rows),
             *numbers = malloc((to->room + (size_t)1) * sizeof *numbers);
    fp3_status status = rows && numbers ? FP3_OK : fp3_ranks_no_memory(engine);
    if (!status) {
        fp3_ranks_number_rows(to, numbers);
        memset(rows, 0xff, engine->objects * sizeof *rows);
        for (uint32_t i = 0; i < to->room; i++)
            if (numbers[i] != UINT32_MAX)
                rows[numbers[i]] = i;
    }
    for (uint32_t k = 0; !status && k < lists->shape.list_count; k++) {
        const fp3_list *list = &lists->lists[k];
        fp3_list *own = &group->lists.lists[k];
        if (list->is_near) {
            fp3_list_take_near(own, &list->near, list->kind);
            if (fp3_list_remembers(list))
                status = fp3_ranks_give_near(engine, to, k, rows);
        } else if (to->sees_all && list->is_all)
            status = fp3_list_take(own, &(fp3_neighbours){0}, engine->def.error);
        else if (list->is_there)
            status = give_list(engine, to, list, rows, own);
        if (!status && to->own->backend->connect)
            status = to->own->backend->connect(to->own, group, own);
    }
    if (!status)
        status = fp3_engine_set_numbers(to->own, numbers);
    free(rows);
    to->names = numbers;
    return status;
}

static void use_rows(fp3_engine *engine, fp3_ranked *to) {
    fp3_engine_use(to->own, to->first, to->share[fp3_ranks_here(to)]);
    to->own->layout.groups[0].rows =
        to->sees_all ? engine->objects : to->share[fp3_ranks_here(to)] + to->guest_count;
    fp3_engine_set_exchange(
        to->own, &(fp3_exchange){fp3_ranks_send, fp3_ranks_receive, engine, fp3_ranks_worst});
}

/* In the host there is room for as many guests as there may be: what nobody has written to costs
 * nothing. Hardware has half of its store for records. */
static uint32_t room_for(const fp3_engine *engine, const fp3_ranked *to) {
    const fp3_config *config =
        fp3_config_find(to->def.config); /* engine->config has the host's store */
    const uint64_t now = (uint64_t)to->share[fp3_ranks_here(to)] + to->guest_count,
                   more = now + to->guest_count + ROOM_MORE;
    uint64_t most = fp3_engine_room(to->def.engine, to->def.config);
    if (to->sees_all)
        return engine->objects;
    if (!to->made[0])
        return (uint32_t)now;
    most = most < engine->objects ? most : engine->objects;
    if (to->backend.begins_at_0) {
        const uint64_t fit =
            (uint64_t)config->lanes * (config->store_words / 2 >> engine->layout.groups[0].log2);
        most = fit < most ? fit : most;
        most = more < most ? more : most;
    }
    return (uint32_t)(most > now ? most : now);
}

/* The own engine's run is a part of the run. */
static void tell(void *user, double share) {
    const fp3_engine *engine = user;
    engine->def.progress(engine->def.progress_user, engine->told + engine->part * share);
}

/* Opens it for `whose` and guests, empty. */
static fp3_status settle(fp3_engine *engine, fp3_ranked *to) {
    const uint32_t own = to->share[fp3_ranks_here(to)];
    const int is_around = engine->layout.groups[0].lists.shape.is_any;
    to->room = room_for(engine, to);
    if (!own)
        return FP3_OK;
    to->def.objects = to->room;
    to->def.progress = engine->def.progress ? tell : NULL;
    to->def.progress_user = engine;
    to->def.visit = engine->def.visit;
    fp3_status status = fp3_engine_open(&to->def, &to->own);
    if (!status)
        status = load_own(engine, to);
    if (!status && is_around)
        status = give_lists(engine, to);
    if (!status && is_around)
        use_rows(engine, to);
    return status;
}

fp3_status fp3_ranks_begin(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    fp3_ranks_close_own(self);
    fp3_ranks_forget_held(self);
    fp3_ranks_forget_traffic(self);
    self->guest_count = 0;
    self->sees_all = 0;
    self->backend.at_once = 0;
    self->is_placed = !engine->layout.groups[0].lists.shape.is_any;
    for (uint32_t i = 0; i < engine->layout.count; i++)
        fp3_ranks_divide_group(self, &engine->layout.groups[i]);
    count_shares(engine, self);
    return self->is_placed ? settle(engine, self) : FP3_OK;
}

void fp3_ranks_forget(fp3_ranked *self) {
    fp3_ranks_forget_traffic(self);
    fp3_engine_close(&self->own);
    fp3_ranks_forget_held(self);
    free(self->whose);
    free(self->mine);
    free(self->share);
    free(self->guests);
    free(self->names);
    free(self->began);
    free(self->again);
    for (int k = 0; k < FP3_NEAR_DIMENSIONS; k++)
        free(self->made[k]);
}

static fp3_status move_cells(fp3_engine *engine, fp3_ranked *before, fp3_ranked *to,
                             fp3_cells cells, uint32_t *words) {
    engine->self = before;
    const fp3_status status = fp3_ranks_read(engine, cells, words);
    engine->self = to;
    return status || !fp3_ranks_is_any_set(words, cells.count)
               ? status
               : fp3_ranks_write(engine, cells, words);
}

/* A register at a time: what was never written is not made. */
static fp3_status move(fp3_engine *engine, fp3_ranked *before, fp3_ranked *to) {
    const fp3_members *group = &engine->layout.groups[0];
    const uint32_t count = engine->objects;
    uint32_t *words = malloc(count * sizeof *words);
    fp3_status status = words ? FP3_OK : fp3_ranks_no_memory(engine);
    for (uint32_t reg = 0; !status && reg < 1u << group->log2 && reg < engine->config->registers;
         reg++)
        status =
            move_cells(engine, before, to, (fp3_cells){FP3_CELLS_REGISTER, reg, 0, count}, words);
    if (!status && engine->config->status)
        status = move_cells(engine, before, to, (fp3_cells){FP3_CELLS_STATUS, 0, 0, count}, words);
    free(words);
    return status;
}

/* Objects that move are divided by one position. */
static fp3_status check_relations(fp3_engine *engine, const fp3_ranked *to) {
    const fp3_members *group = &engine->layout.groups[0];
    const int near = count_near(group);
    const fp3_near_rule *rule = near ? fp3_positions_rule(group) : NULL;
    for (uint32_t k = 0; k < group->lists.shape.list_count; k++) {
        const fp3_near_rule *other = &group->lists.lists[k].near;
        if (group->lists.lists[k].is_near &&
            (other->dimensions != rule->dimensions ||
             memcmp(other->regs, rule->regs, rule->dimensions * sizeof *rule->regs) != 0))
            return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                            "several ranks: relations `near` of different positions");
    }
    if (near && rule->is_pair)
        return fp3_fail(engine->def.error, FP3_E_PROGRAM,
                        "several ranks: positions of near objects are sums of two words "
                        "(double-single), and ranks look at the first of them alone; one process "
                        "with --threads runs the model");
    if (near && engine->objects < to->ranks->count)
        return fp3_fail(
            engine->def.error, FP3_E_ARGUMENT,
            "%u ranks: with `near` each rank needs an object, and the scene has %" PRIu32,
            to->ranks->count, engine->objects);
    return FP3_OK;
}

static fp3_status divide(fp3_engine *engine, fp3_ranked *to) {
    const fp3_members *group = &engine->layout.groups[0];
    const fp3_status status = check_relations(engine, to);
    if (status)
        return status;
    if (!fp3_ranks_is_all(group))
        return count_near(group) ? fp3_ranks_divide_by_place(engine, to)
                                 : fp3_ranks_divide_by_links(engine, to);
    fp3_ranks_divide_group(to, group);
    return FP3_OK;
}

/* Where all others are guests, none comes or goes. */
static fp3_status remember(fp3_engine *engine, fp3_ranked *to) {
    const fp3_members *group = &engine->layout.groups[0];
    const int moves = count_near(group) && !fp3_ranks_is_all(group);
    for (int k = 0; k < FP3_NEAR_DIMENSIONS && moves; k++) {
        to->made[k] = malloc((to->share[fp3_ranks_here(to)] + (size_t)1) * sizeof *to->made[k]);
        if (!to->made[k])
            return fp3_ranks_no_memory(engine);
    }
    return FP3_OK;
}

/* A skin changes no bit, and keeps guests whose pairs remember until a step has ended. */
static void widen_skins(fp3_engine *engine) {
    fp3_lists *lists = &engine->layout.groups[0].lists;
    for (uint32_t k = 0; k < lists->shape.list_count; k++) {
        fp3_list *list = &lists->lists[k];
        if (list->is_near && fp3_list_remembers(list) && list->near.skin < APART * list->near.reach)
            list->near.skin = APART * list->near.reach;
    }
}

fp3_status fp3_ranks_tell_lives(fp3_engine *engine) {
    const fp3_ranked *self = engine->self;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0;
         !status && self->own && engine->lives.list && i < self->share[fp3_ranks_here(self)]; i++) {
        const fp3_life *life = &engine->lives.list[self->mine[i]];
        status = fp3_engine_live(self->own, self->first + i, 1, life->born, life->gone);
    }
    return status;
}

fp3_status fp3_ranks_wander(fp3_engine *engine) {
    fp3_ranked *self = engine->self;
    if (!self->is_placed || !self->made[0])
        return FP3_OK;
    const int is_far = self->guest_count > self->placed + self->placed / 2 + ROOM_MORE / 4;
    if (self->ranks->calls->most(self->ranks->world, (uint64_t)is_far))
        self->is_placed = 0;
    return FP3_OK;
}

fp3_status fp3_ranks_place(fp3_engine *engine) {
    fp3_ranked *self = engine->self, before;
    fp3_ranked to = *self;
    to.whose = malloc(engine->objects * sizeof *to.whose);
    to.mine = malloc(engine->objects * sizeof *to.mine);
    to.share = calloc(to.ranks->count, sizeof *to.share);
    to.own = NULL;
    to.guests = NULL;
    to.guest_count = 0;
    to.out = to.in = (fp3_traffic){0};
    to.plan = NULL;
    to.sees_all = fp3_ranks_is_all(&engine->layout.groups[0]) && !self->backend.begins_at_0;
    to.is_placed = 1;
    to.is_stale = 0;
    to.names = to.began = to.again = NULL;
    memset(to.made, 0, sizeof to.made);
    widen_skins(engine);
    memset(to.held, 0, sizeof to.held);
    fp3_status status = to.whose && to.mine && to.share ? FP3_OK : fp3_ranks_no_memory(engine);
    if (!status)
        status = divide(engine, &to);
    if (!status) {
        count_shares(engine, &to);
        status = remember(engine, &to);
    }
    if (!status)
        status = fp3_ranks_choose_guests(engine, &to);
    to.placed = to.guest_count;
    if (!status)
        status = fp3_ranks_hold(engine);
    before = *self;
    to.use = self->use;
    if (!status)
        status = settle(engine, &to);
    if (!status) {
        *self = to;
        status = move(engine, &before, self);
    }
    if (!status)
        status = fp3_ranks_tell_lives(engine);
    if (!status) /* the first exchange does not wait for who was slower here */
        to.ranks->calls->most(to.ranks->world, 0);
    fp3_ranks_forget(status ? &to : &before);
    if (status)
        *self = before;
    engine->self = self;
    return status;
}
