/* SPDX-License-Identifier: Apache-2.0 */
#include "source.h"

const asm_declaration *fp3_asm_find(const asm_source *a, fp3_token name) {
    for (uint32_t i = 0; i < a->declaration_count; i++)
        if (a->declarations[i].at.kind == FP3_TOKEN_NAME &&
            fp3_token_same(a->declarations[i].at, name))
            return &a->declarations[i];
    return NULL;
}

const fp3_token *fp3_asm_find_label(const asm_source *a, fp3_token name) {
    for (uint32_t i = 0; i < a->label_count; i++)
        if (fp3_token_same(a->label_tokens[i], name))
            return &a->label_tokens[i];
    return NULL;
}
