/* ahead.c - see ahead.h. One pass backwards: what is live after the step does not count. */
#include "ahead.h"

#include <machine/operation.h>

static uint64_t bit(uint32_t operand) {
    return operand < FP3_BANK_SHARED_BASE ? (uint64_t)1 << operand : 0;
}

/* The registers that are live before an instruction. */
static uint64_t before(const fp3_instruction *in, const fp3_operation *of, uint64_t live) {
    if (of->writes == FP3_WRITES_ALWAYS)
        live &= ~bit(in->d);
    if (of->writes == FP3_WRITES_NEVER)
        live |= bit(in->d);
    for (uint32_t i = 0; i < of->sources; i++)
        live |= bit(fp3_operand(in, "abc"[i]));
    return live;
}

void fp3_ahead_find(const fp3_code *program, uint64_t states, uint8_t *is_ahead) {
    uint64_t live = 0, after = states; /* after: a step */
    for (uint32_t pc = program->count; pc-- > program->step;) {
        fp3_instruction in;
        if (pc + 1 == program->last)
            live = after;
        if (fp3_word_decode(program->code[pc], &in, NULL))
            continue;
        const fp3_operation *of = fp3_operation_find(in.op);
        if (in.op == FP3_OP_SLEEP) /* the last part follows at once */
            live |= after;
        is_ahead[pc] = pc < program->last && of->writes == FP3_WRITES_ALWAYS && !(live & bit(in.d));
        live = is_ahead[pc] ? live : before(&in, of, live);
        if (pc == program->last)
            after |= live;
    }
}
