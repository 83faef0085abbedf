/* code.c - see code.h. */
#include "code.h"

fp3_needs fp3_code_needs(const fp3_step_code *code) {
    const fp3_op *parts[] = {code->first, code->step, code->last};
    const uint32_t counts[] = {code->first_count, code->step_count, code->last_count};
    fp3_needs needs = {.constants = code->constant_count};
    for (int part = 0; part < 3; part++) {
        needs.words += counts[part];
        for (uint32_t i = 0; i < counts[part]; i++)
            needs.operations |= UINT32_C(1) << parts[part][i].op;
    }
    return needs;
}
