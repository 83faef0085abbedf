/* SPDX-License-Identifier: Apache-2.0 */
/* batch_own.h - what the files of a batch share. */
#ifndef FP3_BATCH_OWN_H
#define FP3_BATCH_OWN_H

#include "births.h"
#include "fields.h"
#include "relations.h"

#include <fp3/program.h>

struct fp3_batch {
    fp3_program *program; /* NULL: def.compiled is the caller's */
    const fp3_compiled *compiled;
    const fp3_image *image;
    fp3_engine *engine;
    fp3_fields *fields;
    fp3_relations relations;
    fp3_births births;
    struct fp3_met *met; /* contacts that were told (batch_contacts.c) */
    const char *config;
    int is_reach_new; /* a shared param was written, of which reaches may be made */
    fp3_error *error;
    size_t objects;   /* that may live at the same time */
    uint64_t since;   /* steps with this h */
    double before, h; /* the time until then */
    int is_adaptive, may_sleep, may_fail;
    int is_suspect; /* an object may have a state that is not finite */
};

/* Those near follow the shared params that their reach is made of. */
fp3_status fp3_batch_settle_reach(fp3_batch *batch);
/* Leaves NULL, which it may be already. */
void fp3_met_free(struct fp3_met **list);
/* After a load: those who do not live do not live there, either. */
fp3_status fp3_batch_tell_lives(fp3_batch *batch);

#endif
