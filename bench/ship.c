/* ship.c - see ship.h. A block keeps its velocities and positions close over all steps; what
 * differs is only how many objects one instruction is for.
 */
#include "ship.h"

#include <string.h>

typedef float wide_16 __attribute__((vector_size(64)));
typedef float wide_8 __attribute__((vector_size(32)));

#define INLINE static inline __attribute__((always_inline))

/* One step of N values of a TYPE each; operations in the order of programs/ship.s. */
#define STEP(TYPE, N)                                                                              \
    TYPE k1[N], k2[N], k3[N], t[N], sum[N];                                                        \
    _Pragma("GCC unroll 8") for (int i = 0; i < (N); i++) k1[i] =                                  \
        h * ((T[i] - C[i] * v[i]) * rm[i]);                                                        \
    _Pragma("GCC unroll 8") for (int i = 0; i < (N); i++) k2[i] =                                  \
        h * ((T[i] - C[i] * (v[i] + 0.5f * k1[i])) * rm[i]);                                       \
    _Pragma("GCC unroll 8") for (int i = 0; i < (N); i++) {                                        \
        k3[i] = h * ((T[i] - C[i] * (v[i] + 0.5f * k2[i])) * rm[i]);                               \
        sum[i] = k1[i] + 2.0f * k2[i];                                                             \
    }                                                                                              \
    _Pragma("GCC unroll 8") for (int i = 0; i < (N); i++) {                                        \
        t[i] = h * ((T[i] - C[i] * (v[i] + k3[i])) * rm[i]);                                       \
        sum[i] = sum[i] + 2.0f * k3[i];                                                            \
    }                                                                                              \
    _Pragma("GCC unroll 8") for (int i = 0; i < (N); i++) {                                        \
        v[i] = v[i] + 0.16666667f * (sum[i] + t[i]);                                               \
        s[i] = s[i] + h * v[i];                                                                    \
    }

#define INTERLEAVED(WIDE, N)                                                                       \
    INLINE void interleaved_##WIDE##_##N(const bench_ships *ships, uint64_t steps) {               \
        const float h = ships->h;                                                                  \
        for (size_t from = 0; from < ships->objects; from += WIDE * (N)) {                         \
            wide_##WIDE T[N], C[N], rm[N], v[N], s[N];                                             \
            memcpy(T, ships->T + from, sizeof T);                                                  \
            memcpy(C, ships->C + from, sizeof C);                                                  \
            memcpy(rm, ships->rm + from, sizeof rm);                                               \
            memcpy(v, ships->v + from, sizeof v);                                                  \
            memcpy(s, ships->s + from, sizeof s);                                                  \
            for (uint64_t n = 0; n < steps; n++) {                                                 \
                STEP(wide_##WIDE, N)                                                               \
            }                                                                                      \
            memcpy(ships->v + from, v, sizeof v);                                                  \
            memcpy(ships->s + from, s, sizeof s);                                                  \
        }                                                                                          \
    }

/* Vectors that are wider than those of the processor would go through memory. */
#ifdef __x86_64__
#define IS_WIDE __builtin_cpu_supports("avx512f")
#else
#define IS_WIDE 0
#endif
#define EITHER(N)                                                                                  \
    INTERLEAVED(8, N)                                                                              \
    INTERLEAVED(16, N)                                                                             \
    INLINE void interleaved_##N(const bench_ships *ships, uint64_t steps) {                        \
        if (IS_WIDE)                                                                               \
            interleaved_16_##N(ships, steps);                                                      \
        else                                                                                       \
            interleaved_8_##N(ships, steps);                                                       \
    }

EITHER(1)
EITHER(2)
EITHER(4)
EITHER(8)

/* As a game has it: one object after the other. */
static void scalar(const bench_ships *ships, uint64_t steps) {
    const float h = ships->h;
    for (size_t from = 0; from < ships->objects; from++) {
        const float T[] = {ships->T[from]}, C[] = {ships->C[from]}, rm[] = {ships->rm[from]};
        float v[] = {ships->v[from]}, s[] = {ships->s[from]};
        for (uint64_t step = 0; step < steps; step++) {
            STEP(float, 1)
        }
        ships->v[from] = v[0];
        ships->s[from] = s[0];
    }
}

/* The same as a loop over a block, which the compiler turns into vectors. */
INLINE void compiled(const bench_ships *ships, uint64_t steps) {
    const float h = ships->h;
    for (size_t from = 0; from < ships->objects; from += BENCH_SHIP_BLOCK)
        for (uint64_t n = 0; n < steps; n++) {
            const float *T = ships->T + from, *C = ships->C + from, *rm = ships->rm + from;
            float *restrict v = ships->v + from, *restrict s = ships->s + from;
            for (int i = 0; i < BENCH_SHIP_BLOCK; i++) {
                const float k1 = h * ((T[i] - C[i] * v[i]) * rm[i]);
                const float k2 = h * ((T[i] - C[i] * (v[i] + 0.5f * k1)) * rm[i]);
                const float k3 = h * ((T[i] - C[i] * (v[i] + 0.5f * k2)) * rm[i]);
                const float k4 = h * ((T[i] - C[i] * (v[i] + k3)) * rm[i]);
                v[i] = v[i] + 0.16666667f * (((k1 + 2.0f * k2) + 2.0f * k3) + k4);
                s[i] = s[i] + h * v[i];
            }
        }
}

/* Each for the best instructions that this processor has. */
#if defined __x86_64__
#define TARGETS(NAME)                                                                              \
    __attribute__((target("avx512f"), optimize("O3"))) static void NAME##_avx512f(                 \
        const bench_ships *ships, uint64_t steps) {                                                \
        NAME(ships, steps);                                                                        \
    }                                                                                              \
    __attribute__((target("avx2"), optimize("O3"))) static void NAME##_avx2(                       \
        const bench_ships *ships, uint64_t steps) {                                                \
        NAME(ships, steps);                                                                        \
    }                                                                                              \
    __attribute__((optimize("O3"))) static void NAME##_baseline(const bench_ships *ships,          \
                                                                uint64_t steps) {                  \
        NAME(ships, steps);                                                                        \
    }                                                                                              \
    static void run_##NAME(const bench_ships *ships, uint64_t steps) {                             \
        if (__builtin_cpu_supports("avx512f"))                                                     \
            NAME##_avx512f(ships, steps);                                                          \
        else if (__builtin_cpu_supports("avx2"))                                                   \
            NAME##_avx2(ships, steps);                                                             \
        else                                                                                       \
            NAME##_baseline(ships, steps);                                                         \
    }
const char *bench_ship_target(void) {
    return __builtin_cpu_supports("avx512f") ? "avx512f"
           : __builtin_cpu_supports("avx2")  ? "avx2"
                                             : "baseline";
}
#else
#define TARGETS(NAME)                                                                              \
    static void run_##NAME(const bench_ships *ships, uint64_t steps) { NAME(ships, steps); }
const char *bench_ship_target(void) { return "baseline"; }
#endif

TARGETS(interleaved_1)
TARGETS(interleaved_2)
TARGETS(interleaved_4)
TARGETS(interleaved_8)
TARGETS(compiled)

const bench_ship_loop *bench_ship_loop_at(unsigned number) {
    static const bench_ship_loop loops[] = {
        {"hand", "1 vector", run_interleaved_1, 16, 1.2},
        {"hand", "2 vectors", run_interleaved_2, 32, 0.6},
        {"hand", "4 vectors", run_interleaved_4, 64, 0.35},
        {"hand", "8 vectors", run_interleaved_8, 128, 0.2},
        {"plain_c", "vectors", run_compiled, BENCH_SHIP_BLOCK, 0.5},
        {"plain_c", "scalar", scalar, 1, 15},
    };
    return number < sizeof loops / sizeof *loops ? &loops[number] : NULL;
}
