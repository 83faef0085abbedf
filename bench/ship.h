/* ship.h - the ship, Equations (1), as a loop by hand: the bits of programs/ship.s. */
#ifndef BENCH_SHIP_H
#define BENCH_SHIP_H

#include <stddef.h>
#include <stdint.h>

#define BENCH_SHIP_BLOCK 128 /* the largest block */

typedef struct {
    size_t objects; /* with room for whole blocks */
    float h;
    float *T, *C, *rm, *v, *s; /* a number for each object, aligned to 64 bytes */
} bench_ships;

/* Ways to make all steps, by number; NULL beyond the last. The vectors are of 16 floats, in as many
 * registers as the processor needs for one; 1, 2, 4 or 8 are interleaved, to hide latencies. */
typedef struct {
    const char *engine, *method;
    void (*run)(const bench_ships *ships, uint64_t steps);
    unsigned block; /* objects are a multiple of it */
    double ns;      /* of an object-step, roughly */
} bench_ship_loop;
const bench_ship_loop *bench_ship_loop_at(unsigned number);

/* "avx512f", "avx2" or "baseline": chosen at run time. */
const char *bench_ship_target(void);

#endif
