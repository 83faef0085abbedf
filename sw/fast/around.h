/* around.h - a phase of objects that see each other, a block of them at a time.
 *
 * Objects are columns, as in fast.h. A word that neighbours read and a phase stores has two columns: a phase reads
 * `own` and `seen`, and writes `next`.
 */
#ifndef FP3_FAST_AROUND_H
#define FP3_FAST_AROUND_H

#include "fast.h"

/* One list of each object of a group, as the host gives it. */
typedef struct {
    const uint32_t *begin; /* objects + 1; NULL: all others */
    const uint32_t *other;
    const uint32_t *field;
    uint32_t fields, objects;
} fp3_fast_given;

typedef struct {
    fp3_fast_list list;
    void *memory[6]; /* of the list */
} fp3_fast_packed;

/* For vectors of the program's executor. FP3_E_SYSTEM: out of memory. The caller frees, after a failure too. */
fp3_status fp3_fast_pack(const fp3_fast *fast, const fp3_fast_given *given, fp3_fast_packed *packed,
                         fp3_error *error);
void fp3_fast_pack_free(fp3_fast_packed *packed);

/* What a phase of a group works on. */
typedef struct {
    uint32_t *const *own, *const *next; /* [64]: of the group's first object on */
    const uint32_t *constants;          /* [64] */
    const fp3_fast_list *lists;
    uint32_t objects; /* of the group */
} fp3_fast_group;

uint32_t fp3_fast_phases(const fp3_fast *fast);
/* Words that change and that neighbours read: they have two columns. */
uint64_t fp3_fast_doubled(const fp3_fast *fast);
/* Objects first .. first + count - 1 of the group make a phase; first is a multiple of FP3_BLOCK. What they raise is
 * the worker's. */
void fp3_fast_phase(const fp3_fast *fast, fp3_fast_worker *worker, const fp3_fast_group *group,
                    uint32_t phase, uint32_t first, uint32_t count);

#endif
