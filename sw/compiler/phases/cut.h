/* SPDX-License-Identifier: Apache-2.0 */
/* cut.h - a step with sums over neighbours as sections: straight code, and loops over neighbours.
 *
 * A sum reads what neighbours held when its phase began. So the step is cut into phases, in each of
 * which every neighbour shows one value of each state, and a phase into sections, one after the
 * other:
 *
 *     straight, loops that need this alone, straight, loops that need earlier sums, ... straight
 *
 * A section is a step of its own: it reads variables as they were when it began, and writes some.
 * The cut adds variables for values that go from section to section, or from phase to phase.
 *
 * Of a step in segments (compiler/step/step.h) each is cut for itself: their phases follow each
 * other, and those of a segment that is repeated are the body of a loop.
 */
#ifndef FP3_CUT_H
#define FP3_CUT_H

#include "compiler/step/step.h"
#include "plan.h"

/* A word of the neighbour, or of the link to it, that a loop loads before anything else. */
typedef struct {
    uint32_t variable; /* that it becomes */
    uint32_t op;       /* NODE_OTHER_STATE, NODE_OTHER_PARAM or NODE_FIELD */
    uint32_t index;    /* of the model's states, params or fields */
    uint32_t word;     /* 0; 1: the second word of a pair */
} fp3_loaded;

typedef struct {
    uint32_t phase;
    uint32_t relation; /* a loop over its neighbours; FP3_NONE: straight */
    dag values;
    uint32_t *next; /* of each variable: a node of values, or FP3_NONE: it stays */
    fp3_loaded *loads;
    uint32_t load_count;
    fp3_loaded *stores; /* fields of the entry that become these variables in the end */
    uint32_t store_count;
} fp3_section;

typedef struct {
    fp3_section *sections;
    uint32_t section_count, phase_count;
    uint8_t times[FP3_CUT_PHASES];    /* of each phase with which a repetition begins, else 0 */
    uint64_t returns;                 /* phases with which one ends */
    uint64_t published;               /* states of the model that neighbours read */
    uint32_t list[FP3_RELATIONS_MAX]; /* of each relation: its variable, or FP3_NONE: no sum over
                                         this relation */
    uint32_t unused;                  /* a variable for unread words */
} fp3_cut;

/* Adds variables to the step. FP3_E_LIMIT: too many phases or sections. The caller closes, after a
 * failure too. */
fp3_status fp3_cut_make(fp3_step *step, fp3_cut *cut, fp3_error *error);
void fp3_cut_close(fp3_cut *cut);

#endif
