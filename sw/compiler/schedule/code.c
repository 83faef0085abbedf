/* SPDX-License-Identifier: Apache-2.0 */
/* code.c - see code.h. */
#include "code.h"

#include "machine/operation.h"

uint32_t fp3_code_variable(const fp3_step_code *code, uint32_t variable) {
    return code->param_registers ? 2 * variable : variable;
}

uint32_t fp3_code_param(const fp3_step_code *code, uint32_t param) {
    return code->param_registers ? code->param_registers[param] : code->variable_count + param;
}

fp3_ref fp3_code_owner(const fp3_step_code *code, uint32_t reg) {
    for (uint32_t x = 0; x < code->variable_count; x++)
        if (fp3_code_variable(code, x) == reg)
            return (fp3_ref){FP3_AT_VARIABLE, x};
    for (uint32_t p = 0; p < code->param_count; p++)
        if (fp3_code_param(code, p) == reg)
            return (fp3_ref){FP3_AT_PARAM, p};
    return (fp3_ref){FP3_AT_NOWHERE, reg};
}

fp3_needs fp3_code_needs(const fp3_step_code *code) {
    const fp3_op *parts[] = {code->first, code->step, code->last};
    const uint32_t counts[] = {code->first_count, code->step_count, code->last_count};
    fp3_needs needs = {.constants = code->constant_count};
    for (int part = 0; part < 3; part++) {
        needs.words += counts[part];
        for (uint32_t i = 0; i < counts[part]; i++)
            needs.operations |= fp3_operation_bit(parts[part][i].op);
    }
    return needs;
}
