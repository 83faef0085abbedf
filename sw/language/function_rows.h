/* SPDX-License-Identifier: Apache-2.0 */
/* function_rows.h - the functions of the language, a row each: all that is to say of one, but for
 * the instructions that it becomes.
 *
 *     #define X(OP, name, MADE, UNIT, VALUE, SLOPE, C, PYTHON) case FP3_EXPR_##OP: return VALUE;
 *     FP3_FUNCTION_ROWS(X)
 *     #undef X
 *
 * A new function is a row here and one in FP3_EXPR_OPS (fp3/model.h), which has the number of its
 * operands, and fp3_NAME and fp3_pair_NAME in compiler/functions/ and compiler/pairs/. All else
 * follows. Where each operation counts, a switch has no default, so one that is left out does not
 * compile.
 *
 * OP: FP3_EXPR_OP. name: as it is written. MADE: INSTRUCTIONS, which compiler/step/lower.c knows;
 * or POLYNOMIAL and POLYNOMIAL_2, with constants, of one operand and of two. UNIT: what the
 * operands may be measured in, and the result is (dimension_check.c). VALUE: in double, of a, b and
 * c. SLOPE: the derivative, in the words of compiler/integrate/derivative.c: of operands a and b
 * with derivatives da, db and dc, and the function itself, f. It is not asked for where da, db and
 * dc are all 0. C, PYTHON: for other solvers; A, B and C are the operands, @ is the ending of a
 * function of <math.h>.
 */
#ifndef FP3_ODE_FUNCTION_ROWS_H
#define FP3_ODE_FUNCTION_ROWS_H

/* clang-format off */
#define FP3_FUNCTION_ROWS(X) \
    X(SQRT, sqrt, INSTRUCTIONS, ROOT, sqrt(a), product(k, number(k, 0.5), quotient(k, da, f)), \
      "sqrt@(A)", "jnp.sqrt(A)") \
    X(MIN, min, INSTRUCTIONS, SAME, a < b ? a : b, choice(k, two(k, FP3_EXPR_LESS, a, b), da, db), \
      "A < B ? A : B", "jnp.minimum(A, B)") /* b if one is a NaN, like the instruction */ \
    X(MAX, max, INSTRUCTIONS, SAME, b < a ? a : b, choice(k, two(k, FP3_EXPR_LESS, b, a), da, db), \
      "B < A ? A : B", "jnp.maximum(A, B)") \
    X(ABS, abs, INSTRUCTIONS, KEPT, fabs(a), \
      choice(k, two(k, FP3_EXPR_LESS, a, number(k, 0)), negated(k, da), da), \
      "fabs@(A)", "jnp.abs(A)") \
    X(SELECT, select, INSTRUCTIONS, CHOICE, a != 0 ? b : c, choice(k, a, db, dc), \
      "A != 0 ? B : C", "jnp.where(A != 0, B, C)") \
    X(SIN, sin, POLYNOMIAL, NONE, sin(a), product(k, one(k, FP3_EXPR_COS, a), da), \
      "sin@(A)", "jnp.sin(A)") \
    X(COS, cos, POLYNOMIAL, NONE, cos(a), product(k, negated(k, one(k, FP3_EXPR_SIN, a)), da), \
      "cos@(A)", "jnp.cos(A)") \
    X(TAN, tan, POLYNOMIAL, NONE, tan(a), product(k, sum(k, number(k, 1), square(k, f)), da), \
      "tan@(A)", "jnp.tan(A)") \
    X(ATAN, atan, POLYNOMIAL, NONE, atan(a), quotient(k, da, sum(k, number(k, 1), square(k, a))), \
      "atan@(A)", "jnp.arctan(A)") \
    X(ASIN, asin, POLYNOMIAL, NONE, asin(a), quotient(k, da, other_side(k, a)), \
      "asin@(A)", "jnp.arcsin(A)") \
    X(ACOS, acos, POLYNOMIAL, NONE, acos(a), negated(k, quotient(k, da, other_side(k, a))), \
      "acos@(A)", "jnp.arccos(A)") \
    X(ATAN2, atan2, POLYNOMIAL_2, RATIO, atan2(a, b), \
      quotient(k, difference(k, product(k, b, da), product(k, a, db)), sum(k, square(k, a), square(k, b))), \
      "atan2@(A, B)", "jnp.arctan2(A, B)") \
    X(EXP, exp, POLYNOMIAL, NONE, exp(a), product(k, f, da), \
      "exp@(A)", "jnp.exp(A)") \
    X(LOG, log, POLYNOMIAL, NONE, log(a), quotient(k, da, a), \
      "log@(A)", "jnp.log(A)") \
    X(LOG2, log2, POLYNOMIAL, NONE, log2(a), quotient(k, da, product(k, a, number(k, M_LN2))), \
      "log2@(A)", "jnp.log2(A)") \
    X(EXPM1, expm1, POLYNOMIAL, NONE, expm1(a), product(k, sum(k, f, number(k, 1)), da), \
      "expm1@(A)", "jnp.expm1(A)") \
    X(LOG1P, log1p, POLYNOMIAL, NONE, log1p(a), quotient(k, da, sum(k, number(k, 1), a)), \
      "log1p@(A)", "jnp.log1p(A)") \
    X(LOGISTIC, logistic, POLYNOMIAL, NONE, 1 / (1 + exp(-a)), \
      product(k, product(k, f, difference(k, number(k, 1), f)), da), \
      "1/(1 + exp@(-A))", "1/(1 + jnp.exp(-A))") \
    X(SINH, sinh, POLYNOMIAL, NONE, sinh(a), product(k, one(k, FP3_EXPR_COSH, a), da), \
      "sinh@(A)", "jnp.sinh(A)") \
    X(COSH, cosh, POLYNOMIAL, NONE, cosh(a), product(k, one(k, FP3_EXPR_SINH, a), da), \
      "cosh@(A)", "jnp.cosh(A)") \
    X(TANH, tanh, POLYNOMIAL, NONE, tanh(a), product(k, difference(k, number(k, 1), square(k, f)), da), \
      "tanh@(A)", "jnp.tanh(A)")
/* clang-format on */

#endif
