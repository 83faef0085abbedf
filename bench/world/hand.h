/* hand.h - loops written by hand, which make the bits of FP3: what a scene could cost.
 *
 * Each file of loops is compiled for two kinds of processor.
 */
#ifndef BENCH_WORLD_HAND_H
#define BENCH_WORLD_HAND_H

#include <stddef.h>
#include <stdint.h>

#define HAND_WIDEST 16 /* of a vector, in floats */

/* Balls in a box: what programs/world/balls.ode has of all of them. */
typedef struct {
    float radius, stiff, damp, reach_square, over_m;
    float g[3], wall[3]; /* wall: where the box ends, along each axis */
} hand_contact;

/* Objects as columns; x and v are advanced. */
typedef struct {
    size_t objects;
    size_t first_kind; /* how many of them are of the first kind; the others are of another one */
    float *x[3], *v[3];
    float *weight; /* of each object: the inverse of its mass, or its mass */
    float h;
    float pull[3];     /* of all objects: mass times acceleration */
    float gravity;     /* G */
    float soft_square; /* of the softening */
    hand_contact contact;
    /* Links: entries begin[i] .. begin[i + 1] - 1 are of object i, in the order of its sum. */
    const uint32_t *begin, *other;
    const float *stiffness, *rest;
} hand_world;

typedef struct hand_loop hand_loop;
struct hand_loop {
    const char *scene; /* what it is of: "net", "stars", "balls" */
    const char *kind;  /* of processor: "x86-64-v4" */
    /* Prepares for this world, which stays the caller's. NULL: no memory, or a loop for balls has
     * some too far apart. */
    void *(*open)(const hand_world *world);
    /* 0: it cannot go on, as open. */
    int (*run)(void *state, uint64_t steps);
    /* Where the objects are now. */
    void (*read)(const void *state, hand_world *world);
    void (*close)(void *state);
    /* 1: its estimates are those of FP3, for all that a table tells apart. */
    int (*is_exact)(void);
};

extern const hand_loop hand_net_v4, hand_net_v3, hand_stars_v4, hand_stars_v3, hand_balls_v4,
    hand_balls_v3;

/* The best one of a scene that this processor can run, or NULL. */
const hand_loop *hand_find(const char *scene);

#endif
