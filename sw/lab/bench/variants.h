/* SPDX-License-Identifier: Apache-2.0 */
/* variants.h - objects of a model that differ a little. */
#ifndef FP3_BENCH_VARIANTS_H
#define FP3_BENCH_VARIANTS_H

#include <fp3/compile.h>
#include <fp3/engine.h>

/* Parameters and start of an object: each parameter that objects do not share is 0.1 % larger than
 * that of the object before, each start 0.2 %, rounded to FP32; what adaptive steps add is the same
 * of all. params and initial have room for model->param_count and state_count numbers. */
void fp3_bench_variant(const fp3_model *model, size_t object, double *params, double *initial);

/* Loads the program and gives all objects their values. Object i is variant i % variants. What the
 * engine refuses is told where its definition says. */
fp3_status fp3_bench_start(fp3_engine *engine, const fp3_compiled *compiled, const fp3_model *model,
                           double h, size_t variants, fp3_error *error);

#endif
