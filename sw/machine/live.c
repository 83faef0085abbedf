/* SPDX-License-Identifier: Apache-2.0 */
/* live.c - see live.h. */
#include "live.h"

static uint64_t bit(uint32_t operand) {
    return operand < FP3_BANK_SHARED_BASE ? (uint64_t)1 << operand : 0;
}

uint64_t fp3_live_before(const fp3_decoded *word, uint64_t live) {
    if (word->of->writes == FP3_WRITES_ALWAYS)
        live &= ~bit(word->in.d);
    if (word->of->writes == FP3_WRITES_NEVER)
        live |= bit(word->in.d);
    for (uint32_t i = 0; i < word->of->sources; i++)
        live |= bit(fp3_operand(&word->in, "abc"[i]));
    return live;
}

/* An object that falls asleep goes to the last part, for which asleep is live. */
static uint64_t pass(const fp3_code *program, uint32_t begin, uint32_t end, uint64_t live,
                     uint64_t asleep) {
    for (uint32_t pc = end; pc-- > begin;) {
        const fp3_decoded *word = &program->decoded[pc];
        if (!word->of)
            continue;
        live = fp3_live_before(word, live) | (word->in.op == FP3_OP_SLEEP ? asleep : 0);
    }
    return live;
}

uint64_t fp3_live_between(const fp3_code *program) {
    const uint64_t last = pass(program, program->last, program->count, 0, 0);
    uint64_t head = 0;
    for (uint64_t old = UINT64_MAX; head != old;) {
        old = head;
        head |= pass(program, program->step, program->last, head | last, last);
    }
    return head | last;
}
