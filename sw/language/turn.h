/* SPDX-License-Identifier: Apache-2.0 */
/* turn.h - which expressions of a model jump or bend, and what that depends on.
 *
 * Comparisons, min, max and abs turn: which of two things they are changes where their operands are
 * alike.
 */
#ifndef FP3_LANGUAGE_TURN_H
#define FP3_LANGUAGE_TURN_H

#include <fp3/model.h>

/* Of an expression, a set of: it depends on t; on states; it is linear in t, with coefficients that
 * are known; a derivative depends on it; the condition of an event does. */
enum {
    FP3_TURN_TIME = 1,
    FP3_TURN_STATE = 2,
    FP3_TURN_LINEAR = 4,
    FP3_TURN_RATE = 8,
    FP3_TURN_CONDITION = 16
};

/* kind: of each expression. */
void fp3_turn_kinds(const fp3_model *model, char *kind);

int fp3_turn_can(fp3_expr_op op);

/* Whether it turns, and t alone decides when. */
int fp3_turn_is_of_time(const fp3_model *model, const char *kind, uint32_t expr);
/* Whether it is of t alone and turns once at most, at a time that is known. */
int fp3_turn_is_linear(const fp3_model *model, const char *kind, uint32_t expr);

#endif
