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
    fp3_pipeline p;
    fp3_differentiated
        differentiated; /* the model of both steps, where the integrator needs a Jacobian */
    fp3_step reference; /* the same step without any pass that keeps the bits */
    fp3_names names;
} fp3_compilation;

#endif
