/* SPDX-License-Identifier: Apache-2.0 */
/* compiled.h - what a compiled program keeps: fp3_compiled.self. */
#ifndef FP3_COMPILED_H
#define FP3_COMPILED_H

#include "compiler/integrate/derivative.h"
#include "names.h"
#include "pipeline.h"

typedef struct {
    fp3_config config; /* with as many words as a program counter reaches, if the host runs it */
    fp3_options options;
    fp3_coupling coupling; /* of the options, if they have one */
    fp3_model seen;        /* the model, with an expression for each param that others read ... */
    fp3_expr *seen_exprs;  /* ... that it did not have; NULL: it had all */
    fp3_pipeline p;
    fp3_differentiated
        differentiated; /* the model of both steps, where the integrator needs a Jacobian */
    fp3_step reference; /* the same step without any pass that keeps the bits */
    fp3_names names;
} fp3_compilation;

#endif
