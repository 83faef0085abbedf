/* operations.c - each arithmetic operation in each arithmetic, over operands that are hard to get
 * right: a hash of results and of flags for each, to be compared with those of other machines.
 *
 *     operations        a line "OPERATION NEAREST SUBNORMAL HASH" for each
 *     operations N      ... with N operands by chance
 */
#include <machine/execute.h>
#include <machine/operation.h>

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>

#define BY_CHANCE 60000

/* Zeros, the ends of subnormal and normal numbers, ties, NaNs, and factors of products around
 * 2^-126: 1 +/- 2^-12 and 2^-13 by 2^-63, the second of which is tiny before rounding alone. */
static const uint32_t hard[] = {
    0x00000000, 0x80000000, 0x00000001, 0x80000001, 0x00400000, 0x007fffff, 0x807fffff, 0x00800000,
    0x80800000, 0x00800001, 0x01000000, 0x1fffffff, 0x20000400, 0x1ffff800, 0x20000800, 0x1ffff000,
    0x20001000, 0x1fffe000, 0x33800000, 0x34000000, 0x3effffff, 0x3f000000, 0x3f7fffff, 0x3f800000,
    0xbf800000, 0x3f800001, 0x40490fdb, 0x4b000001, 0x5f000000, 0x7f000000, 0x7f7fffff, 0xff7fffff,
    0x7f800000, 0xff800000, 0x7fc00000, 0xffc00001, 0x7fa00000, 0x7f800001};
enum { HARD = sizeof hard / sizeof *hard };

static uint64_t hash;

static void note(uint32_t word) {
    for (int i = 0; i < 32; i += 8)
        hash = (hash ^ (word >> i & 255)) * UINT64_C(0x100000001b3); /* FNV-1a */
}

static void try_one(const fp3_config *config, uint32_t op, uint32_t a, uint32_t b, uint32_t c) {
    uint32_t flags;
    note(fp3_execute(config, op, (const uint32_t[]){a, b, c}, &flags));
    note(flags);
}

static void try_all(const fp3_config *config, uint32_t op, long by_chance) {
    uint64_t state = 1;
    for (int i = 0; i < HARD; i++)
        for (int j = 0; j < HARD; j++)
            for (int k = 0; k < HARD; k++)
                try_one(config, op, hard[i], hard[j], hard[k]);
    for (long i = 0; i < by_chance; i++) {
        uint32_t word[3];
        for (int k = 0; k < 3; k++) {
            state = state * UINT64_C(6364136223846793005) + 1442695040888963407;
            word[k] = (uint32_t)(state >> 32);
        }
        if (i % 3 == 0) /* a product near 2^-126 */
            word[1] = (word[1] & 0x80ffffff) | ((128 - (word[0] >> 23 & 255)) & 255) << 23;
        try_one(config, op, word[0], word[1], word[2]);
    }
}

int main(int argc, char **argv) {
    const long by_chance = argc > 1 ? atol(argv[1]) : BY_CHANCE;
    for (uint32_t op = 0; op < fp3_operation_count; op++)
        for (int kind = 0; kind < 4; kind++) {
            const fp3_operation *o = &fp3_operations[op];
            const fp3_config config = {.nearest = kind & 1,
                                       .subnormal = kind >> 1,
                                       .fraction = 23,
                                       .flags = 1,
                                       .name = "any"};
            if (!fp3_operation_is_arithmetic(o))
                continue;
            hash = UINT64_C(0xcbf29ce484222325);
            const uint64_t callers = fp3_fpu_begin(config.nearest);
            try_all(&config, o->code, by_chance);
            fp3_fpu_set(callers);
            printf("%s %d %d %016" PRIx64 "\n", o->name, (int)config.nearest, (int)config.subnormal,
                   hash);
        }
    return 0;
}
