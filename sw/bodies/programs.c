/* SPDX-License-Identifier: Apache-2.0 */
/* programs.c - see programs.h. */
#include "programs.h"

#include "text.h"

#include <fp3/engine.h>
#include <fp3/program.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#define X(name, type, speed, way) #name,
static const char *const names[FP3_LAWS] = {FP3_LAWS2(X)};
#undef X
#define X(name, type, speed, way) fp3_law_text_##name,
static const char *const texts[FP3_LAWS] = {FP3_LAWS2(X)};
#undef X
static const char *const body_words[] = {FP3_BODY2_WORDS};
static const char *const shared_words[FP3_SHARED] = {FP3_SHARED_WORDS};
static const char *const contact2_words[] = {FP3_CONTACT2_WORDS, NULL},
                         *const twist2_words[] = {FP3_TWIST2_WORDS, NULL},
                         *const slide2_words[] = {FP3_SLIDE2_WORDS, NULL},
                         *const rod2_words[] = {FP3_ROD2_WORDS, NULL},
                         *const pin2_words[] = {FP3_PIN2_WORDS, NULL};
#define X(name, type, speed, way) {type##_words, sizeof(fp3_##type##_row)},
static const struct {
    const char *const *words;
    size_t size;
} rows[FP3_LAWS] = {FP3_LAWS2(X)};
#undef X

#define OBJECTS 64 /* of an engine: contacts of a run */
#define BLOCKS (OBJECTS / FP3_WIDE)
#define REGISTERS 64

typedef enum { OF_A, OF_B, OF_ROW } whose;

typedef struct {
    uint32_t reg, number;
    whose of;
} word;

typedef struct {
    fp3_program *program;
    fp3_engine *engine;
    word words[REGISTERS];
    uint32_t word_count;
    size_t size;            /* of a block of rows */
    int shared[FP3_SHARED]; /* register of each; -1: the law does not read it */
} law;

struct fp3_laws {
    int own; /* texts of the folder */
    law law[FP3_LAWS];
    fp3_error error;
};

static int find(const char *const *list, size_t count, const char *name) {
    for (size_t i = 0; i < count && list[i]; i++)
        if (strcmp(list[i], name) == 0)
            return (int)i;
    return -1;
}

/* va_x is word v_x of a; whatever is no word of a body is one of the row. */
static int find_word(fp3_law law, const char *name, word *found) {
    char own[FP3_NAME_SIZE];
    if ((name[1] == 'a' || name[1] == 'b') && name[0]) {
        snprintf(own, sizeof own, "%c%s", name[0], name + 2);
        const int number = find(body_words, sizeof body_words / sizeof *body_words, own);
        if (number >= 0) {
            *found = (word){.of = name[1] == 'a' ? OF_A : OF_B, .number = (uint32_t)number};
            return 1;
        }
    }
    const int number = find(rows[law].words, SIZE_MAX, name);
    *found = (word){.of = OF_ROW, .number = (uint32_t)number};
    return number >= 0;
}

static fp3_status find_words(law *l, fp3_law law, fp3_error *error) {
    const fp3_image *image = l->program->image;
    for (int i = 0; i < FP3_SHARED; i++)
        l->shared[i] = -1;
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *symbol = &image->symbols[i];
        const int shared = find(shared_words, FP3_SHARED, symbol->name);
        if (symbol->symbol_class == FP3_SYMBOL_SHARED && shared >= 0) {
            l->shared[shared] = (int)symbol->index;
        } else if (symbol->symbol_class == FP3_SYMBOL_STATE &&
                   find_word(law, symbol->name, &l->words[l->word_count])) {
            l->words[l->word_count++].reg = symbol->index;
        } else if (FP3_CLASS(symbol->symbol_class) & FP3_CLASSES_HOST) {
            return fp3_fail(error, FP3_E_PROGRAM,
                            "law %s: '%s' is no word of it: expected states of the names that "
                            "programs/bodies/%s.ode has, and shared params push, inverse, least, "
                            "warm and pace",
                            names[law], symbol->name, names[law]);
        }
    }
    return FP3_OK;
}

static fp3_status read_law(fp3_laws *laws, fp3_law which, const fp3_bodies_def *bodies,
                           const char *config, fp3_error *error) {
    law *l = &laws->law[which];
    const char *folder = bodies->laws;
    char path[4096];
    fp3_program_def def = fp3_program_default();
    def.integrator = "euler";
    def.compile.config = config;
    def.is_model = 1;
    snprintf(path, sizeof path, "%s/%s.ode", folder ? folder : "programs/bodies", names[which]);
    const int is_own = folder && access(path, F_OK) == 0;
    laws->own += is_own;
    return is_own ? fp3_program_open(path, &def, &l->program, NULL, error)
                  : fp3_program_read(texts[which], strlen(texts[which]), path, &def, &l->program,
                                     NULL, error);
}

static fp3_status open_law(fp3_laws *laws, fp3_law which, const fp3_bodies_def *bodies,
                           fp3_error *error) {
    law *l = &laws->law[which];
    l->size = rows[which].size;
    fp3_engine_def def = fp3_engine_default();
    def.engine = bodies->engine;
    def.config = bodies->config ? bodies->config : "world";
    def.objects = OBJECTS;
    def.threads = 1;
    def.is_interpreted = !bodies->may_compile;
    def.error = &laws->error;
    fp3_status status = read_law(laws, which, bodies, def.config, error);
    if (!status)
        status = find_words(l, which, error);
    if (!status) {
        status = fp3_engine_open(&def, &l->engine);
        if (!status)
            status = fp3_engine_load(l->engine, l->program->image);
        if (status && error)
            *error = laws->error;
    }
    return status;
}

fp3_status fp3_laws_open(const fp3_bodies_def *def, fp3_laws **made, fp3_error *error) {
    fp3_laws *laws = *made = calloc(1, sizeof *laws);
    fp3_status status = laws ? FP3_OK : fp3_no_memory(error);
    for (int i = 0; !status && i < FP3_LAWS; i++)
        status = open_law(laws, (fp3_law)i, def, error);
    if (!status && def->laws && !laws->own)
        status =
            fp3_fail(error, FP3_E_ARGUMENT, "%s: there is no law, such as contact2.ode", def->laws);
    if (status)
        fp3_laws_close(made);
    return status;
}

const char *fp3_laws_why(const fp3_laws *laws) { return laws->error.text; }

void fp3_laws_close(fp3_laws **laws) {
    for (int i = 0; *laws && i < FP3_LAWS; i++) {
        fp3_engine_close(&(*laws)->law[i].engine);
        fp3_program_close(&(*laws)->law[i].program);
    }
    free(*laws);
    *laws = NULL;
}

/* ---- a run ---- */

static uint32_t body_of(const fp3_work2 *work, const word *w, uint32_t block, uint32_t lane) {
    return w->of == OF_A ? work->ends[block].a[lane] : work->ends[block].b[lane];
}

/* Words 0 to 2 of a body are its speed, the others its way. */
static const float *at(const law *l, const fp3_work2 *work, const word *w, uint32_t block,
                       uint32_t lane) {
    if (w->of == OF_ROW)
        return (const float *)(const void *)((const char *)work->row + block * l->size) +
               w->number * FP3_WIDE + lane;
    const uint32_t body = body_of(work, w, block, lane);
    return w->number < 3 ? (const float *)&work->speed[body] + w->number
                         : (const float *)&work->way[body] + w->number - 3;
}

static fp3_status bring(law *l, const fp3_work2 *work, uint32_t first, uint32_t end) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < l->word_count; k++) {
        float column[OBJECTS] = {0};
        for (uint32_t i = 0; i < (end - first) * FP3_WIDE; i++)
            column[i] = *at(l, work, &l->words[k], first + i / FP3_WIDE, i % FP3_WIDE);
        status = fp3_engine_write(l->engine, 0, OBJECTS, l->words[k].reg, column);
    }
    return status;
}

static void keep(const law *l, const fp3_work2 *work, const word *w, uint32_t block, uint32_t lane,
                 float value) {
    if (w->of == OF_ROW) {
        float *row = (float *)(void *)((char *)work->row + block * l->size);
        row[w->number * FP3_WIDE + lane] = value;
        return;
    }
    const uint32_t body = body_of(work, w, block, lane);
    if (body >= work->movable || w->number > 2)
        return;
    float *speed = (float *)&work->speed[body] + w->number;
    if (work->base)
        ((float *)&work->base[body])[w->number] += value - *speed;
    *speed = value;
}

static fp3_status take(law *l, const fp3_work2 *work, uint32_t first, uint32_t end) {
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < l->word_count; k++) {
        float column[OBJECTS];
        status = fp3_engine_read(l->engine, 0, OBJECTS, l->words[k].reg, column);
        for (uint32_t i = 0; !status && i < (end - first) * FP3_WIDE; i++)
            keep(l, work, &l->words[k], first + i / FP3_WIDE, i % FP3_WIDE, column[i]);
    }
    return status;
}

/* What is not finite shows in the bodies. */
static fp3_status run(law *l, const fp3_work2 *work, uint32_t first, uint32_t end) {
    fp3_status status = bring(l, work, first, end);
    if (!status)
        status = fp3_engine_run(l->engine, 1, NULL);
    return status && status != FP3_E_FAILED ? status : take(l, work, first, end);
}

fp3_status fp3_laws_run(fp3_laws *laws, fp3_law which, const fp3_work2 *work, uint32_t first,
                        uint32_t end, const float shared[FP3_SHARED]) {
    law *l = &laws->law[which];
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < FP3_SHARED; i++)
        if (l->shared[i] >= 0)
            status = fp3_engine_write_shared(l->engine, (uint32_t)l->shared[i], 1, &shared[i]);
    for (uint32_t block = first; !status && block < end; block += BLOCKS)
        status = run(l, work, block, end - block < BLOCKS ? end : block + BLOCKS);
    return status;
}
