/* ahead.c - see ahead.h. One pass backwards: what is live after the step does not count. */
#include "ahead.h"

static uint64_t bit(uint32_t operand) {
    return operand < FP3_BANK_SHARED_BASE ? (uint64_t)1 << operand : 0;
}

/* The registers that are live before an instruction. */
static uint64_t before(const fp3_decoded *word, uint64_t live) {
    if (word->of->writes == FP3_WRITES_ALWAYS)
        live &= ~bit(word->in.d);
    if (word->of->writes == FP3_WRITES_NEVER)
        live |= bit(word->in.d);
    for (uint32_t i = 0; i < word->of->sources; i++)
        live |= bit(fp3_operand(&word->in, "abc"[i]));
    return live;
}

void fp3_ahead_find(const fp3_code *program, uint64_t states, uint8_t *is_ahead) {
    uint64_t live = 0, after = states; /* after: a step */
    for (uint32_t pc = program->count; pc-- > program->step;) {
        const fp3_decoded *word = &program->decoded[pc];
        if (pc + 1 == program->last)
            live = after;
        if (!word->of)
            continue;
        if (word->in.op == FP3_OP_SLEEP) /* the last part follows at once */
            live |= after;
        is_ahead[pc] = pc < program->last && word->of->writes == FP3_WRITES_ALWAYS &&
                       !(live & bit(word->in.d));
        live = is_ahead[pc] ? live : before(word, live);
        if (pc == program->last)
            after |= live;
    }
}
