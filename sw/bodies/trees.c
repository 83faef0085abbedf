/* SPDX-License-Identifier: Apache-2.0 */
/* trees.c - see trees.h. */
#include "trees.h"

#include "share.h"

#include "turn.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define HEAVY 250.0 /* a tree's mass over that of its lightest body */
#define STANDS 1e12 /* what a body that may not turn resists, of its mass */

typedef double square[3][3];

/* A joint between two bodies of the tree, or of one with what does not move. */
typedef struct {
    uint32_t below, above; /* slots; above: FP3_NOBODY if it does not move */
    uint32_t pin, twist;   /* rows; twist: FP3_NOBODY if it has none */
    int is_b;              /* `below` is b */
    uint32_t size;         /* how many numbers it holds: 2 or 3 */
    square low, high;      /* how they change with what is below and above */
    square given;          /* impulse over speed */
    double want[3], impulse[3];
    double held[2]; /* by the point in the substep before */
} bond;

/* Its mass with all that hangs on it, inverted in the end; momentum; change of speed. */
typedef struct {
    square mass;
    double push[3], change[3];
} node;

/* Of a body, while trees are looked for. */
typedef struct {
    uint32_t root;        /* of its set; of a root itself */
    uint32_t bodies, all; /* of a set: bodies; joints, of which `held` with what does not move */
    uint32_t held;
    float mass, least;
    uint32_t number;      /* in the order in which joints name bodies */
    uint32_t edges, last; /* of a body, and all of their numbers by exclusive or */
    int is_in, hangs;
} place;

struct fp3_trees {
    bond *bond; /* from the leaves */
    node *node;
    place *place;
    uint32_t *twist; /* of each joint its row of an angle that is held */
    uint32_t *slot;  /* of bodies that have joints */
    uint32_t bonds, count;
    /* Joints and masses among which no tree was found, so that nobody looks again. */
    uint32_t *light_a, *light_b, light_pins, light_slots;
    fp3_four *light_heft;
    uint32_t light_a_room, light_b_room, light_heft_room;
    uint32_t bond_room, node_room, place_room, twist_room, slot_room;
};

#define PIN (FP3_LAW_pin2 - FP3_LAW_twist2)
#define TWIST 0

static fp3_status make_room(fp3_bodies *bodies) {
    if (!bodies->trees)
        bodies->trees = calloc(1, sizeof *bodies->trees);
    fp3_trees *t = bodies->trees;
    if (!t)
        return fp3_no_memory(bodies->error);
    const size_t joints = bodies->joint_count + 1u, slots = bodies->slots + 1u;
    const struct {
        void **array;
        uint32_t *room;
        size_t size, count;
    } all[] = {{(void **)&t->bond, &t->bond_room, sizeof *t->bond, joints},
               {(void **)&t->node, &t->node_room, sizeof *t->node, slots},
               {(void **)&t->place, &t->place_room, sizeof *t->place, slots},
               {(void **)&t->twist, &t->twist_room, sizeof *t->twist, joints},
               {(void **)&t->slot, &t->slot_room, sizeof *t->slot, slots},
               {(void **)&t->light_a, &t->light_a_room, sizeof *t->light_a, joints},
               {(void **)&t->light_b, &t->light_b_room, sizeof *t->light_b, joints},
               {(void **)&t->light_heft, &t->light_heft_room, sizeof *t->light_heft, slots}};
    fp3_status status = FP3_OK;
    for (size_t i = 0; !status && i < sizeof all / sizeof *all; i++)
        status =
            fp3_bodies_room(all[i].array, all[i].room, all[i].size, all[i].count, bodies->error);
    return status;
}

void fp3_trees_free(fp3_bodies *bodies) {
    fp3_trees *t = bodies->trees;
    if (!t)
        return;
    free(t->bond);
    free(t->node);
    free(t->place);
    free(t->twist);
    free(t->slot);
    free(t->light_a);
    free(t->light_b);
    free(t->light_heft);
    free(t);
    bodies->trees = NULL;
}

/* ---- which joints are in trees ---- */

static uint32_t set_of(place *places, uint32_t k) {
    while (places[k].root != k) {
        places[k].root = places[places[k].root].root;
        k = places[k].root;
    }
    return k;
}

static void join(place *places, uint32_t a, uint32_t b) {
    a = set_of(places, a);
    b = set_of(places, b);
    places[a < b ? a : b].all++;
    if (a == b)
        return;
    place *first = &places[a < b ? a : b], *second = &places[a < b ? b : a];
    second->root = first->root;
    first->bodies += second->bodies;
    first->all += second->all;
    first->held += second->held;
    first->mass += second->mass;
    first->least = fminf(first->least, second->least);
}

static void name(fp3_bodies *bodies, uint32_t k) {
    fp3_trees *t = bodies->trees;
    if (k >= bodies->movable || t->place[k].root != FP3_NOBODY)
        return;
    const float mass = bodies->body[bodies->in_slot[k]].mass;
    t->place[k] = (place){.root = k, .bodies = 1, .mass = mass, .least = mass, .number = t->count};
    t->slot[t->count++] = k;
}

/* An end of a joint that moves. */
static uint32_t inner_of(const fp3_bodies *bodies, uint32_t pin) {
    const fp3_law_rows *pins = &bodies->joined[PIN];
    return pins->a[pin] < bodies->movable ? pins->a[pin] : pins->b[pin];
}

static void find_sets(fp3_bodies *bodies, const fp3_law_rows *pins) {
    fp3_trees *t = bodies->trees;
    for (uint32_t i = 0; i < pins->count; i++)
        t->place[pins->a[i]].root = t->place[pins->b[i]].root = FP3_NOBODY;
    t->count = 0;
    for (uint32_t i = 0; i < pins->count; i++) {
        name(bodies, pins->a[i]);
        name(bodies, pins->b[i]);
    }
    for (uint32_t i = 0; i < pins->count; i++)
        if (pins->a[i] < bodies->movable && pins->b[i] < bodies->movable)
            join(t->place, pins->a[i], pins->b[i]);
        else
            t->place[set_of(t->place, inner_of(bodies, i))].held++;
}

static int is_heavy_tree(place *places, uint32_t k) {
    const place *set = &places[set_of(places, k)];
    return set->all + 1 == set->bodies && set->held <= 1 &&
           (double)set->mass > HEAVY * (double)set->least;
}

static void put_bond(fp3_bodies *bodies, uint32_t pin, uint32_t below) {
    fp3_trees *t = bodies->trees;
    const fp3_law_rows *pins = &bodies->joined[PIN];
    if (!fp3_share_has(bodies, pins->a[pin], pins->b[pin]))
        return;
    const int is_b = pins->b[pin] == below;
    const uint32_t above = is_b ? pins->a[pin] : pins->b[pin], twist = t->twist[pins->of[pin]];
    t->bond[t->bonds++] = (bond){.below = below,
                                 .above = above < bodies->movable ? above : FP3_NOBODY,
                                 .pin = pin,
                                 .twist = twist,
                                 .is_b = is_b,
                                 .size = twist == FP3_NOBODY ? 2 : 3};
}

/* Who has one joint left hangs on who is at its other end; whoever has none left is a root. */
static void peel(fp3_bodies *bodies, uint32_t k) {
    fp3_trees *t = bodies->trees;
    const fp3_law_rows *pins = &bodies->joined[PIN];
    for (place *at = &t->place[k]; at->edges == 1;) {
        const uint32_t pin = at->last, above = pins->a[pin] == k ? pins->b[pin] : pins->a[pin];
        at->edges = 0;
        at->hangs = 1;
        put_bond(bodies, pin, k);
        if (above >= bodies->movable)
            return;
        t->place[above].edges--;
        t->place[above].last ^= pin;
        if (t->place[above].number > at->number)
            return;
        k = above;
        at = &t->place[k];
    }
}

static void find_bonds(fp3_bodies *bodies) {
    fp3_trees *t = bodies->trees;
    const fp3_law_rows *pins = &bodies->joined[PIN];
    for (uint32_t i = 0; i < 2 * pins->count; i++) {
        const uint32_t pin = i / 2, k = i % 2 ? pins->b[pin] : pins->a[pin];
        if (k >= bodies->movable)
            continue;
        t->place[k].edges++;
        t->place[k].last ^= pin;
    }
    for (uint32_t i = 0; i < t->count; i++)
        if (t->place[t->slot[i]].is_in)
            peel(bodies, t->slot[i]);
}

static int is_firm(const fp3_joint *j) { return j->def.type == FP3_WELD && !(j->def.hertz > 0); }

static int is_known_light(const fp3_bodies *bodies) {
    const fp3_trees *t = bodies->trees;
    const fp3_law_rows *pins = &bodies->joined[PIN];
    return t->light_pins == pins->count && t->light_slots == bodies->movable &&
           !memcmp(t->light_a, pins->a, pins->count * sizeof *pins->a) &&
           !memcmp(t->light_b, pins->b, pins->count * sizeof *pins->b) &&
           !memcmp(t->light_heft, bodies->heft, bodies->movable * sizeof *bodies->heft);
}

static void keep_light(const fp3_bodies *bodies, int is_light) {
    fp3_trees *t = bodies->trees;
    const fp3_law_rows *pins = &bodies->joined[PIN];
    t->light_pins = is_light ? pins->count : FP3_NOBODY;
    t->light_slots = bodies->movable;
    memcpy(t->light_a, pins->a, pins->count * sizeof *pins->a);
    memcpy(t->light_b, pins->b, pins->count * sizeof *pins->b);
    memcpy(t->light_heft, bodies->heft, bodies->movable * sizeof *bodies->heft);
}

fp3_status fp3_trees_find(fp3_bodies *bodies) {
    const fp3_law_rows *pins = &bodies->joined[PIN], *twists = &bodies->joined[TWIST];
    if (bodies->trees)
        bodies->trees->bonds = 0;
    const fp3_status status = pins->count ? make_room(bodies) : FP3_OK;
    fp3_trees *t = bodies->trees;
    if (status || !pins->count || is_known_light(bodies))
        return status;
    find_sets(bodies, pins);
    for (uint32_t i = 0; i < t->count; i++)
        t->place[t->slot[i]].is_in = is_heavy_tree(t->place, t->slot[i]);
    int is_any = 0;
    for (uint32_t i = 0; i < pins->count; i++) {
        const uint32_t k = inner_of(bodies, i);
        bodies->joint[pins->of[i]].is_in_tree = (uint8_t)t->place[k].is_in;
        t->twist[pins->of[i]] = FP3_NOBODY;
        is_any |= t->place[k].is_in;
    }
    keep_light(bodies, !is_any);
    for (uint32_t i = 0; i < twists->count; i++)
        if (is_firm(&bodies->joint[twists->of[i]]))
            t->twist[twists->of[i]] = i;
    if (is_any)
        find_bonds(bodies);
    return FP3_OK;
}

/* ---- small matrices, symmetric and positive ---- */

static void invert(square m, uint32_t size) {
    for (uint32_t k = 0; k < size; k++) {
        const double by = 1 / m[k][k];
        m[k][k] = 1;
        for (uint32_t j = 0; j < size; j++)
            m[k][j] *= by;
        for (uint32_t i = 0; i < size; i++) {
            const double of = m[i][k];
            if (i == k)
                continue;
            m[i][k] = 0;
            for (uint32_t j = 0; j < size; j++)
                m[i][j] -= of * m[k][j];
        }
    }
}

/* to += rows m rows', where there are `size` rows. */
static void add_product(square to, square rows, square m, uint32_t size) {
    for (uint32_t i = 0; i < size; i++)
        for (uint32_t j = 0; j < size; j++)
            for (int k = 0; k < 3; k++)
                for (int l = 0; l < 3; l++)
                    to[i][j] += rows[i][k] * m[k][l] * rows[j][l];
}

/* to += rows' m rows. */
static void add_mass(square to, square rows, square m, uint32_t size) {
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++)
            for (uint32_t k = 0; k < size; k++)
                for (uint32_t l = 0; l < size; l++)
                    to[i][j] += rows[k][i] * m[k][l] * rows[l][j];
}

/* to += rows' of. */
static void add_push(double to[3], square rows, const double of[3], uint32_t size) {
    for (int i = 0; i < 3; i++)
        for (uint32_t k = 0; k < size; k++)
            to[i] += rows[k][i] * of[k];
}

/* to = m of. */
static void apply(double to[3], square m, const double of[3], uint32_t size) {
    for (uint32_t i = 0; i < size; i++) {
        to[i] = 0;
        for (uint32_t k = 0; k < size; k++)
            to[i] += m[i][k] * of[k];
    }
}

/* to -= rows of. */
static void take(double to[3], square rows, const double of[3], uint32_t size) {
    for (uint32_t i = 0; i < size; i++)
        for (int k = 0; k < 3; k++)
            to[i] -= rows[i][k] * of[k];
}

/* ---- a substep ---- */

/* How the point of a body moves, and how it turns. */
static void fill(square rows, double x, double y, double sign) {
    const square of = {{sign, 0, -sign * y}, {0, sign, sign * x}, {0, 0, sign}};
    memcpy(rows, of, sizeof of);
}

static void turned(const fp3_bodies *bodies, uint32_t slot, double x, double y, double to[2]) {
    float turn[2] = {1, 0};
    fp3_turn2_by(turn, bodies->way[slot][2]);
    to[0] = (double)turn[0] * x - (double)turn[1] * y;
    to[1] = (double)turn[1] * x + (double)turn[0] * y;
}

/* A pull turns a body towards it, so much that light links between heavy bodies would swing faster
 * than substeps can follow. The pull is as if it were where the arm is at the end of the substep:
 * the body resists by as much more. */
static void stiffen(const fp3_bodies *bodies, uint32_t slot, const double arm[2],
                    const double pull[2], double sign) {
    const double by = sign * (arm[0] * pull[0] + arm[1] * pull[1]);
    if (slot < bodies->movable && by > 0)
        bodies->trees->node[slot].mass[2][2] += bodies->def.h / bodies->def.substeps * by;
}

/* What it holds, where its bodies are now, and the speed that it lacks. */
static void look(const fp3_bodies *bodies, bond *b, double push) {
    const fp3_law_rows *pins = &bodies->joined[PIN], *twists = &bodies->joined[TWIST];
    const uint32_t lane = pins->lane[b->pin] % FP3_WIDE,
                   ends[2] = {pins->a[b->pin], pins->b[b->pin]};
    const fp3_pin2_row *row = (const fp3_pin2_row *)pins->row + pins->lane[b->pin] / FP3_WIDE;
    const fp3_four *v = bodies->speed, *d = bodies->way;
    const double arm_a[2] = {row->a_x[lane], row->a_y[lane]},
                 arm_b[2] = {row->b_x[lane], row->b_y[lane]},
                 gap[2] = {row->gap_x[lane], row->gap_y[lane]};
    double a[2], c[2];
    turned(bodies, ends[0], arm_a[0], arm_a[1], a);
    turned(bodies, ends[1], arm_b[0], arm_b[1], c);
    stiffen(bodies, ends[0], a, b->held, -1);
    stiffen(bodies, ends[1], c, b->held, 1);
    fill(b->is_b ? b->high : b->low, a[0], a[1], -1);
    fill(b->is_b ? b->low : b->high, c[0], c[1], 1);
    for (int i = 0; i < 2; i++)
        b->want[i] = -push * (double)row->rate[lane] *
                     (gap[i] + ((double)d[ends[1]][i] - (double)d[ends[0]][i]) + (c[i] - arm_b[i]) -
                      (a[i] - arm_a[i]));
    if (b->size == 3) {
        const uint32_t at = twists->lane[b->twist] % FP3_WIDE;
        const fp3_twist2_row *twist =
            (const fp3_twist2_row *)twists->row + twists->lane[b->twist] / FP3_WIDE;
        b->want[2] = -push * (double)twist->rate[at] *
                     ((double)twist->turned[at] + (double)d[ends[1]][2] - (double)d[ends[0]][2]);
    }
    const double low[3] = {v[b->below][0], v[b->below][1], v[b->below][2]};
    const uint32_t other = ends[b->is_b ? 0 : 1];
    const double high[3] = {v[other][0], v[other][1], v[other][2]};
    take(b->want, b->low, low, b->size);
    take(b->want, b->high, high, b->size);
}

static void begin(const fp3_bodies *bodies, uint32_t slot, node *n) {
    const float m = bodies->heft[slot][0], i = bodies->heft[slot][1];
    *n = (node){0};
    n->mass[0][0] = n->mass[1][1] = 1 / (double)m;
    n->mass[2][2] = i > 0 ? 1 / (double)i : STANDS / (double)m;
}

/* What is above takes over what hangs on it. */
static void gather(bond *b, node *nodes) {
    node *low = &nodes[b->below];
    double moved[3];
    invert(low->mass, 3);
    memset(b->given, 0, sizeof b->given);
    add_product(b->given, b->low, low->mass, b->size);
    invert(b->given, b->size);
    apply(moved, low->mass, low->push, 3);
    take(b->want, b->low, moved, b->size);
    if (b->above == FP3_NOBODY)
        return;
    apply(b->impulse, b->given, b->want, b->size);
    add_mass(nodes[b->above].mass, b->high, b->given, b->size);
    add_push(nodes[b->above].push, b->high, b->impulse, b->size);
}

/* The joint's impulse, by how what it hangs on changes its speed. */
static void give(fp3_bodies *bodies, bond *b, node *nodes) {
    const fp3_law_rows *pins = &bodies->joined[PIN], *twists = &bodies->joined[TWIST];
    const uint32_t lane = pins->lane[b->pin] % FP3_WIDE;
    fp3_pin2_row *row = (fp3_pin2_row *)pins->row + pins->lane[b->pin] / FP3_WIDE;
    if (b->above != FP3_NOBODY)
        take(b->want, b->high, nodes[b->above].change, b->size);
    apply(b->impulse, b->given, b->want, b->size);
    row->p_x[lane] += (float)b->impulse[0];
    row->p_y[lane] += (float)b->impulse[1];
    if (b->size == 3) {
        fp3_twist2_row *twist = (fp3_twist2_row *)twists->row + twists->lane[b->twist] / FP3_WIDE;
        twist->s[twists->lane[b->twist] % FP3_WIDE] += (float)b->impulse[2];
    }
}

static void change(fp3_bodies *bodies, uint32_t slot, const node *n) {
    const fp3_four by = {(float)n->change[0], (float)n->change[1],
                         bodies->heft[slot][1] > 0 ? (float)n->change[2] : 0, 0};
    bodies->speed[slot] += by;
    bodies->base[slot] += by;
}

void fp3_trees_forget(fp3_bodies *bodies) {
    fp3_trees *t = bodies->trees;
    const fp3_law_rows *pins = &bodies->joined[PIN];
    for (uint32_t i = 0; t && i < t->bonds; i++) {
        bond *b = &t->bond[i];
        const uint32_t lane = pins->lane[b->pin] % FP3_WIDE;
        fp3_pin2_row *row = (fp3_pin2_row *)pins->row + pins->lane[b->pin] / FP3_WIDE;
        b->held[0] = (double)row->p_x[lane];
        b->held[1] = (double)row->p_y[lane];
        row->p_x[lane] = row->p_y[lane] = 0;
    }
}

void fp3_trees_solve(fp3_bodies *bodies, int push) {
    fp3_trees *t = bodies->trees;
    if (!t || !t->bonds)
        return;
    for (uint32_t i = 0; i < t->count; i++)
        if (t->place[t->slot[i]].is_in)
            begin(bodies, t->slot[i], &t->node[t->slot[i]]);
    for (uint32_t i = 0; i < t->bonds; i++)
        look(bodies, &t->bond[i], push);
    for (uint32_t i = 0; i < t->bonds; i++)
        gather(&t->bond[i], t->node);
    for (uint32_t i = 0; i < t->count; i++) {
        node *n = &t->node[t->slot[i]];
        if (!t->place[t->slot[i]].is_in || t->place[t->slot[i]].hangs)
            continue;
        invert(n->mass, 3);
        apply(n->change, n->mass, n->push, 3);
    }
    for (uint32_t i = t->bonds; i-- > 0;) {
        bond *b = &t->bond[i];
        node *low = &t->node[b->below];
        give(bodies, b, t->node);
        add_push(low->push, b->low, b->impulse, b->size);
        apply(low->change, low->mass, low->push, 3);
    }
    for (uint32_t i = 0; i < t->count; i++)
        if (t->place[t->slot[i]].is_in)
            change(bodies, t->slot[i], &t->node[t->slot[i]]);
}
