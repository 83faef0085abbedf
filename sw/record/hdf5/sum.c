/* SPDX-License-Identifier: Apache-2.0 */
/* sum.c - SHA-256, by Nettle. */
#include "inside.h"

#include <nettle/sha2.h>
#include <stdlib.h>

struct fp3_hdf5_sum {
    struct sha256_ctx of;
};

fp3_hdf5_sum *fp3_hdf5_sum_begin(void) {
    fp3_hdf5_sum *sum = malloc(sizeof *sum);
    if (sum)
        sha256_init(&sum->of);
    return sum;
}

void fp3_hdf5_sum_add(fp3_hdf5_sum *sum, const void *data, size_t size) {
    sha256_update(&sum->of, size, data);
}

void fp3_hdf5_sum_end(fp3_hdf5_sum *sum, uint32_t digest[8]) {
    uint8_t bytes[SHA256_DIGEST_SIZE];
    sha256_digest(&sum->of, sizeof bytes, bytes);
    for (int i = 0; i < 8; i++)
        digest[i] = (uint32_t)bytes[4 * i] << 24 | (uint32_t)bytes[4 * i + 1] << 16 |
                    (uint32_t)bytes[4 * i + 2] << 8 | bytes[4 * i + 3];
    free(sum);
}
