/* SPDX-License-Identifier: Apache-2.0 */
/* halves.h - what a store of 16-bit words makes of a vector, with the bits of machine/storage.c.
 * Its text stands behind that of lanes.h where a configuration has `storage`. */
#ifndef FP3_FAST_HALVES_H
#define FP3_FAST_HALVES_H

#define FP3_TO_NEAREST -1 /* instead of a random number */

FP3_OPERATION fp3_u fp3_mix(fp3_u x) {
    x = ~x + (x << 15);
    x ^= x >> 12;
    x += x << 2;
    x ^= x >> 4;
    x *= 2057;
    return x ^ x >> 16;
}

/* Random numbers of 16 bits for these objects; seed 0: none. */
FP3_OPERATION fp3_i fp3_draws(unsigned seed, fp3_i objects, unsigned step, unsigned reg) {
    if (!seed)
        return fp3_all(FP3_TO_NEAREST);
    return (
        fp3_i)(fp3_mix(fp3_mix((fp3_u)fp3_all((int)(seed ^ step ^ reg << 26))) + (fp3_u)objects) &
               0xffff);
}

/* A number whose last bits are cut off. `more`: not 0 if it has others behind these. */
FP3_OPERATION fp3_i fp3_cut(fp3_i number, int bits, fp3_i more, fp3_i random) {
    const fp3_i odd = ((number >> bits) & 1) | ((more != 0) & 1);
    const fp3_i nearest = random == FP3_TO_NEAREST;
    return (number +
            ((nearest & (((1 << (bits - 1)) - 1) + odd)) | (~nearest & (random >> (16 - bits))))) >>
           bits;
}

FP3_OPERATION fp3_i fp3_half_of(fp3_i size, fp3_i random) {
    const fp3_i is_small = size < 0x38800000, distance = (is_small & (113 - (size >> 23)));
    const fp3_i is_far = distance > 31, shift = (is_far & 31) | (~is_far & distance);
    const fp3_i all = ((size & 0x7fffff) | 0x800000) << 3, below = ~(fp3_all(-1) << shift);
    const fp3_v least =
        __builtin_convertvector(fp3_cut(all >> shift, 16, all & below, random), fp3_v);
    const fp3_i small = (fp3_i)(least * (fp3_v)fp3_all(0x33800000)); /* 2^-24: exact */
    return (is_small & small) | (~is_small & fp3_cut(size, 13, fp3_all(0), random) << 13);
}

/* What a load gives after the store; *over: -1 where a finite number became infinite. storage: the
 * configuration's key. */
FP3_OPERATION fp3_v fp3_rounded(unsigned storage, fp3_v value, fp3_i random, fp3_i *over) {
    const fp3_i size = fp3_magnitude(value), is_out = size >= FP3_INFINITE;
    const fp3_i end = fp3_all(storage == 1 ? FP3_INFINITE : 0x47800000);
    const fp3_i finite = ~is_out & size; /* 0 for what is no number */
    const fp3_i half =
        storage == 1 ? fp3_cut(finite, 16, fp3_all(0), random) << 16 : fp3_half_of(finite, random);
    *over = ~is_out & (half >= end);
    const fp3_i kept = (*over & FP3_INFINITE) | (~*over & half);
    return fp3_choose(is_out, fp3_one_nan(value), (fp3_v)(kept | ((fp3_i)value & FP3_SIGN)));
}

/* The same in a run: the processor raises overflow and inexact. */
FP3_OPERATION fp3_v fp3_stored(unsigned storage, fp3_v value, fp3_i random) {
    fp3_i over;
    const fp3_v kept = fp3_rounded(storage, value, random, &over);
    if (FP3_FLAGS) {
        fp3_v x = fp3_choose(over, (fp3_v)fp3_all(FP3_INFINITE - 1), (fp3_v)fp3_all(FP3_ONE));
        x += x;
        __asm__ volatile("" : : FP3_ANYWHERE(x));
    }
    return kept;
}

#endif
