/* estimates.c - rcp and rsqrt of lanes.h give the bits of machine/estimate.c, and raise nothing.
 *
 * Both ends and the middle of every interval of the table, with every exponent and sign, in vectors
 * that are ordinary and in ones that have something else among them; to nearest, and cut.
 */
#define FP3_NEAREST 1
#define FP3_SUBNORMAL 1
#define FP3_FINITE 0
#define FP3_FLAGS 1
#include <engine/fast/place.h>

#include <engine/fast/lanes.h>

#include <machine/estimate.h>
#include <stdint.h>
#include <stdio.h>
#include <xmmintrin.h>

enum { INTERVAL = 1 << 13, CUT = 0x6000, FLAGS = 0x3f };

static int table[FP3_TABLE];
static unsigned long wrong;

/* One of the lanes may have another operand. */
static void check(uint32_t a, uint32_t odd) {
    fp3_i in = fp3_all((int)a);
    in[1] = (int)(a + 1);
    in[FP3_LANES - 1] = (int)odd;
    const fp3_i rcp = (fp3_i)fp3_rcp((fp3_v)in, table), rsqrt = (fp3_i)fp3_rsqrt((fp3_v)in, table);
    for (int i = 0; i < FP3_LANES; i++)
        wrong += (uint32_t)rcp[i] != fp3_estimate_rcp((uint32_t)in[i]) ||
                 (uint32_t)rsqrt[i] != fp3_estimate_rsqrt((uint32_t)in[i]);
}

int main(void) {
    fp3_estimate_table(table);
    fp3_table_finish(table);
    for (unsigned mode = 0; mode <= CUT; mode += CUT) {
        _mm_setcsr(0x1f80u | mode);
        for (uint64_t a = 0; a < UINT64_C(1) << 32; a += INTERVAL) {
            check((uint32_t)a, (uint32_t)a);
            check((uint32_t)a + INTERVAL / 2, (uint32_t)a);
            check((uint32_t)a + INTERVAL - 1, a / INTERVAL % 2 ? 0x7fc00000 : 0);
        }
        wrong += (_mm_getcsr() & FLAGS) != 0;
    }
    wrong += !fp3_are_estimates_exact(table);
    table[1024 + 700] ^= 1;
    wrong += FP3_LANES > 4 && fp3_are_estimates_exact(table); /* a processor whose own is another */
    table[FP3_AT_ABOVE] = 0;
    wrong += !fp3_are_estimates_exact(table); /* ... looks it up */
    printf("%lu wrong\n", wrong);
    return wrong != 0;
}
