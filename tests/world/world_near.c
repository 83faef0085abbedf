/* world_near.c - whether a list of those that are near is stale: exactly when somebody has moved by more than half the skin.
 *
 * In one to three dimensions, where squares are ordinary numbers and where FP32 has none of them, and also if the caller has the
 * processor flush what is subnormal.
 */
#include <engine/near.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <xmmintrin.h>

#define FLUSH 0x8040u /* results and operands */

enum { OBJECTS = 5, MOVED = 3 };

static unsigned checked, wrong;

static void expect(const char *what, double scale, uint32_t dimensions, int is, int wanted) {
    checked++;
    if (is == wanted)
        return;
    wrong++;
    printf("FAIL %s, skin %g, %u dimensions: %d\n", what, scale, (unsigned)dimensions, is);
}

/* One of the objects moves by this share of the skin, along a diagonal. */
static int is_stale(double skin, uint32_t dimensions, float share, uint32_t *astray) {
    fp3_near_rule rule = {.dimensions = dimensions, .reach = FP3_NEAR_LEAST, .skin = skin};
    fp3_where_they_are now = {.stride = 1, .objects = OBJECTS, .dimensions = dimensions};
    float place[FP3_NEAR_DIMENSIONS][OBJECTS] = {{0}};
    const float along[] = {0, 1, 0.70710678f, 0.57735027f};
    uint32_t *begin, *other;
    fp3_error error;
    for (uint32_t k = 0; k < dimensions; k++)
        now.position[k] = (const uint32_t *)(const void *)place[k];
    if (fp3_near_make(&rule, &now, &begin, &other, &error))
        exit(1);
    for (uint32_t k = 0; k < dimensions; k++)
        place[k][MOVED] = share * (float)skin * along[dimensions];
    const int is = fp3_near_is_stale(&rule, &now, astray);
    free(begin);
    free(other);
    fp3_near_close(&rule);
    return is;
}

int main(void) {
    const double skins[] = {0x1p-10, 1, 0x1p40, 2e-19, 1e-21, 1e-30};
    const unsigned callers = _mm_getcsr();
    for (uint32_t i = 0; i < 2 * sizeof skins / sizeof *skins; i++)
        for (uint32_t d = 1; d <= FP3_NEAR_DIMENSIONS; d++) {
            const double skin = skins[i / 2];
            uint32_t astray;
            _mm_setcsr(i % 2 ? callers | FLUSH : callers);
            expect("nobody has moved", skin, d, is_stale(skin, d, 0, &astray), 0);
            expect("not far enough", skin, d, is_stale(skin, d, 0.499f, &astray), 0);
            expect("too far", skin, d, is_stale(skin, d, 0.501f, &astray), 1);
            expect("who is not finite", skin, d,
                   is_stale(skin, d, 1e38f * 1e38f, &astray) && astray == MOVED, 1);
        }
    _mm_setcsr(callers);
    printf("%u checked, %u wrong\n", checked, wrong);
    return wrong != 0;
}
