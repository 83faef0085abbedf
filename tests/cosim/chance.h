/* chance.h - random numbers that a seed repeats, and random operands. */
#ifndef FP3_TESTS_CHANCE_H
#define FP3_TESTS_CHANCE_H

#include <stdint.h>

typedef struct {
    uint64_t state;
    uint32_t last; /* the last value made */
} chance;

/* splitmix64 */
static inline uint64_t next64(chance *c) {
    uint64_t z = c->state += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static inline uint32_t below(chance *c, uint32_t bound) {
    return (uint32_t)((next64(c) >> 32) * bound >> 32);
}

/* Values of which neighbours meet: equal magnitudes cancel, products come close to both ends. */
static inline uint32_t value(chance *c) {
    static const uint32_t specials[] = {
        0x00000000, 0x00000001, 0x00000002, 0x007fffff, 0x00800000, 0x00800001, 0x01000000,
        0x33800000, 0x3effffff, 0x3f000000, 0x3f7fffff, 0x3f800000, 0x3f800001, 0x40000000,
        0x4b800000, 0x7effffff, 0x7f7fffff, 0x7f800000, 0x7f800001, 0x7fc00000, 0x7fc12345,
    };
    const uint32_t random = (uint32_t)next64(c);
    const uint32_t exponent = random & 0x807fffffu;
    switch (below(c, 16)) {
    case 0:
        return c->last = random;
    case 1:
        return c->last =
                   specials[below(c, sizeof specials / sizeof *specials)] | (random & 0x80000000u);
    case 2:
        return c->last = exponent | below(c, 3) << 23; /* subnormal, or nearly so */
    case 3:
    case 11:
        return c->last = exponent | (51 + below(c, 25)) << 23; /* two make a subnormal product */
    case 4:
        return c->last = exponent | (188 + below(c, 6))
                                        << 23; /* two make an overflow, or nearly so */
    case 5:
        return c->last = exponent | (251 + below(c, 4)) << 23;
    case 6:
        return c->last = (random & 0xff800000u) | 1u << below(c, 23);
    case 7:
    case 8:
    case 9:
    case 10:
        return c->last ^= (random & 0x80000000u) | below(c, 8) | (below(c, 4) ? 0 : 0x00800000u);
    default:
        return c->last = exponent | (122 + below(c, 10)) << 23;
    }
}

#endif
