/* storage_words.c - what a store makes of words: every number of both formats and its neighbours,
 * against arithmetic in double; and the draws of stores that round at random.
 *
 * Prints "FORMAT: N words, N wrong", then what is measured of draws; ends with 1 if a word is
 * wrong.
 */
#include <base/bits.h>
#include <fp3/isa.h>
#include <machine/config.h>
#include <machine/storage.h>
#include <math.h>
#include <stdio.h>

typedef struct {
    const char *name;
    uint32_t storage;
    int bits, least; /* of the significand, the hidden one too; exponent of the last place of the
                        smallest number */
    double most;
} format;

static const format formats[] = {{"bfloat16", 1, 8, -133, 0x1.fep127},
                                 {"binary16", 2, 11, -24, 65504}};

/* The exponent of the last place that a record has of x. */
static int place_of(const format *f, double x) {
    int exponent;
    frexp(x, &exponent);
    return exponent - f->bits > f->least ? exponent - f->bits : f->least;
}

/* x to nearest, ties to even, by double alone. */
static double nearest(const format *f, double x) {
    const int place = place_of(f, x);
    const double rounded = ldexp(rint(ldexp(x, -place)), place);
    return fabs(rounded) > f->most ? copysign(INFINITY, x) : rounded;
}

static int is_wrong(const format *f, uint32_t word) {
    const fp3_config config = {.storage = f->storage, .flags = 1};
    const double x = (double)fp3_value_of(word);
    uint32_t flags;
    const uint32_t got = fp3_stored(&config, word, NULL, &flags);
    if (isnan(x))
        return got != FP3_BITS_NAN || flags;
    const int is_over = isfinite(x) && isinf(nearest(f, x));
    const uint32_t expected = isinf(x) ? word : fp3_bits_of((float)nearest(f, x));
    return got != expected || flags != (is_over ? FP3_FLAG_OVERFLOW | FP3_FLAG_INEXACT : 0);
}

/* Each number that a record has, those around it, and those around the middle between it and the
 * next one. */
static uint64_t look_at_words(const format *f) {
    static const int32_t beside[] = {0, 1, 2, -1, -2};
    uint64_t count = 0, wrong = 0;
    const uint32_t step =
        f->storage == 1 ? 0x8000 : 0x800; /* of binary16: subnormal numbers, too */
    for (uint64_t word = 0; word < UINT64_C(1) << 32; word += step)
        for (size_t i = 0; i < sizeof beside / sizeof *beside; i++, count++)
            wrong += (uint64_t)is_wrong(f, (uint32_t)word + (uint32_t)beside[i]);
    printf("%s: %llu words, %llu wrong\n", f->name, (unsigned long long)count,
           (unsigned long long)wrong);
    return wrong;
}

/* Whether this word is rounded up by the draw. */
static int goes_up(const format *f, uint32_t word, uint32_t seed, uint32_t object, uint32_t step,
                   uint32_t reg) {
    const fp3_config config = {.storage = f->storage, .flags = 1};
    const fp3_draw draw = {fp3_storage_seed(seed), object, step, reg};
    uint32_t flags;
    return fabsf(fp3_value_of(fp3_stored(&config, word, &draw, &flags))) >
           fabsf(fp3_value_of(word));
}

/* Of words whose fraction is cut off at 1/16, 2/16 ...: how far the share that goes up is from it,
 * in standard deviations. */
static double look_at_means(const format *f) {
    const int cut = f->storage == 1 ? 16 : 13;
    double most = 0;
    for (uint32_t part = 1; part < 16; part++) {
        const uint32_t word = 0x40490000u | part << (cut - 4);
        const double share = part / 16.0, draws = 40 * 2000;
        uint32_t up = 0;
        for (uint32_t step = 0; step < 40; step++)
            for (uint32_t object = 0; object < 2000; object++)
                up += (uint32_t)goes_up(f, word, 1, object, step, 3);
        most = fmax(most, fabs(up - draws * share) / sqrt(draws * share * (1 - share)));
    }
    return most;
}

/* Two draws of a pair, a half each: how often they agree, in standard deviations from a half. */
typedef struct {
    const char *name;
    uint32_t seed, object, step, reg; /* by how much the second one differs */
} pair;

static double look_at_pair(const format *f, const pair *p) {
    const uint32_t word = 0x40490000u | 1u << (f->storage == 1 ? 15 : 12);
    const uint32_t steps = 40, objects = 2000;
    uint32_t same = 0;
    for (uint32_t step = 0; step < steps; step++)
        for (uint32_t object = 0; object < objects; object++)
            same += goes_up(f, word, 1, object, step, 3) ==
                    goes_up(f, word, 1 + p->seed, object + p->object, step + p->step, 3 + p->reg);
    const double draws = (double)steps * objects;
    return fabs(same - draws / 2) / (sqrt(draws) / 2);
}

int main(void) {
    static const pair pairs[] = {{"the next object", 0, 1, 0, 0},
                                 {"the object of the next row of 8 lanes", 0, 8, 0, 0},
                                 {"the next step", 0, 0, 1, 0},
                                 {"a visit of 16 steps", 0, 0, 16, 0},
                                 {"the next register", 0, 0, 0, 1},
                                 {"the next seed", 1, 0, 0, 0},
                                 {"the next object in the next step", 0, 1, 1, 0}};
    uint64_t wrong = 0;
    for (size_t i = 0; i < 2; i++) {
        wrong += look_at_words(&formats[i]);
        printf("%s: means are off by %.2f standard deviations at most\n", formats[i].name,
               look_at_means(&formats[i]));
        for (size_t k = 0; k < sizeof pairs / sizeof *pairs; k++)
            printf("%s: %s agrees but for %.2f standard deviations\n", formats[i].name,
                   pairs[k].name, look_at_pair(&formats[i], &pairs[k]));
    }
    return wrong != 0;
}
