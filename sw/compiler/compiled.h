/* compiled.h - what a compiled program keeps: fp3_compiled.self. */
#ifndef FP3_COMPILED_H
#define FP3_COMPILED_H

#include "names.h"
#include "pipeline.h"

typedef struct {
    fp3_options options;
    fp3_pipeline p;
    fp3_step reference; /* the same step without any pass that keeps the bits */
    fp3_names names;
} fp3_compilation;

#endif
