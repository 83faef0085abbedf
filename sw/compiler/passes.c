/* SPDX-License-Identifier: Apache-2.0 */
/* passes.c - names of passes. */
#include <fp3/compile.h>

#include <assert.h>
#include <string.h>

static const struct {
    const char *name, *doc;
    int changes_bits;
} passes[] = {
#define X(NAME, name, changes, what) {name, what, changes},
    FP3_PASSES(X)
#undef X
};

const char *fp3_pass_name(fp3_pass pass) { return passes[pass].name; }
const char *fp3_pass_doc(fp3_pass pass) { return passes[pass].doc; }
int fp3_pass_changes_bits(fp3_pass pass) { return passes[pass].changes_bits; }

fp3_pass fp3_pass_find(const char *name) {
    int i = 0;
    while (i < FP3_PASS_COUNT && strcmp(passes[i].name, name) != 0)
        i++;
    return (fp3_pass)i;
}

unsigned fp3_passes_that(int change_bits) {
    unsigned set = 0;
    assert(change_bits == 0 || change_bits == 1);
    for (int i = 0; i < FP3_PASS_COUNT; i++)
        if (passes[i].changes_bits == change_bits)
            set |= FP3_PASS(i);
    return set;
}
