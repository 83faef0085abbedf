/* inverse.c - see inverse.h. */
#include "inverse.h"

#include "raised.h"

#include <machine/execute.h>

void fp3_inverse(int *words, unsigned lanes, int is_root) {
    static const fp3_config mixed = {
        .nearest = 1, .subnormal = 1, .fraction = 23, .flags = 1, .mixed = 1};
    uint32_t flags = 0;
    for (unsigned i = 0; i < lanes; i++) {
        uint32_t raised;
        words[i] = (int)fp3_execute(&mixed, is_root ? FP3_OP_RSQRT : FP3_OP_RCP,
                                    (const uint32_t[]){(uint32_t)words[i], 0, 0}, &raised);
        flags |= raised;
    }
    fp3_fpu_set(fp3_fpu_get() | fp3_fast_sticky(flags));
}
