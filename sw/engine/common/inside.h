/* SPDX-License-Identifier: Apache-2.0 */
/* inside.h - what the project itself asks of an engine besides fp3/engine.h. */
#ifndef FP3_ENGINE_INSIDE_H
#define FP3_ENGINE_INSIDE_H

#include "layout.h"
#include "machine/config.h"
#include "machine/watch.h"

#include <fp3/engine.h>

/* fp3_engine_open with a configuration that need not be a named one, instead of def->config; it is
 * copied. Of "isa" and "fast": "rtl" is hardware that has been built. */
fp3_status fp3_engine_open_as(const fp3_engine_def *def, const fp3_config *config,
                              fp3_engine **engine);

/* fp3_engine_load without its checks: for tests of what the hardware does with words that are none
 * of its own. */
fp3_status fp3_engine_load_unchecked(fp3_engine *engine, const fp3_image *image);

/* fp3_engine_write, _read, _write_shared_of and _read_shared_of of words as the machine has them,
 * which are not converted: for tests that compare all bits. */
fp3_status fp3_engine_write_words(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                                  const uint32_t *words);
fp3_status fp3_engine_read_words(fp3_engine *engine, size_t first, size_t count, uint32_t reg,
                                 uint32_t *words);
fp3_status fp3_engine_write_shared_words(fp3_engine *engine, size_t group, uint32_t first,
                                         size_t count, const uint32_t *words);
fp3_status fp3_engine_read_shared_words(fp3_engine *engine, size_t group, uint32_t first,
                                        size_t count, uint32_t *words);

/* What the next run goes by: the steps of earlier runs, by which it numbers its own; the
 * definition, whose strings may be gone; the configuration. Tests change them. */
uint32_t *fp3_engine_clock(fp3_engine *engine);
/* Whether something was raised in the last run that leads from finite numbers to others; always
 * where no flags are kept. */
int fp3_engine_may_have_failed(const fp3_engine *engine);
fp3_engine_def *fp3_engine_definition(fp3_engine *engine);
fp3_config *fp3_engine_config(fp3_engine *engine);

/* For calls that have an error of their own, and are to be the only place that a caller looks at:
 * hush before the first use of the engine, hear after the last. What the engine says in the error
 * of its definition is then in error, too. error may be NULL. hear returns status. */
void fp3_engine_hush(fp3_error *error);
fp3_status fp3_engine_hear(fp3_engine *engine, fp3_status status, fp3_error *error);

/* What options, outputs and scenes ask of an engine; sw/engine/engine.c lists the engines. */
typedef struct {
    const char *name;
    int is_hardware;  /* has cycles and a bus; words of instruction memory as the configuration has
                       */
    int is_simulated; /* hardware whose pipeline can be seen, and whose bus can be made to wait */
    int has_port;
    int has_threads;
} fp3_engine_traits;
/* NULL with FP3_E_ARGUMENT in error: no engine has this name, which may be NULL. */
const fp3_engine_traits *fp3_engine_traits_of(const char *name, fp3_error *error);
/* The engine of a run that names none. Simulated hardware is too slow for scenes of many objects
 * that see each other. */
const char *fp3_engine_usual(int sees_others);

/* FP3_E_ARGUMENT: the engine is hardware whose configuration has no counters, so that nobody knows
 * the cycles of a run; all counters in its stats are 0. */
fp3_status fp3_engine_need_counters(const fp3_engine *engine, fp3_error *error);

/* Its objects are on several ranks: cycles are those of the slowest, and other counters sums over
 * all. */
int fp3_engine_is_divided(const fp3_engine *engine);

/* They belong to the engine. */
const char *fp3_engine_name(const fp3_engine *engine);
const fp3_layout *fp3_engine_layout(const fp3_engine *engine);
/* The members that have a group's lists, of whatever engine; NULL: none of its objects lives. */
const fp3_members *fp3_engine_members(const fp3_engine *engine, uint32_t group);
/* The row of each object, by which lists of near objects go; NULL: its number. */
const uint32_t *fp3_engine_rows(const fp3_engine *engine);

/* The states of a group for which its records have room, as a set of registers; the sleep register
 * is none. */
uint64_t fp3_engine_states_of(const fp3_members *group);

/* "" if there is one group, "group N: " if there are several: messages about a group begin so. */
typedef struct {
    char text[32];
} fp3_prefix;
fp3_prefix fp3_engine_prefix(size_t group, size_t count);

/* Whether some objects do not live always. */
int fp3_engine_has_lives(const fp3_engine *engine);
/* What fp3_engine_live said of an object. */
void fp3_engine_life_of(const fp3_engine *engine, size_t object, uint64_t *born, uint64_t *gone);
/* Births and ends between runs, of an engine with one group. What a pair remembers of one who is
 * buried is gone with it, as are its links. FP3_E_PROGRAM, of can_bury: as of fp3_engine_live. */
fp3_status fp3_engine_can_bury(fp3_engine *engine);
/* Objects live no more, but for those with stays[object] != 0, which live or not, as before. */
fp3_status fp3_engine_bury(fp3_engine *engine, const uint8_t *stays);
/* Objects first .. first+count-1 live from here on, or do not live, as if they never had. */
fp3_status fp3_engine_unborn(fp3_engine *engine, size_t first, size_t count);
fp3_status fp3_engine_bear(fp3_engine *engine, size_t first, size_t count);
/* All that these objects keep between runs is 0, as after an open; so is their status. */
fp3_status fp3_engine_wipe(fp3_engine *engine, size_t first, size_t count);
/* From here on as if the runs since the load had made so many steps; the caller writes what objects
 * held then, and what pairs remembered. */
void fp3_engine_resume(fp3_engine *engine, uint64_t made);
/* What pairs of a group remember in one of its lists, of which fp3_list_remembers is true. The
 * caller frees *saved with fp3_remembered_free, also after a failure. Written, it is of objects of
 * the group, and nobody wakes. FP3_E_SYSTEM: out of memory. */
fp3_status fp3_engine_read_remembered(fp3_engine *engine, uint32_t group, uint32_t list,
                                      fp3_remembered *saved);
fp3_status fp3_engine_write_remembered(fp3_engine *engine, uint32_t group, uint32_t list,
                                       const fp3_remembered *saved);
/* What the configuration keeps of the status of all objects, one word each. FP3_E_ARGUMENT: it
 * keeps none. */
fp3_status fp3_engine_read_status(fp3_engine *engine, uint32_t *words);
fp3_status fp3_engine_write_status(fp3_engine *engine, const uint32_t *words);
/* FP3_E_ARGUMENT: an object's `steps` is no whole number, or would not be after so many more. */
fp3_status fp3_engine_check_count(fp3_engine *engine, uint32_t steps);
/* Those of the last run, by object, after fp3_engine_failure. */
const fp3_failed *fp3_engine_failures(const fp3_engine *engine, size_t *count);

/* From the next run on objects first .. first+count-1, of an engine with one group, make steps. The
 * others cost nothing and keep what they hold; as neighbours they can be read. `first` is 0; or
 * objects see each other, the engine is not hardware, and `first` is a multiple of FP3_USE_STEP. A
 * load makes it all objects again. Objects that see each other in several lanes are moved by this:
 * it has to be said before words are written to them. */
#define FP3_USE_STEP 16
void fp3_engine_use(fp3_engine *engine, size_t first, size_t count);

/* ---- guests: objects behind those that make steps, which only stand for objects of another engine
 * ---- */

typedef fp3_status fp3_exchange_fn(void *user, fp3_engine *engine);

/* At each phase of a run `begin` sends what own objects publish, and after `end` guests have what
 * their objects publish. Between the two an engine may compute for objects that see no guests. A
 * failure ends the run. */
typedef struct {
    fp3_exchange_fn *begin, *end; /* begin may be NULL */
    void *user;
    /* Of numbers that engines have, the largest; NULL: the own one. */
    uint64_t (*worst)(void *user, uint64_t key);
} fp3_exchange;
void fp3_engine_set_exchange(fp3_engine *engine, const fp3_exchange *exchange);
/* Sums over those that are near go by these numbers, one for each object and guest, all different:
 * as if a single engine had them all. They are copied, and hold until the next load. FP3_E_SYSTEM:
 * out of memory. */
fp3_status fp3_engine_set_numbers(fp3_engine *engine, const uint32_t *numbers);
/* A word of a record of these objects, of the engine's only group. */
fp3_status fp3_engine_gather(fp3_engine *engine, uint32_t reg, const uint32_t *objects,
                             size_t count, uint32_t *words);
/* Of an engine that is divided among processes: whether all of them were given the same up to now,
 * these 32-bit words of `size` bytes among it. What they do together must not depend on what they
 * do not share. FP3_E_ARGUMENT, on all: they were not. */
fp3_status fp3_engine_agree(fp3_engine *engine, const void *words, size_t size);

/* fp3_adaptive_look at objects first .. first+count-1. */
fp3_status fp3_adaptive_look_all(fp3_engine *engine, size_t first, size_t count,
                                 fp3_adaptive_object *found);

#endif
