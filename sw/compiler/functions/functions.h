/* SPDX-License-Identifier: Apache-2.0 */
/* functions.h - the functions of the language as operations of the machine: fp3_sin, fp3_exp, ...
 *
 * A declaration for each row of language/function_rows.h that has constants. docs/compiler.md has
 * the method, the errors and the special values of each function.
 */
#ifndef FP3_FUNCTIONS_H
#define FP3_FUNCTIONS_H

#include "compiler/value/term.h"
#include "language/function_rows.h"

#define FP3_DECLARE_INSTRUCTIONS(name)
#define FP3_DECLARE_POLYNOMIAL(name) term fp3_##name(dag *g, term x);
#define FP3_DECLARE_POLYNOMIAL_2(name) term fp3_##name(dag *g, term y, term x);
#define X(OP, name, MADE, ...) FP3_DECLARE_##MADE(name)
FP3_FUNCTION_ROWS(X)
#undef X

#endif
