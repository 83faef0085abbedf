/* SPDX-License-Identifier: Apache-2.0 */
/* turns.h - what a turn of a list gives: neighbours' words and fields. Its text stands behind that
 * of lanes.h; FP3_RECORD is defined before it, the floats of a record: see fp3_fast_around. */

/* A vector that stands anywhere. */
FP3_OPERATION fp3_i fp3_row(const int *at) { return (fp3_i) * (const fp3_loose *)at; }

/* A field of each lane's entry, whose fields begin at `at`; and back, of those that take part. */
FP3_OPERATION fp3_i fp3_entries(const int *field, const int *at, int number) {
    fp3_i words;
    for (int k = 0; k < FP3_LANES; k++)
        words[k] = field[at[k] + number];
    return words;
}
FP3_OPERATION void fp3_remember(int *field, const int *at, int number, fp3_i takes, fp3_i words) {
    for (int k = 0; k < FP3_LANES; k++)
        if (takes[k])
            field[at[k] + number] = words[k];
}

FP3_OPERATION fp3_i fp3_takes(int kind, fp3_i lanes) {
    return ((fp3_all(kind >> FP3_TURN_TAKES) >> lanes) & 1) != 0;
}

/* ---- four words of a record at a time ---- */

typedef float fp3_quad __attribute__((vector_size(16), may_alias, aligned(4)));

/* Of each 128 bits g of two vectors. */
#define FP3_FIRST_TWO(g) 4 * (g), FP3_LANES + 4 * (g), 4 * (g) + 1, FP3_LANES + 4 * (g) + 1
#define FP3_LAST_TWO(g) 4 * (g) + 2, FP3_LANES + 4 * (g) + 2, 4 * (g) + 3, FP3_LANES + 4 * (g) + 3
#define FP3_FIRST_HALVES(g) 4 * (g), 4 * (g) + 1, FP3_LANES + 4 * (g), FP3_LANES + 4 * (g) + 1
#define FP3_LAST_HALVES(g)                                                                         \
    4 * (g) + 2, 4 * (g) + 3, FP3_LANES + 4 * (g) + 2, FP3_LANES + 4 * (g) + 3
#if FP3_LANES == 16
#define FP3_OF_QUADS(f) f(0), f(1), f(2), f(3)
#elif FP3_LANES == 8
#define FP3_OF_QUADS(f) f(0), f(1)
#else
#define FP3_OF_QUADS(f) f(0)
#endif

/* Quad g of vector k is word 0 .. 3 of object 4 g + k; it becomes word k of the objects 4 g .. 4 g
 * + 3. And back. */
FP3_OPERATION void fp3_transpose(fp3_v v[4]) {
    const fp3_v a = __builtin_shufflevector(v[0], v[1], FP3_OF_QUADS(FP3_FIRST_TWO));
    const fp3_v b = __builtin_shufflevector(v[0], v[1], FP3_OF_QUADS(FP3_LAST_TWO));
    const fp3_v c = __builtin_shufflevector(v[2], v[3], FP3_OF_QUADS(FP3_FIRST_TWO));
    const fp3_v d = __builtin_shufflevector(v[2], v[3], FP3_OF_QUADS(FP3_LAST_TWO));
    v[0] = __builtin_shufflevector(a, c, FP3_OF_QUADS(FP3_FIRST_HALVES));
    v[1] = __builtin_shufflevector(a, c, FP3_OF_QUADS(FP3_LAST_HALVES));
    v[2] = __builtin_shufflevector(b, d, FP3_OF_QUADS(FP3_FIRST_HALVES));
    v[3] = __builtin_shufflevector(b, d, FP3_OF_QUADS(FP3_LAST_HALVES));
}

#define FP3_QUAD(number) (*(const fp3_quad *)(records + (long)other[number] * FP3_RECORD))
#if FP3_LANES == 16
#define FP3_EIGHT(a, b) __builtin_shufflevector((a), (b), 0, 1, 2, 3, 4, 5, 6, 7)
#define FP3_EVERY_FOURTH(k)                                                                        \
    fp3_whole(FP3_EIGHT(FP3_QUAD(k), FP3_QUAD((k) + 4)),                                           \
              FP3_EIGHT(FP3_QUAD((k) + 8), FP3_QUAD((k) + 12)))
#elif FP3_LANES == 8
#define FP3_EVERY_FOURTH(k) fp3_whole(FP3_QUAD(k), FP3_QUAD((k) + 4))
#else
#define FP3_EVERY_FOURTH(k) FP3_QUAD(k)
#endif

/* Four words of the neighbours of a vector. */
FP3_OPERATION void fp3_gather(const float *records, const int *other, fp3_v v[4]) {
    v[0] = FP3_EVERY_FOURTH(0);
    v[1] = FP3_EVERY_FOURTH(1);
    v[2] = FP3_EVERY_FOURTH(2);
    v[3] = FP3_EVERY_FOURTH(3);
    fp3_transpose(v);
}

/* Four words of the objects of a vector, whose first record this is. */
FP3_OPERATION void fp3_scatter(float *records, fp3_v v[4]) {
    fp3_transpose(v);
    for (int k = 0; k < 4; k++)
        for (int g = 0; g < FP3_LANES / 4; g++)
            *(fp3_quad *)(records + (4 * g + k) * FP3_RECORD) = ((const fp3_quad *)&v[k])[g];
}
