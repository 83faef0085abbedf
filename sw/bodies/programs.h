/* SPDX-License-Identifier: Apache-2.0 */
/* programs.h - laws executed as what they are, programs: by an engine, contact by contact.
 *
 * An object of the engine is a contact of a colour; the words of its bodies are brought to it and
 * taken back. So `isa` and `rtl` execute a world's contacts, and so does a law that the caller has
 * changed.
 */
#ifndef FP3_BODIES_PROGRAMS_H
#define FP3_BODIES_PROGRAMS_H

#include "solve3.h"

#include <fp3/bodies.h>
#include <fp3/engine.h>

typedef struct fp3_laws fp3_laws;

/* By the engine of def, with its laws. The caller frees *laws. FP3_E_ARGUMENT: no such engine or
 * configuration. FP3_E_PROGRAM: a text is no law: it has words that contacts have not, or params.
 */
fp3_status fp3_laws_open(const fp3_bodies_def *def, fp3_laws **laws, fp3_error *error);
/* Why the last run failed. */
const char *fp3_laws_why(const fp3_laws *laws);
/* Of the plane or of space; NULL: there are no more. laws: NULL: those that are built in. */
const char *fp3_laws_text(const fp3_laws *laws, uint32_t dimensions, uint32_t law);
/* What the runs of a law have cost so far, on hardware; 0: there is no such law. A run is of one
 * colour, at most, and has so many lanes of rows in it. */
typedef struct {
    const char *name;
    const fp3_image *image;
    uint64_t runs, lanes, cycles;
    fp3_bus_use bus;
} fp3_laws_use;
int fp3_laws_used(const fp3_laws *laws, uint32_t law, fp3_laws_use *use);
void fp3_laws_close(fp3_laws **laws);

/* Blocks first .. end - 1 of a colour make a pass by law FP3_LAW_..., of the plane or of space as
 * the definition had it; point: of each row, if the law is of one. FP3_E_SYSTEM. */
fp3_status fp3_laws_run(fp3_laws *laws, uint32_t law, const fp3_work2 *work, uint32_t first,
                        uint32_t end, uint32_t point, const float shared[FP3_SHARED]);

#endif
