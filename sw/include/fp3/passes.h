/* fp3/passes.h - the passes of the compiler that can be turned on and off (docs/compiler.md). */
#ifndef FP3_PASSES_H
#define FP3_PASSES_H

#include <fp3/api.h>

FP3_API_BEGIN

/* X(NAME, name, changes bits, what it does) */
#define FP3_PASSES(X)                                                                              \
    X(COMMON, "common", 0, "a value that is computed twice is computed once")                      \
    X(IDENTITY, "identity", 0, "x + -0, x - 0 and x * 1 cost nothing")                             \
    X(DEAD, "dead", 0, "what no observed state needs is left out")                                 \
    X(CARRY, "carry", 0, "what the step before has computed already is kept")                      \
    X(SCALE, "scale", 0, "half and twice ride on an addition, where the configuration can")        \
    X(CHAIN, "chain", 0, "a product goes straight into the addition that needs it")                \
    X(AHEAD, "ahead", 0, "operations of the next step fill the gaps of this one")                  \
    X(SHARE, "share", 0, "what all objects share is a constant, no register of each object")       \
    X(ZERO, "zero", 0, "a coefficient 0 of an integrator's table has no term")                     \
    X(FOLD_STEP, "fold-step", 1, "h times a coefficient is one number: y + (h a_ij) f")            \
    X(FOLD_PRODUCT, "fold-product", 1, "known factors of a product are one number: x (h/m)")       \
    X(OWN_WEIGHTS, "own-weights", 1, "each slope goes to the state by itself: y + b1 k1 + b2 k2")  \
    X(SMALL_ANGLES, "small-angles", 1, "sine and cosine of |x| <= pi/2 alone, NaN beyond")         \
    X(EXACT_DIVISION, "exact-division", 1, "quotients and roots, not powers, are correctly rounded")

typedef enum {
#define X(NAME, name, changes, what) FP3_PASS_##NAME,
    FP3_PASSES(X)
#undef X
        FP3_PASS_COUNT
} fp3_pass;
#define FP3_PASS(pass) (1u << (pass))

const char *fp3_pass_name(fp3_pass pass);
const char *fp3_pass_doc(fp3_pass pass);
int fp3_pass_changes_bits(fp3_pass pass);
/* FP3_PASS_COUNT: no such name. */
fp3_pass fp3_pass_find(const char *name);
/* The set of all passes that change bits, or of all that keep them. */
unsigned fp3_passes_that(int change_bits);

FP3_API_END

#endif
