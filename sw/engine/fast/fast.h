/* SPDX-License-Identifier: Apache-2.0 */
/* fast.h - a program over many objects, a block of them at a time, as native code or interpreted.
 *
 * Objects are columns: for each register the words of all objects one after the other. A worker,
 * one for each thread, takes a block of objects through all steps of a run while it stays in the
 * processor's caches, with the rounding of the configuration; what the objects hold before and
 * after is what the isa engine has, bit for bit.
 *
 * Flags cost almost nothing: the processor's own are sticky. They are looked at now and then, and
 * if something is raised that is not known of every object of the block, those steps are executed
 * once more by the interpreter, which knows whose flags they are.
 *
 *     fp3_fast *fast = NULL;
 *     fp3_fast_worker *worker = NULL;
 *     fp3_fast_make(&def, &fast, error), fp3_fast_worker_make(&worker, error);
 *     fp3_fast_block(fast, worker, &run, list, 0, count, error);   (a block)
 */
#ifndef FP3_FAST_H
#define FP3_FAST_H

#include "run.h"

#include <fp3/engine.h>
#include <machine/config.h>
#include <machine/neighbours.h>
#include <machine/placement.h>
#include <machine/watch.h>

typedef struct {
    const fp3_config *config; /* these four must outlive the program */
    const fp3_code *code;
    const uint8_t *is_ahead;         /* of each word: it works for the step that follows */
    uint64_t states;                 /* registers whose values must be finite */
    const fp3_neighbourhood *around; /* what it reads of other objects */
    int is_interpreted;              /* 1: no native code is made */
    int is_without_compiler;         /* 1: ... but for what the cache has */
    const char *native; /* a file of fp3_fast_write_native that must have the program, or NULL */
} fp3_fast_def;

typedef struct {
    int is_interpreted;
    char most[16]; /* the best kind of processor that may be used; "": any */
} fp3_fast_wish;

/* What the variable FP3_FAST asks for: a kind of processor, or "interpreter", or both with a comma.
 * FP3_E_ARGUMENT: what is not there. */
fp3_status fp3_fast_wished(fp3_fast_wish *wish, fp3_error *error);

/* FP3_E_PROGRAM: the engine cannot execute it, see fp3_fast_plan_make; or as of
 * fp3_fast_native_load. is_ahead may be NULL. */
fp3_status fp3_fast_check(const fp3_fast_def *def, fp3_error *error);
/* The caller frees *fast. FP3_E_PROGRAM as of fp3_fast_check; FP3_E_ARGUMENT: the variable FP3_FAST
 * asks for what is not there. Without a compiler the program is interpreted. */
fp3_status fp3_fast_make(const fp3_fast_def *def, fp3_fast **fast, fp3_error *error);
void fp3_fast_free(fp3_fast **fast);
/* "native x86-64-v4", or "interpreter x86-64-v3 (why)". */
const char *fp3_fast_how(const fp3_fast *fast);
int fp3_fast_is_native(const fp3_fast *fast);
/* See fp3_fast_native_write. */
fp3_status fp3_fast_write_native(const fp3_fast *fast, const char *path, fp3_error *error);
/* The registers that a run reads or writes: they need a column. */
uint64_t fp3_fast_columns(const fp3_fast *fast);

fp3_status fp3_fast_worker_make(fp3_fast_worker **worker, fp3_error *error);
void fp3_fast_worker_free(fp3_fast_worker **worker);

/* The objects list[0 .. count), or first + 0 .. first + count - 1 if list is NULL; at most
 * FP3_BLOCK. All are awake. FP3_E_SYSTEM: no memory for failures. */
fp3_status fp3_fast_block(fp3_fast *fast, fp3_fast_worker *worker, const fp3_fast_run *run,
                          const uint32_t *list, uint32_t first, uint32_t count, fp3_error *error);

/* What the worker's blocks raised and who failed, since it was made or last asked. */
uint32_t fp3_fast_flags(fp3_fast_worker *worker);
size_t fp3_fast_failures(const fp3_fast_worker *worker, const fp3_failed **failures);
void fp3_fast_forget(fp3_fast_worker *worker);

#endif
