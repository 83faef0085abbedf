/* SPDX-License-Identifier: Apache-2.0 */
/* trim.c - see trim.h. */
#include "trim.h"

#include "base/host.h"
#include "candidate.h"
#include "machine/config.h"
#include "machine/operation.h"
#include "machine/visit.h"
#include "placed.h"

#include <inttypes.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* What one change saves after synthesis, by docs/results.md, with which tests/tune compares it. */
static const struct {
    fp3_key key;
    int luts;
} known_savings[] = {
    {FP3_KEY_CHAIN, -49}, {FP3_KEY_SLEEP, -285}, {FP3_KEY_SELECT, -66}, {FP3_KEY_ESTIMATE, -77}};
#define KNOWN(list) (sizeof(list) / sizeof *(list))

/* Keys of instructions that a program can do without, and what instructions then do not need. */
static const struct {
    fp3_key key, needed;
} optional[] = {{FP3_KEY_MULTIPLY_ADD, FP3_KEY_CHAIN},
                {FP3_KEY_SELECT, FP3_KEY_SELECT},
                {FP3_KEY_RECIPROCAL, FP3_KEY_ESTIMATE},
                {FP3_KEY_ROUND, FP3_KEY_ROUND},
                {FP3_KEY_SLEEP, FP3_KEY_SLEEP}};

typedef struct {
    const fp3_config *from;
    uint64_t used; /* bit: a key that an instruction needs */
    uint32_t registers, words, store;
} trimmed;

static uint32_t power_of_two(uint32_t least, uint32_t n) {
    while (least < n)
        least *= 2;
    return least;
}

static void find_keys(const fp3_image *image, trimmed *t) {
    for (uint32_t i = 0; i < image->code_count; i++) {
        const fp3_operation *of = image->decoded[i].of;
        if (of && of->needs != FP3_KEY_NONE)
            t->used |= UINT64_C(1) << of->needs;
    }
    if (t->used & UINT64_C(1) << FP3_KEY_SELECT) /* isa/configs.toml */
        t->used |= UINT64_C(1) << FP3_KEY_CHAIN;
    if (t->used & UINT64_C(1) << FP3_KEY_ESTIMATE)
        t->used |= UINT64_C(1) << FP3_KEY_MIXED;
}

static fp3_status trim(const fp3_compiled *c, const fp3_config *from, uint32_t objects, trimmed *t,
                       fp3_error *error) {
    const fp3_image *image = c->image;
    const uint32_t most = image->registers > image->shared ? image->registers : image->shared;
    *t = (trimmed){.from = from, .registers = power_of_two(2, most)};
    find_keys(image, t);
    t->words = power_of_two(2, image->code_count);
    if (!from->interleave)
        return FP3_OK;
    fp3_visit *visit = NULL;
    const fp3_status status = fp3_visit_make(image, &visit, error);
    if (status)
        return status;
    const uint32_t rows = (objects + from->lanes - 1) / from->lanes;
    t->words = power_of_two(2, visit->code_count);
    const uint32_t records = power_of_two(2, rows > from->contexts ? rows : from->contexts);
    const uint32_t words = power_of_two(16, 8 * from->contexts); /* tools/fp3gen/configs.py */
    t->store = power_of_two(records << visit->log2, words > t->registers ? words : t->registers);
    fp3_visit_free(&visit);
    return FP3_OK;
}

static int is_off(const trimmed *t, fp3_key key) {
    return fp3_config_value(t->from, key) && !(t->used & UINT64_C(1) << key);
}

static void put_luts(FILE *to, const trimmed *t) {
    const fp3_placed *known = fp3_placed_find(t->from->name);
    int less = 0;
    for (size_t i = 0; i < KNOWN(known_savings); i++)
        less += is_off(t, known_savings[i].key) ? known_savings[i].luts : 0;
    if (!known) {
        fprintf(to, "# LUTs: not known; there is no figure for '%s'\n", t->from->name);
        return;
    }
    fprintf(to, "# LUTs: '%s' has %d, placed\n", t->from->name, known->luts);
    if (less)
        fprintf(to,
                "# ... without unused features about %d: an estimate, the sum of the savings of "
                "single changes after synthesis\n",
                known->luts + less);
    if (is_off(t, FP3_KEY_ROUND) || is_off(t, FP3_KEY_MIXED))
        fprintf(to, "# ... the savings of `round` and `mixed` are not known, and not included\n");
}

static void put_value(FILE *to, fp3_key key, uint32_t value) {
    const char *choice = fp3_key_choice(key, value);
    if (choice)
        fprintf(to, "\"%s\"", choice);
    else
        fprintf(to, "%" PRIu32, value);
}

static void put_key(FILE *to, const trimmed *t, fp3_key key, uint32_t value) {
    const uint32_t had = fp3_config_value(t->from, key);
    fprintf(to, "%s = ", fp3_key_name(key));
    put_value(to, key, value);
    if (value != had) {
        fprintf(to, " # ");
        put_value(to, key, had);
        fprintf(to, " of '%s'", t->from->name);
    }
    fprintf(to, "\n");
}

static uint32_t value_of(const trimmed *t, fp3_key key) {
    for (size_t i = 0; i < KNOWN(optional); i++)
        if (optional[i].key == key && is_off(t, optional[i].needed))
            return 0;
    return key == FP3_KEY_REGISTERS       ? t->registers
           : key == FP3_KEY_PROGRAM_WORDS ? t->words
           : key == FP3_KEY_STORE_WORDS   ? t->store
                                          : fp3_config_value(t->from, key);
}

static fp3_status put(const trimmed *t, const char *integrator, char **text, fp3_error *error) {
    size_t size;
    FILE *to = open_memstream(text, &size);
    if (!to)
        return fp3_no_memory(error);
    fprintf(to, "[[config]]\nname = \"trimmed\"\ndoc  = \"What %s needs of %s.\"\n", integrator,
            t->from->name);
    for (int key = 0; key < FP3_KEYS_SET; key++)
        put_key(to, t, (fp3_key)key, value_of(t, (fp3_key)key));
    put_luts(to, t);
    if (!fclose(to))
        return FP3_OK;
    free(*text);
    *text = NULL;
    return fp3_no_memory(error);
}

fp3_status fp3_tuning_hardware(const fp3_tune_def *def, const fp3_tuning *tuning, uint32_t objects,
                               char **text, fp3_error *error) {
    FP3_HOST;
    *text = NULL;
    if (tuning->best >= tuning->row_count)
        return fp3_fail(error, FP3_E_ARGUMENT, "nothing meets the tolerance: there is no program");
    const fp3_tune_row *best = &tuning->rows[tuning->best];
    fp3_candidate c = {.arithmetic = best->arithmetic,
                       .is_adaptive = best->is_adaptive,
                       .is_cut = best->is_cut,
                       .maxstep = def->maxstep};
    trimmed t;
    fp3_status status = fp3_integrator_find(best->integrator, &c.integrator, error);
    if (!status)
        status = fp3_candidate_compile(&c, def->program->model, def->config, error);
    if (!status)
        status = trim(c.timed, fp3_config_find(def->config), objects, &t, error);
    if (!status)
        status = put(&t, best->integrator, text, error);
    fp3_candidate_free(&c);
    return status;
}
