/* runner.h - who makes the steps of a scene: engine fast, or a loop written by hand.
 */
#ifndef BENCH_WORLD_RUNNER_H
#define BENCH_WORLD_RUNNER_H

#include "hand.h"

#include <fp3/scene.h>

typedef struct {
    const hand_loop *loop; /* NULL: the engine */
    void *state;
    fp3_engine *engine;
    const fp3_scene *scene;
    unsigned threads;
    double seconds;  /* the shortest turn; 0: none yet */
    hand_world now;  /* where objects are, after runner_read */
    void *memory[4]; /* of now */
} runner;

/* The scene must outlive it. Close it in any case. */
fp3_status runner_open_fast(runner *r, const fp3_scene *scene, unsigned threads, fp3_error *error);
/* FP3_E_ARGUMENT: there is no such loop, this processor cannot run it, or the scene's model has not
 * what it needs. FP3_E_MISMATCH: its estimates are not those of FP3. */
fp3_status runner_open_hand(runner *r, const fp3_scene *scene, const char *loop, fp3_error *error);
void runner_close(runner *r);

fp3_status runner_go(runner *r, uint64_t steps, fp3_error *error);
fp3_status runner_read(runner *r, fp3_error *error);
/* Words of positions and velocities that are others. */
size_t runner_differ(const runner *r, const runner *other);

#endif
