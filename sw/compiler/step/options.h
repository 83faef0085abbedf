/* SPDX-License-Identifier: Apache-2.0 */
/* options.h - what is asked of the passes. Each of them gets the same options and changes none. */
#ifndef FP3_OPTIONS_H
#define FP3_OPTIONS_H

#include <fp3/compile.h>
#include <machine/config.h>

#define FP3_STATES_MAX 64 /* a set of states is the bits of a uint64_t */

/* States of a model with events to locate: an event is known to be between two steps from here, and
 * the next attempt as well. Both are 0 while none is looked for. */
#define FP3_STATE_BEFORE "h_before"
#define FP3_STATE_BEHIND "h_behind"
/* With a tolerance and a root: the root there. */
#define FP3_STATE_ROOT_BEFORE "root_before"
#define FP3_STATE_ROOT_BEHIND "root_behind"

typedef struct {
    const fp3_config *config;
    unsigned passes;   /* a set of FP3_PASS(...) */
    uint64_t observed; /* the states to keep */
    fp3_arithmetic arithmetic;
    const uint32_t *partial, *rate; /* of the model, as of fp3_differentiate; NULL: not needed */
    int has_notes;                  /* the assembly gets comments */
    int shares_params;              /* params of the object are constants, too */
    int has_few_constants;          /* those for which there is no room are params of the object */
    const fp3_coupling *coupling;   /* what other kinds see; NULL: nothing */
    int may_spill;                  /* values that do not fit are kept in the object's record */
} fp3_options;

static inline int fp3_has_pass(const fp3_options *options, fp3_pass pass) {
    return (options->passes & FP3_PASS(pass)) != 0;
}

/* The passes that the configuration can use, and whose own needs are met. */
unsigned fp3_options_usable(unsigned passes, const fp3_config *config);

/* How many terms of its series a quotient or root needs. */
int fp3_options_terms(const fp3_options *options);

/* The set of these states of the model; names == NULL: all. FP3_E_ARGUMENT: no such state. */
fp3_status fp3_options_observe(const fp3_model *model, const char *const *names, size_t count,
                               uint64_t *observed, fp3_error *error);

#endif
