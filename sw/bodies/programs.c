/* SPDX-License-Identifier: Apache-2.0 */
/* programs.c - see programs.h. */
#include "programs.h"

#include "text.h"

#include "base/file.h"

#include <fp3/engine.h>
#include <fp3/program.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

/* A law, its text, its integrator, and the words of its rows. */
typedef struct {
    const char *name, *text, *integrator;
    const char *const *words, *const *point_words; /* NULL: no row has points */
    size_t size;                                   /* of a block of rows */
    int is_of_point;
} kind;

/* The laws of one number of dimensions, and the words of a body: speeds first. */
typedef struct {
    const kind *laws;
    uint32_t count;
    const char *const *body_words;
    uint32_t body_count, speeds, fours;
} family;

static const char *const shared_words[FP3_SHARED] = {FP3_SHARED_WORDS};
static const char *const
    contact2_words[] = {FP3_CONTACT2_WORDS, NULL},
    *const twist2_words[] = {FP3_TWIST2_WORDS, NULL},
    *const slide2_words[] = {FP3_SLIDE2_WORDS, NULL}, *const rod2_words[] = {FP3_ROD2_WORDS, NULL},
    *const pin2_words[] = {FP3_PIN2_WORDS, NULL},
    *const contact3_words[] = {FP3_CONTACT3_WORDS, NULL},
    *const contact3_point_words[] = {FP3_CONTACT3_POINT_WORDS, NULL},
    *const turning3_words[] = {FP3_TURNING3_WORDS, NULL},
    *const pin3_words[] = {FP3_PIN3_WORDS, NULL}, *const spin3_words[] = {FP3_SPIN3_WORDS, NULL},
    *const line3_words[] = {FP3_LINE3_WORDS, NULL},
    *const twist3_words[] = {FP3_TWIST3_WORDS, NULL};
#define POINTS_0 NULL
#define POINTS_1 contact3_point_words
#define X(name, row, speed, way, point, integrator)                                                \
    {#name,          fp3_law_text_##name,     #integrator, row##_words,                            \
     POINTS_##point, sizeof(fp3_##row##_row), point},
static const kind in_plane[] = {FP3_LAWS2(X)}, in_space[] = {FP3_LAWS3(X)};
#undef X
static const char *const words2[] = {FP3_BODY2_WORDS}, *const words3[] = {FP3_BODY3_WORDS};
#define LENGTH(list) (sizeof(list) / sizeof *(list))
static const family families[2] = {
    {in_plane, LENGTH(in_plane), words2, LENGTH(words2), FP3_BODY2_SPEEDS, 1},
    {in_space, LENGTH(in_space), words3, LENGTH(words3), FP3_BODY3_SPEEDS, FP3_FOURS3}};

#define OBJECTS 64 /* of an engine: contacts of a run */
#define BLOCKS (OBJECTS / FP3_WIDE)
#define REGISTERS 64

typedef enum { OF_A, OF_B, OF_ROW, OF_POINT } whose;

typedef struct {
    uint32_t reg, number;
    whose of;
} word;

typedef struct {
    const kind *kind;
    char *own; /* the text of the folder; NULL: that of the library */
    fp3_program *program;
    fp3_engine *engine;
    word words[REGISTERS];
    uint32_t word_count;
    uint64_t runs, lanes, cycles;
    uint32_t row_count, point_count; /* words of a row, and of each of its points behind them */
    int shared[FP3_SHARED];          /* register of each; -1: the law does not read it */
} law;

struct fp3_laws {
    const family *family;
    int own; /* texts of the folder */
    law *law;
    fp3_error error;
};

static int find(const char *const *list, size_t count, const char *name) {
    for (size_t i = 0; i < count && list[i]; i++)
        if (strcmp(list[i], name) == 0)
            return (int)i;
    return -1;
}

/* va_x is word v_x of a; whatever is no word of a body is one of the row, or of its point. */
static int find_word(const family *f, const kind *k, const char *name, word *found) {
    char own[FP3_NAME_SIZE];
    if (name[0] && (name[1] == 'a' || name[1] == 'b')) {
        snprintf(own, sizeof own, "%c%s", name[0], name + 2);
        const int number = find(f->body_words, f->body_count, own);
        if (number >= 0) {
            *found = (word){.of = name[1] == 'a' ? OF_A : OF_B, .number = (uint32_t)number};
            return 1;
        }
    }
    int number = find(k->words, SIZE_MAX, name);
    *found = (word){.of = OF_ROW, .number = (uint32_t)number};
    if (number < 0 && k->is_of_point) {
        number = find(k->point_words, SIZE_MAX, name);
        *found = (word){.of = OF_POINT, .number = (uint32_t)number};
    }
    return number >= 0;
}

static uint32_t count_of(const char *const *words) {
    uint32_t count = 0;
    while (words && words[count])
        count++;
    return count;
}

/* A law with equations has constants of its row as params, and `pace` as its step. */
static fp3_status find_words(const family *f, law *l, fp3_error *error) {
    const fp3_image *image = l->program->image;
    const int has_equations = strcmp(l->kind->integrator, "euler") != 0;
    l->row_count = count_of(l->kind->words);
    l->point_count = count_of(l->kind->point_words);
    for (int i = 0; i < FP3_SHARED; i++)
        l->shared[i] = -1;
    for (uint32_t i = 0; i < image->symbol_count; i++) {
        const fp3_symbol *symbol = &image->symbols[i];
        const int is_step = has_equations && strcmp(symbol->name, "h") == 0;
        const int shared = find(shared_words, FP3_SHARED, is_step ? "pace" : symbol->name);
        if (symbol->symbol_class == FP3_SYMBOL_SHARED && shared >= 0) {
            l->shared[shared] = (int)symbol->index;
        } else if ((symbol->symbol_class == FP3_SYMBOL_STATE ||
                    (has_equations && symbol->symbol_class == FP3_SYMBOL_PARAM)) &&
                   find_word(f, l->kind, symbol->name, &l->words[l->word_count])) {
            l->words[l->word_count++].reg = symbol->index;
        } else if (FP3_CLASS(symbol->symbol_class) & FP3_CLASSES_HOST) {
            return fp3_fail(error, FP3_E_PROGRAM,
                            "law %s: '%s' is no word of it: expected states of the names that "
                            "programs/bodies/%s.ode has, and shared params push, inverse, least, "
                            "warm, pace and far",
                            l->kind->name, symbol->name, l->kind->name);
        }
    }
    return FP3_OK;
}

static fp3_status read_law(fp3_laws *laws, law *l, const fp3_bodies_def *bodies, const char *config,
                           fp3_error *error) {
    const kind *k = l->kind;
    const char *folder = bodies->laws;
    char path[4096];
    size_t size;
    fp3_program_def def = fp3_program_default();
    def.integrator = k->integrator;
    def.compile.config = config;
    def.is_model = 1;
    snprintf(path, sizeof path, "%s/%s.ode", folder ? folder : "programs/bodies", k->name);
    if (folder && access(path, F_OK) == 0) {
        const fp3_status status = fp3_file_read(path, &l->own, &size, error);
        if (status)
            return status;
    }
    laws->own += l->own != NULL;
    const char *text = l->own ? l->own : k->text;
    return fp3_program_read(text, strlen(text), path, &def, &l->program, NULL, error);
}

static fp3_status open_law(fp3_laws *laws, uint32_t which, const fp3_bodies_def *bodies,
                           fp3_error *error) {
    law *l = &laws->law[which];
    l->kind = &laws->family->laws[which];
    fp3_engine_def def = fp3_engine_default();
    def.engine = bodies->engine;
    def.config = bodies->config ? bodies->config : "world";
    def.objects = OBJECTS;
    def.threads = 1;
    def.is_interpreted = !bodies->may_compile;
    def.error = &laws->error;
    fp3_status status = read_law(laws, l, bodies, def.config, error);
    if (!status)
        status = find_words(laws->family, l, error);
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
    fp3_status status = FP3_OK;
    if (laws) {
        laws->family = &families[def->dimensions == 3];
        laws->law = calloc(laws->family->count, sizeof *laws->law);
    }
    if (!laws || !laws->law)
        status = fp3_no_memory(error);
    for (uint32_t i = 0; !status && i < laws->family->count; i++)
        status = open_law(laws, i, def, error);
    if (!status && def->laws && !laws->own)
        status = fp3_fail(error, FP3_E_ARGUMENT, "%s: there is no law, such as %s.ode", def->laws,
                          laws->family->laws[0].name);
    if (status)
        fp3_laws_close(made);
    return status;
}

const char *fp3_laws_why(const fp3_laws *laws) { return laws->error.text; }

const char *fp3_laws_text(const fp3_laws *laws, uint32_t dimensions, uint32_t which) {
    const family *f = &families[dimensions == 3];
    if (which >= f->count)
        return NULL;
    return laws && laws->law[which].own ? laws->law[which].own : f->laws[which].text;
}

int fp3_laws_used(const fp3_laws *laws, uint32_t which, fp3_laws_use *use) {
    if (which >= laws->family->count)
        return 0;
    const law *l = &laws->law[which];
    *use = (fp3_laws_use){l->kind->name, l->program->image, l->runs,
                          l->lanes,      l->cycles,         fp3_engine_bus(l->engine)};
    return 1;
}

void fp3_laws_close(fp3_laws **laws) {
    fp3_laws *l = *laws;
    *laws = NULL;
    for (uint32_t i = 0; l && l->law && i < l->family->count; i++) {
        fp3_engine_close(&l->law[i].engine);
        fp3_program_close(&l->law[i].program);
        free(l->law[i].own);
    }
    if (l)
        free(l->law);
    free(l);
}

/* ---- a run ---- */

/* Which rows make a pass: of point `point` of each, if the law is of one. */
typedef struct {
    const family *family;
    law *law;
    const fp3_work2 *work;
    uint32_t point;
} passing;

static float *row_at(const passing *p, const word *w, uint32_t block, uint32_t lane) {
    const law *l = p->law;
    float *row = (float *)(void *)((char *)p->work->row + block * l->kind->size);
    const uint32_t number =
        w->of == OF_ROW ? w->number : l->row_count + p->point * l->point_count + w->number;
    return row + number * FP3_WIDE + lane;
}

/* A body's speeds, then its way. */
static float *body_at(const passing *p, const word *w, uint32_t body) {
    const family *f = p->family;
    return w->number < f->speeds
               ? (float *)&p->work->speed[f->fours * body] + w->number
               : (float *)&p->work->way[f->fours * body] + (w->number - f->speeds);
}

static uint32_t body_of(const fp3_work2 *work, const word *w, uint32_t block, uint32_t lane) {
    return w->of == OF_A ? work->ends[block].a[lane] : work->ends[block].b[lane];
}

static int is_of_row(const word *w) { return w->of == OF_ROW || w->of == OF_POINT; }

static fp3_status bring(const passing *p, uint32_t first, uint32_t end) {
    const law *l = p->law;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < l->word_count; k++) {
        const word *w = &l->words[k];
        float column[OBJECTS] = {0};
        for (uint32_t i = 0; i < (end - first) * FP3_WIDE; i++) {
            const uint32_t block = first + i / FP3_WIDE, lane = i % FP3_WIDE;
            column[i] = is_of_row(w) ? *row_at(p, w, block, lane)
                                     : *body_at(p, w, body_of(p->work, w, block, lane));
        }
        status = fp3_engine_write(l->engine, 0, OBJECTS, w->reg, column);
    }
    return status;
}

static void keep(const passing *p, const word *w, uint32_t block, uint32_t lane, float value) {
    const fp3_work2 *work = p->work;
    if (is_of_row(w)) {
        *row_at(p, w, block, lane) = value;
        return;
    }
    const uint32_t body = body_of(work, w, block, lane);
    if (body >= work->movable)
        return;
    float *to = body_at(p, w, body);
    if (work->base && w->number < p->family->speeds)
        ((float *)&work->base[p->family->fours * body])[w->number] += value - *to;
    *to = value;
}

static fp3_status take(const passing *p, uint32_t first, uint32_t end) {
    const law *l = p->law;
    fp3_status status = FP3_OK;
    for (uint32_t k = 0; !status && k < l->word_count; k++) {
        float column[OBJECTS];
        status = fp3_engine_read(l->engine, 0, OBJECTS, l->words[k].reg, column);
        for (uint32_t i = 0; !status && i < (end - first) * FP3_WIDE; i++)
            keep(p, &l->words[k], first + i / FP3_WIDE, i % FP3_WIDE, column[i]);
    }
    return status;
}

/* What is not finite shows in the bodies. */
static fp3_status run(const passing *p, uint32_t first, uint32_t end) {
    fp3_status status = bring(p, first, end);
    fp3_stats stats = {.schedulers = 0};
    if (!status)
        status = fp3_engine_run(p->law->engine, 1, &stats);
    p->law->runs++;
    p->law->lanes += (end - first) * FP3_WIDE;
    p->law->cycles += stats.counter[FP3_COUNTER_CYCLES];
    return status && status != FP3_E_FAILED ? status : take(p, first, end);
}

fp3_status fp3_laws_run(fp3_laws *laws, uint32_t which, const fp3_work2 *work, uint32_t first,
                        uint32_t end, uint32_t point, const float shared[FP3_SHARED]) {
    const passing p = {laws->family, &laws->law[which], work, point};
    fp3_status status = FP3_OK;
    for (int i = 0; !status && i < FP3_SHARED; i++)
        if (p.law->shared[i] >= 0)
            status =
                fp3_engine_write_shared(p.law->engine, (uint32_t)p.law->shared[i], 1, &shared[i]);
    for (uint32_t block = first; !status && block < end; block += BLOCKS)
        status = run(&p, block, end - block < BLOCKS ? end : block + BLOCKS);
    return status;
}
