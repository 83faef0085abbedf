/* SPDX-License-Identifier: Apache-2.0 */
/* expected.c - see expected.h. */
#include "expected.h"

#include <inttypes.h>

fp3_status fp3_expected_compare(fp3_expected *expected, const fp3_hdf5_ops *calls, uint64_t step,
                                const fp3_digest *hash, fp3_error *error) {
    size_t i = 0;
    while (i < expected->count && expected->list[i].step != step)
        i++;
    if (i == expected->count)
        return FP3_OK;
    fp3_digest found = expected->list[i].before;
    const fp3_status status = fp3_chain_add(calls, &found, hash, error);
    if (status)
        return status;
    if (!fp3_digest_same(&expected->list[i].chain, &found)) {
        char one[FP3_DIGEST_SIZE], other[FP3_DIGEST_SIZE];
        fp3_digest_text(&expected->list[i].chain, one);
        fp3_digest_text(&found, other);
        return fp3_fail(error, FP3_E_MISMATCH,
                        "%s: after %" PRIu64 " steps its chain is %s, and this run makes it %s",
                        expected->path, step, one, other);
    }
    expected->agreed++;
    return FP3_OK;
}
