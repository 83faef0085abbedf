/* SPDX-License-Identifier: Apache-2.0 */
/* fp3_bare_neighbours.c - see fp3_bare_neighbours.h. */
#include "fp3_bare_neighbours.h"

#include <stddef.h>

#define MOST_ENTRIES ((1u << (FP3_OBJECTS_LENGTH_HI - FP3_OBJECTS_LENGTH_LO + 1)) - 1)

/* Positions are integers here: so many bits of them are the reach. A position is cut off at its
 * last bit, so a difference is wrong by less than 2 in each component, and a distance by less than
 * CUT. A list reaches farther by that, by what reach and skin were cut off by, and by the rounding
 * of the program, which computes distances in FP32: FAR in all. */
#define REACH_BITS 12
#define CUT 4
#define FAR (CUT + 3)
#define LARGEST_BITS 30
#define BIAS 127
#define FRACTION 23

static fp3_status put(fp3_bare *fp3, uint32_t address, uint32_t data) {
    if (!fp3->bus.write(fp3->bus.user, address, data))
        return FP3_OK;
    fp3->failed_at = address;
    return FP3_E_SYSTEM;
}

static fp3_status put_store(fp3_bare *fp3, uint32_t word, uint32_t data) {
    return put(fp3, FP3_ADDRESS_IN(fp3->space_bit, FP3_SPACE_OBJECTS, word), data);
}

fp3_status fp3_bare_neighbours_open(fp3_bare_neighbours *n, fp3_bare *fp3, uint32_t objects,
                                    uint32_t *next) {
    const uint32_t half = fp3->store / 2;
    if (!fp3->around || !fp3->record[0] || fp3->running[0] || objects > half >> fp3->record[0] ||
        (objects && !next))
        return FP3_E_ARGUMENT;
    const uint32_t room = objects << fp3->record[0];
    *n = (fp3_bare_neighbours){fp3, fp3->around, objects, next, 0, {room, half + room}, NULL};
    fp3->missing = (1u << fp3->around->list_count) - 1;
    fp3->room = room;
    return fp3_bare_list(fp3, 0, objects);
}

/* Whether lists can be given, or the program run: it is still the one of the call before. */
static int is_open(const fp3_bare_neighbours *n) {
    return n->program == n->fp3->around && !n->fp3->running[0] && n->fp3->record[0] &&
           n->fp3->room == n->objects << n->fp3->record[0];
}

/* ---- lists in the store ---- */

/* A list of the program that is to be made. Its lengths, 0 at first, are to be counted in n->next.
 * NULL: there is none, or it is there already, or cannot be changed now. */
static const fp3_bare_shape *begin(fp3_bare_neighbours *n, uint32_t list) {
    const fp3_bare_program *program = n->program;
    if (!is_open(n))
        return NULL;
    for (uint32_t i = 0; i < n->objects; i++)
        ((volatile uint32_t *)n->next)[i] = 0; /* or a compiler calls memset */
    for (uint32_t i = 0; i < program->list_count; i++)
        if (program->lists[i].reg == list && n->fp3->missing >> i & 1)
            return &program->lists[i];
    return NULL;
}

static uint32_t bit_of(const fp3_bare_neighbours *n, const fp3_bare_shape *shape) {
    return 1u << (shape - n->program->lists);
}

/* Of a list's words, where the first is: in the half that has room; UINT32_MAX: neither has. */
static uint32_t take(fp3_bare_neighbours *n, uint32_t words) {
    const uint32_t half = n->fp3->store / 2;
    for (uint32_t i = 0; i < 2; i++)
        if ((i + 1) * half - n->free[i] >= words) {
            n->free[i] += words;
            return n->free[i] - words;
        }
    return UINT32_MAX;
}

/* Tells each object where its list is, and how long; n->next is then where its next entry goes. A
 * list that is refused takes no room. */
static fp3_status place(fp3_bare_neighbours *n, const fp3_bare_shape *shape) {
    const uint32_t low = n->free[0], high = n->free[1];
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < n->objects; i++) {
        const uint32_t length = n->next[i];
        n->failed = i;
        n->next[i] = length > MOST_ENTRIES ? UINT32_MAX : take(n, length * (1 + shape->fields));
        status =
            n->next[i] == UINT32_MAX
                ? FP3_E_PROGRAM
                : put_store(n->fp3, (i << n->fp3->record[0]) + shape->reg,
                            length << FP3_OBJECTS_LENGTH_LO | n->next[i] << FP3_OBJECTS_PLACE_LO);
    }
    if (status) {
        n->free[0] = low;
        n->free[1] = high;
    }
    return status;
}

static fp3_status enter(fp3_bare_neighbours *n, uint32_t object, uint32_t other,
                        const uint32_t *fields, uint32_t count) {
    fp3_status status = put_store(n->fp3, n->next[object]++, other);
    for (uint32_t i = 0; !status && i < count; i++)
        status = put_store(n->fp3, n->next[object]++, fields[i]);
    return status;
}

fp3_status fp3_bare_links(fp3_bare_neighbours *n, uint32_t list, const fp3_bare_link *links,
                          uint32_t count, const uint32_t *fields) {
    const fp3_bare_shape *shape = begin(n, list);
    if (!shape || (count && (!links || (shape->fields && !fields))))
        return FP3_E_ARGUMENT;
    for (uint32_t i = 0; i < count; i++) {
        const fp3_bare_link *link = &links[i];
        n->failed = i;
        if (link->a >= n->objects || link->b >= n->objects || link->a == link->b)
            return FP3_E_ARGUMENT;
        n->next[link->a]++;
        n->next[link->b]++;
    }
    fp3_status status = place(n, shape);
    for (uint32_t i = 0; !status && i < count; i++) {
        const uint32_t *own = shape->fields ? fields + (size_t)i * shape->fields : NULL;
        status = enter(n, links[i].a, links[i].b, own, shape->fields);
        if (!status)
            status = enter(n, links[i].b, links[i].a, own, shape->fields);
    }
    n->fp3->missing &= status ? UINT32_MAX : ~bit_of(n, shape);
    return status;
}

fp3_status fp3_bare_all(fp3_bare_neighbours *n, uint32_t list) {
    const fp3_bare_shape *shape = begin(n, list);
    if (!shape || shape->fields)
        return FP3_E_ARGUMENT;
    for (uint32_t i = 0; i < n->objects; i++)
        n->next[i] = n->objects - 1;
    fp3_status status = place(n, shape);
    for (uint32_t i = 0; !status && i < n->objects; i++)
        for (uint32_t k = 0; !status && k < n->objects; k++)
            if (k != i)
                status = enter(n, i, k, NULL, 0);
    n->fp3->missing &= status ? UINT32_MAX : ~bit_of(n, shape);
    return status;
}

/* ---- those that are near ---- */

static uint32_t exponent_of(uint32_t bits) { return bits >> FRACTION & 255; }

/* A number as an integer, where a reach has REACH_BITS + 1 bits; what is behind them is cut off. */
static fp3_status cut(const fp3_bare_near *near, uint32_t bits, int32_t *number) {
    const uint32_t exponent = exponent_of(bits), most = LARGEST_BITS - 1 - FRACTION;
    const uint32_t digits = (bits & ((1u << FRACTION) - 1)) | (exponent > 0) << FRACTION;
    const int shift =
        (int)exponent + (exponent == 0) - (int)exponent_of(near->reach) - (FRACTION - REACH_BITS);
    if (exponent == 255)
        return FP3_E_FAILED;
    if (shift > (int)most && digits)
        return FP3_E_LIMIT;
    const uint32_t size = !digits || shift < -FRACTION ? 0
                          : shift < 0                  ? digits >> -shift
                                                       : digits << shift;
    *number = bits >> 31 ? -(int32_t)size : (int32_t)size;
    return FP3_OK;
}

fp3_status fp3_bare_near_add(fp3_bare_neighbours *n, fp3_bare_near *near) {
    const fp3_bare_shape *shape = begin(n, near->list);
    int32_t reach = 0, skin = 0;
    if (!shape || shape->fields || n->fp3->missing != bit_of(n, shape) || near->dimensions < 1 ||
        near->dimensions > 3 || near->cells < 1 || !near->first ||
        (n->objects && (!near->made || !near->order)) || near->reach >> 31 || near->skin >> 31 ||
        exponent_of(near->reach) < BIAS - 50 || exponent_of(near->reach) > BIAS + 62)
        return FP3_E_ARGUMENT;
    for (uint32_t k = 0; k < near->dimensions; k++)
        if (near->position[k] >= n->fp3->registers || near->position[k] >> n->fp3->record[0])
            return FP3_E_ARGUMENT;
    if (cut(near, near->reach, &reach) || cut(near, near->skin, &skin))
        return FP3_E_ARGUMENT;
    near->far = (uint32_t)reach + (uint32_t)skin + FAR;
    near->lists = 0;
    n->near = near;
    return FP3_OK;
}

static fp3_status look(fp3_bare_neighbours *n, uint32_t object, int32_t place[3]) {
    const fp3_bare_near *near = n->near;
    fp3_status status = FP3_OK;
    n->failed = object;
    for (uint32_t k = 0; !status && k < 3; k++) {
        uint32_t bits = 0;
        if (k < near->dimensions)
            status = fp3_bare_read(n->fp3, 0, object, near->position[k], &bits);
        if (!status)
            status = cut(near, bits, &place[k]);
    }
    return status;
}

/* The square of how far two places are from each other. */
static uint64_t way(const int32_t a[3], const int32_t b[3]) {
    uint64_t sum = 0;
    for (uint32_t k = 0; k < 3; k++) {
        const int32_t d = a[k] - b[k];
        sum += (uint64_t)((int64_t)d * d);
    }
    return sum;
}

/* Whether somebody may have moved by more than half the skin. */
static fp3_status ask(fp3_bare_neighbours *n, int *is_stale) {
    int32_t place[3], skin = 0;
    fp3_status status = cut(n->near, n->near->skin, &skin);
    const uint32_t most = skin / 2 > CUT ? (uint32_t)skin / 2 - CUT : 0;
    *is_stale = !n->near->lists;
    for (uint32_t i = 0; !status && !*is_stale && i < n->objects; i++) {
        status = look(n, i, place);
        *is_stale = !status && (!most || way(place, n->near->made[i]) > (uint64_t)most * most);
    }
    return status;
}

static uint32_t cell_of(const fp3_bare_near *near, const int32_t place[3], uint32_t at[3]) {
    for (uint32_t k = 0; k < 3; k++)
        at[k] = ((uint32_t)place[k] - (uint32_t)near->least[k]) / near->side;
    return (at[2] * near->count[1] + at[1]) * near->count[0] + at[0];
}

/* A box around all objects, and its cells: as large as the list reaches, or larger, so that they
 * are not more than there is memory for. */
static void measure(fp3_bare_near *near, uint32_t objects) {
    uint32_t extent[3];
    for (uint32_t k = 0; k < 3; k++) {
        int32_t least = objects ? near->made[0][k] : 0, most = least;
        for (uint32_t i = 1; i < objects; i++) {
            least = near->made[i][k] < least ? near->made[i][k] : least;
            most = near->made[i][k] > most ? near->made[i][k] : most;
        }
        near->least[k] = least;
        extent[k] = (uint32_t)most - (uint32_t)least;
    }
    for (near->side = near->far;; near->side *= 2) {
        uint64_t cells = 1;
        for (uint32_t k = 0; k < 3 && cells <= near->cells; k++) {
            near->count[k] = extent[k] / near->side + 1;
            cells = (uint64_t)(uint32_t)cells * near->count[k];
        }
        if (cells <= near->cells)
            return;
    }
}

/* Counting sort: the objects of cell c are order[first[c]] .. order[first[c + 1] - 1]. */
static void sort(fp3_bare_near *near, uint32_t objects) {
    const uint32_t cells = near->count[0] * near->count[1] * near->count[2];
    uint32_t at[3];
    for (uint32_t i = 0; i < cells + 2; i++)
        ((volatile uint32_t *)near->first)[i] = 0; /* or a compiler calls memset */
    for (uint32_t i = 0; i < objects; i++)
        near->first[cell_of(near, near->made[i], at) + 2]++;
    for (uint32_t i = 2; i < cells + 2; i++)
        near->first[i] += near->first[i - 1];
    for (uint32_t i = 0; i < objects; i++)
        near->order[near->first[cell_of(near, near->made[i], at) + 1]++] = i;
}

/* Counts an object's neighbours, or enters the object in their lists. Objects come by their
 * numbers, so each list has that order. */
static fp3_status meet(fp3_bare_neighbours *n, uint32_t object, int is_entered) {
    const fp3_bare_near *near = n->near;
    const int32_t *place = near->made[object];
    fp3_status status = FP3_OK;
    uint32_t at[3], low[3], high[3];
    cell_of(near, place, at);
    for (uint32_t k = 0; k < 3; k++) {
        low[k] = at[k] ? at[k] - 1 : 0;
        high[k] = at[k] + 1 < near->count[k] ? at[k] + 1 : at[k];
    }
    for (uint32_t z = low[2]; z <= high[2]; z++)
        for (uint32_t y = low[1]; y <= high[1]; y++) {
            const uint32_t line = (z * near->count[1] + y) * near->count[0];
            for (uint32_t i = near->first[line + low[0]], end = near->first[line + high[0] + 1];
                 !status && i < end; i++) {
                const uint32_t other = near->order[i];
                if (other == object ||
                    way(place, near->made[other]) > (uint64_t)near->far * near->far)
                    continue;
                if (is_entered)
                    status = enter(n, other, object, NULL, 0);
                else
                    n->next[object]++;
            }
        }
    return status;
}

/* The list of those that are near now. It takes the place of the one before. */
static fp3_status make(fp3_bare_neighbours *n) {
    const fp3_bare_shape *shape = begin(n, n->near->list);
    const uint32_t low = n->free[0], high = n->free[1];
    fp3_status status = shape ? FP3_OK : FP3_E_ARGUMENT;
    n->near->lists++;
    for (uint32_t i = 0; !status && i < n->objects; i++)
        status = look(n, i, n->near->made[i]);
    if (status)
        return status;
    measure(n->near, n->objects);
    sort(n->near, n->objects);
    for (uint32_t i = 0; i < n->objects; i++)
        meet(n, i, 0);
    status = place(n, shape);
    for (uint32_t i = 0; !status && i < n->objects; i++)
        status = meet(n, i, 1);
    n->free[0] = low;
    n->free[1] = high;
    return status;
}

/* ---- a run ---- */

/* The hardware runs its program from the first word on: each phase of several is a program. */
static fp3_status load_phase(fp3_bare *fp3, uint32_t phase) {
    const fp3_bare_phase *p = &fp3->around->phases[phase];
    const uint32_t words = p->end - p->first;
    fp3_status status = FP3_OK;
    if (fp3->around->phase_count == 1)
        return FP3_OK;
    for (uint32_t i = 0; !status && i < words; i++)
        status = put(fp3, FP3_ADDR_WINDOW_PROGRAM + 4 * i, fp3->around->words[p->first + i]);
    if (!status)
        status = put(fp3, FP3_ADDR_STEP, 0);
    if (!status)
        status = put(fp3, FP3_ADDR_LAST, words);
    return status ? status : put(fp3, FP3_ADDR_SIZE, words);
}

static fp3_status run_phase(fp3_bare_neighbours *n, uint32_t phase, uint32_t clock, uint32_t polls,
                            fp3_bare_outcome *outcome) {
    fp3_bare *fp3 = n->fp3;
    const uint32_t missing = fp3->missing;
    int is_stale = 0;
    fp3_status status = ask(n, &is_stale);
    if (!status && is_stale)
        status = make(n);
    if (!status)
        status = load_phase(fp3, phase);
    if (status)
        return status;
    fp3->missing = 0; /* for this phase; later the list may be stale */
    status = fp3_bare_start(fp3, 0, 1, 1, clock);
    fp3->missing = missing;
    if (!status)
        *outcome = FP3_BARE_RUNNING; /* also if nobody polls */
    return status ? status : fp3_bare_wait(fp3, 0, polls, outcome);
}

fp3_status fp3_bare_near_run(fp3_bare_neighbours *n, uint32_t steps, uint32_t clock, uint32_t polls,
                             fp3_bare_outcome *outcome) {
    fp3_status status = FP3_OK;
    *outcome = FP3_BARE_NONE;
    if (!n->near || !is_open(n) || clock > UINT32_MAX - steps)
        return FP3_E_ARGUMENT;
    if (!steps)
        *outcome = FP3_BARE_DONE;
    for (uint32_t made = 0; made < steps; made++)
        for (uint32_t phase = 0; phase < n->program->phase_count; phase++) {
            status = run_phase(n, phase, clock + made, polls, outcome);
            if (status || *outcome != FP3_BARE_DONE) {
                n->near = NULL; /* the store may have half a list */
                return status;
            }
        }
    return FP3_OK;
}
