/* SPDX-License-Identifier: Apache-2.0 */
/* ahead.c - see ahead.h. One pass backwards: what is live after the step does not count. */
#include "ahead.h"

#include "live.h"

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
                       !(live >> word->in.d & 1);
        live = is_ahead[pc] ? live : fp3_live_before(word, live);
        if (pc == program->last)
            after |= live;
    }
}
