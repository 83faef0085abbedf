/* losses.c - what language/loss.h calls underflow, beside the flag of the processor.
 *
 *     losses N      a line "OPERATION FLAGGED DIFFERENT" for each operation, of N operands by
 * chance
 */
#include <fenv.h>
#include <language/loss.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const fp3_expr_op ops[] = {
    FP3_EXPR_ADD,      FP3_EXPR_SUB,  FP3_EXPR_MUL,   FP3_EXPR_DIV,   FP3_EXPR_POWER, FP3_EXPR_SQRT,
    FP3_EXPR_SIN,      FP3_EXPR_TAN,  FP3_EXPR_ATAN2, FP3_EXPR_ASIN,  FP3_EXPR_EXP,   FP3_EXPR_LOG2,
    FP3_EXPR_LOGISTIC, FP3_EXPR_SINH, FP3_EXPR_TANH,  FP3_EXPR_EXPM1, FP3_EXPR_LOG1P};

static uint64_t draw(uint64_t *state) {
    *state = *state * UINT64_C(6364136223846793005) + 1442695040888963407;
    return *state >> 32;
}

/* Any bits; often few of them, a subnormal number or 0. */
static double number(uint64_t *state) {
    uint64_t bits = draw(state) << 32 | draw(state);
    const uint64_t kind = draw(state) % 8;
    double value;
    if (kind < 3)
        bits &= ~((UINT64_C(1) << draw(state) % 52) - 1);
    if (kind == 3)
        bits &= UINT64_C(0x801fffffffffffff);
    if (kind == 4)
        bits = 0;
    memcpy(&value, &bits, sizeof value);
    return value;
}

int main(int argc, char **argv) {
    const long count = argc > 1 ? atol(argv[1]) : 100000;
    for (size_t k = 0; k < sizeof ops / sizeof *ops; k++) {
        uint64_t state = 1;
        long flagged = 0, different = 0;
        for (long i = 0; i < count; i++) {
            double values[3] = {number(&state), number(&state), 0};
            char is_lost[3] = {0};
            const fp3_expr e = {.op = ops[k], .operand = {0, 1, FP3_NONE}};
            if (ops[k] == FP3_EXPR_EXP || ops[k] == FP3_EXPR_LOGISTIC) /* where it is small */
                values[0] = -700 - (double)(i % 64);
            feclearexcept(FE_ALL_EXCEPT);
            volatile double result = fp3_ode_compute(&e, NULL, values);
            const int is_flagged = fetestexcept(FE_UNDERFLOW) != 0;
            fp3_ode_compute_careful(&e, NULL, 2, values, is_lost);
            flagged += is_flagged;
            different += !isnan(result) && is_flagged != is_lost[2];
        }
        printf("%d %ld %ld\n", (int)ops[k], flagged, different);
    }
    return 0;
}
