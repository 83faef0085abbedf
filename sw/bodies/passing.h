/* SPDX-License-Identifier: Apache-2.0 */
/* passing.h - what threads do in the substeps of a step: passes over rows, and what a world in
 * space has besides.
 *
 * Parts get an fp3_passing, or the fp3_bodies, and threads of the crew, whose rows or slots they
 * do. */
#ifndef FP3_BODIES_PASSING_H
#define FP3_BODIES_PASSING_H

#include "own3.h"

/* What a pass is for. */
enum { FP3_WARM_WAY, FP3_PUSH_WAY, FP3_MEND_WAY, FP3_WAYS };

/* A pass over the rows of a law. */
typedef struct {
    fp3_work2 work;
    void (*pass)(const fp3_work2 *, uint32_t first, uint32_t end, const float shared[FP3_SHARED]);
    const float *shared;
    const uint32_t *cut;
    uint32_t law;  /* fp3_law or fp3_law3 */
    int has_moved; /* gaps first */
    fp3_substeps *all;
} fp3_passing;

struct fp3_substeps {
    float shared[FP3_WAYS][FP3_SHARED];
    fp3_passing pass[FP3_WAYS][FP3_JOINT_LAWS + 1]; /* the last ones are those over contacts */
    fp3_bodies *bodies;
    fp3_status status; /* of the engine that executes laws; no memory */
};

/* turned.c: a body that has turned far in this step. */
/* In a plane: slots first .. end - 1 of those who have; fp3_bodies.has_turned is set. */
void fp3_find_turned(fp3_bodies *bodies, uint32_t first, uint32_t end);
/* In a plane: whether a block of contacts has one. */
int fp3_block_has_turned(const fp3_bodies *bodies, uint32_t block);
/* Of slots first .. end - 1 that have turned far: without what contacts give, which their rows give
 * again (fp3_give_again, by one thread). */
void fp3_forget_turned(fp3_bodies *bodies, uint32_t first, uint32_t end);
void fp3_give_again(void *bodies, uint32_t from, uint32_t to);
/* substeps3.c: contacts in space. */
void fp3_space_pass(void *passing, uint32_t from, uint32_t to);
void fp3_space_pass_by_engine(void *passing, uint32_t from, uint32_t to);
/* Contacts of a block give what they gave in the last substep. */
fp3_status fp3_space_give(const fp3_passing *, uint32_t block);
/* Bodies go and turn. */
void fp3_space_place(void *bodies, uint32_t from, uint32_t to);

/* So many joints are worth a thread. */
enum { FP3_LEAST_STANCES = 8 };
/* joints3.c: joints from .. to - 1 stand where bodies are now; rows are made of that. */
void fp3_space_joints_stand_some(void *bodies, uint32_t from, uint32_t to);
void fp3_space_joints_fill_some(void *bodies, uint32_t from, uint32_t to);

#endif
