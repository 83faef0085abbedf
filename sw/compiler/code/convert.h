/* SPDX-License-Identifier: Apache-2.0 */
/* convert.h - a step to code: operations whose operands name values, for one configuration. */
#ifndef FP3_CONVERT_H
#define FP3_CONVERT_H

#include "choose.h"
#include "compiler/schedule/code.h"
#include "compiler/step/step.h"

/* Where a known value is kept. */
typedef struct {
    fp3_place at; /* PARAM or CONSTANT; NOWHERE: it is not needed */
    uint32_t index;
} known_slot;

typedef struct {
    fp3_step_code code;
    known_slot *slots; /* of each known value */
    uint32_t *params;  /* which known value each is */
    uint32_t *constants;
    uint32_t operations; /* of the step part; a chained one is two */
    uint32_t least;      /* constant: what `sleep` compares with; 0 without */
} conversion;

/* Nodes of the step, or FP3_NONE: neutral operands of chained sums and products, or of moves
 * between banks. */
typedef struct {
    uint32_t one, minus_zero;
} fp3_chain_nodes;

/* The caller closes, after a failure too. */
fp3_status fp3_convert(const fp3_step *step, const fp3_options *options, chain_policy policy,
                       fp3_chain_nodes chain, conversion *made, fp3_error *error);
/* Params that other kinds read stay words, whether or not this step reads them. */
void fp3_convert_seen(const fp3_step *step, const fp3_options *options, conversion *all);
void fp3_convert_close(conversion *made);

/* A step in sections (compiler/phases): opened once for all sections, then a code for each, which
 * the caller frees; its counts of params and constants are those of all sections, which are known
 * after fp3_convert_end. */
fp3_status fp3_convert_open(const fp3_step *step, conversion *made, fp3_error *error);
fp3_status fp3_convert_section(const fp3_step *section, const fp3_options *options, conversion *all,
                               fp3_step_code *code, fp3_error *error);
/* Which of the params a word of a param of the model is (0, or 1 of the second word of a pair); it
 * becomes one if it is none. */
uint32_t fp3_convert_param(const fp3_step *step, const fp3_options *options, conversion *all,
                           uint32_t param, uint32_t word);
void fp3_convert_end(const fp3_step *step, conversion *all);

#endif
