/* SPDX-License-Identifier: Apache-2.0 */
/* near_code.c - see near_code.h. */
#include "near_code.h"

#include <float.h>
#include <fp3/isa.h>

#define BIT(reg) (UINT64_C(1) << (reg))
#define SQUARES 1e-6 /* a share: squares and their sums in FP32 are wrong by less */

const fp3_list *fp3_near_code_list(const fp3_lists *lists) {
    const fp3_list *found = NULL;
    for (uint32_t i = 0; i < lists->shape.list_count; i++) {
        const fp3_list *list = &lists->lists[i];
        if (!list->is_near)
            continue;
        const fp3_near_rule *rule = &list->near;
        if (found || list->fields || list->kind || rule->radius || rule->is_pair || rule->format ||
            list->own < list->objects)
            return NULL;
        found = list;
    }
    return found;
}

static void put(fp3_near_code *to, uint32_t op, uint32_t d, uint32_t a, uint32_t b, uint32_t c) {
    to->word[to->count++] =
        fp3_word_encode(&(fp3_instruction){.op = op, .d = d, .a = a, .b = b, .c = c});
}

static void choose_temporary(const fp3_near_names *names, uint32_t registers, uint32_t *temp) {
    uint64_t used = BIT(names->list) | BIT(names->source);
    for (uint32_t k = 0; k < names->dimensions; k++)
        used |= BIT(names->at[k]) | BIT(names->made[k]);
    for (uint32_t k = 0; k < names->dimensions; k++) {
        while (used >> --registers & 1)
            ;
        temp[k] = registers;
    }
}

/* To the first register: the constant, from or to which `op` takes the square of each. */
static void put_squares(fp3_near_code *code, uint32_t op, const uint32_t *temp, uint32_t dimensions,
                        uint32_t constant) {
    put(code, op, temp[0], temp[0], temp[0], constant);
    for (uint32_t k = 1; k < dimensions; k++)
        put(code, op, temp[0], temp[k], temp[k], temp[0]);
}

void fp3_near_check(const fp3_near_names *names, uint32_t registers, fp3_near_code *code) {
    uint32_t temp[FP3_NEAR_DIMENSIONS];
    choose_temporary(names, registers, temp);
    code->count = 0;
    for (uint32_t k = 0; k < names->dimensions; k++) {
        put(code, FP3_OP_LD, names->at[k], 0, 0, 0);
        put(code, FP3_OP_LD, names->made[k], 0, 0, 0);
    }
    for (uint32_t k = 0; k < names->dimensions; k++)
        put(code, FP3_OP_SUB, temp[k], names->at[k], names->made[k], 0);
    /* negative: it has moved too far */
    put_squares(code, FP3_OP_MSUB, temp, names->dimensions, names->moved);
    put(code, FP3_OP_RAISE, temp[0], 0, 0, 0);
}

void fp3_near_renew(const fp3_near_names *names, uint32_t registers, fp3_near_code *code) {
    uint32_t temp[FP3_NEAR_DIMENSIONS];
    choose_temporary(names, registers, temp);
    code->count = 0;
    put(code, FP3_OP_LD, names->list, 0, 0, 0);
    put(code, FP3_OP_LD, names->source, 0, 0, 0);
    for (uint32_t k = 0; k < names->dimensions; k++)
        put(code, FP3_OP_LD, names->at[k], 0, 0, 0);
    for (uint32_t k = 0; k < names->dimensions; k++) /* as it is; of a NaN the second one */
        put(code, FP3_OP_MAX, names->made[k], names->at[k], names->nowhere, 0);
    put(code, FP3_OP_EACH, names->source, 0, 0, 0);
    for (uint32_t k = 0; k < names->dimensions; k++)
        put(code, FP3_OP_SUBN, temp[k], names->at[k], names->at[k], 0);
    /* negative: the neighbour is near */
    put_squares(code, FP3_OP_MADD, temp, names->dimensions, names->reach);
    put(code, FP3_OP_KEEP, names->list, temp[0], names->room, 0);
    put(code, FP3_OP_NEXT, 0, 0, 0, 0);
    put(code, FP3_OP_ST, names->list, 0, 0, 0);
    for (uint32_t k = 0; k < names->dimensions; k++)
        put(code, FP3_OP_ST, names->made[k], 0, 0, 0);
}

static uint32_t bits(double value) {
    const float f = (float)value;
    uint32_t word;
    memcpy(&word, &f, sizeof word);
    return word;
}

uint32_t fp3_near_moved(double distance) {
    const double moved = distance * (1 - FP3_NEAR_ROUNDING);
    return bits(fmin(moved * moved, FLT_MAX));
}

uint32_t fp3_near_reached(const fp3_near_rule *rule) {
    const double reach = fp3_near_reach(rule) * (1 + SQUARES);
    return bits(-reach * reach);
}
