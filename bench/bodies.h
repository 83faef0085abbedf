/* bodies.h - the ship as a free body of a physics engine: thrust, drag, no contact.
 *
 * They do more than the ship asks for: two or three dimensions, a rotation, and a look at all
 * bodies for islands. They do less: one evaluation of the drag for each step, where rk4 has four.
 * Both update positions with the new speed, as programs/ship.s does. Box2D divides the speed by 1 +
 * hC/m, ODE multiplies it with 1 - hC/m, which is the same for all of its bodies.
 */
#ifndef BENCH_BODIES_H
#define BENCH_BODIES_H

#include "ship.h"

#ifdef __cplusplus
extern "C" {
#endif

typedef struct {
    void *(*make)(const bench_ships *ships); /* NULL: no memory */
    void (*step)(void *world, const bench_ships *ships, uint64_t steps);
    void (*end)(void *world, const bench_ships *ships); /* reads v and s; frees world */
} bench_bodies;

extern const bench_bodies bench_box2d; /* where BENCH_BOX2D is defined */
extern const bench_bodies bench_ode;   /* ... BENCH_ODE */

#ifdef __cplusplus
}
#endif

#endif
