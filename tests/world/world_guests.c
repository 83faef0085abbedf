/* world_guests.c - a scene on several engines, each with a part of the objects and with guests for
 * those of the others that its own objects can read: the words of one engine that has them all.
 *
 *     world_guests SCENE STEPS PARTS ENGINE CUT      CUT: blocks, or strewn: whom a part has
 *
 * Each part runs in a thread of its own, and they exchange words between phases. Prints: parts N,
 * guests N, words N (that were brought in all), differing N.
 */
#include "engine/common/inside.h"

#include <fp3/scene.h>
#include <inttypes.h>
#include <pthread.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define PARTS_MOST 16

typedef struct {
    fp3_engine *engine;
    fp3_error error;
    uint32_t *number; /* of each of its rows, that of the object in the whole */
    uint32_t *guests, guest_count;
    uint32_t rows, own, first;
    uint64_t words;
    fp3_status status;
    pthread_t thread;
} part;

typedef struct {
    const fp3_scene *scene;
    fp3_engine *all;
    const char *engine;
    uint32_t objects, parts, steps;
    uint32_t *whose; /* of each object, its part */
    uint32_t *now;   /* what objects publish: word w of object i at w * objects + i */
    part part[PARTS_MOST];
    pthread_barrier_t barrier;
} world;

static world w;

static void told(fp3_status status, const fp3_error *error) {
    if (!status)
        return;
    printf("FAIL: %s\n", error->text);
    exit(1);
}

static void *room(size_t count, size_t size) {
    void *got = calloc(count + 1, size);
    if (!got)
        exit(1);
    return got;
}

static fp3_members *group_of(const fp3_engine *engine) {
    return &fp3_engine_layout(engine)->groups[0];
}

static int has_all(void) {
    const fp3_lists *lists = &group_of(w.all)->lists;
    int is = 0;
    for (uint32_t i = 0; i < lists->shape.list_count; i++)
        is |= lists->lists[i].is_all;
    return is;
}

/* ---- whom a part has ---- */

/* Whom its objects can read. Of those that are near it may be anybody. */
static void mark_guests(uint32_t number, char *is_guest) {
    const fp3_lists *lists = &group_of(w.all)->lists;
    for (uint32_t k = 0; k < lists->shape.list_count; k++)
        for (uint32_t i = 0; i < w.objects; i++) {
            const fp3_list *list = &lists->lists[k];
            if (w.whose[i] != number || list->is_near)
                continue;
            for (uint32_t turn = 0; turn < fp3_list_length(list, i); turn++)
                is_guest[fp3_list_entry(list, i, turn)] = 1;
        }
    for (uint32_t k = 0; k < lists->shape.list_count; k++)
        if (lists->lists[k].is_near)
            memset(is_guest, 1, w.objects);
}

/* Own objects in front of the guests; where all see all everybody stands at its number. */
static void choose(part *p, uint32_t number) {
    char *is_guest = room(w.objects, 1);
    p->number = room(w.objects, sizeof *p->number);
    p->guests = room(w.objects, sizeof *p->guests);
    mark_guests(number, is_guest);
    for (int guests = 0; guests < 2; guests++)
        for (uint32_t i = 0; i < w.objects; i++) {
            const int is_own = w.whose[i] == number;
            if (has_all() ? guests : guests ? is_own || !is_guest[i] : !is_own)
                continue;
            if (!is_own)
                p->guests[p->guest_count++] = p->rows;
            if (is_own && !p->own++)
                p->first = p->rows;
            p->number[p->rows++] = i;
        }
    free(is_guest);
}

/* ---- an engine ---- */

static void give_lists(part *p) {
    const fp3_members *from = group_of(w.all);
    uint32_t *row = room(w.objects, sizeof *row);
    for (uint32_t i = 0; i < p->rows; i++)
        row[p->number[i]] = i;
    for (uint32_t k = 0; k < from->lists.shape.list_count; k++) {
        const fp3_list *list = &from->lists.lists[k];
        fp3_list *to = &group_of(p->engine)->lists.lists[k];
        if (list->is_near) {
            fp3_list_take_near(to, &list->near, list->kind);
            continue;
        }
        const size_t entries = list->is_all ? 0 : list->begin[w.objects];
        uint32_t *begin = room(p->rows + 1, sizeof *begin), *other = room(entries, sizeof *other);
        float *field = room(entries * list->fields, sizeof *field);
        for (uint32_t i = 0, n = 0; i < p->rows; i++) {
            const int is_own = i - p->first < p->own;
            for (uint32_t turn = 0;
                 !list->is_all && is_own && turn < fp3_list_length(list, p->number[i]);
                 turn++, n++) {
                other[n] = row[fp3_list_entry(list, p->number[i], turn)];
                memcpy(&field[n * list->fields],
                       &list->field[(list->begin[p->number[i]] + turn) * list->fields],
                       list->fields * sizeof *field);
            }
            begin[i + 1] = n;
        }
        const fp3_neighbours given = {
            .begin = list->is_all ? NULL : begin, .other = other, .fields = field};
        told(fp3_list_take(to, &given, &p->error), &p->error);
        free(begin);
        free(other);
        free(field);
    }
    free(row);
}

static fp3_status exchange(void *user, fp3_engine *engine);

static void open_part(part *p) {
    const fp3_config *config = fp3_engine_config(w.all);
    fp3_engine_def def = fp3_scene_engine(w.scene);
    uint32_t *words = room(w.objects, sizeof *words), *mine = room(w.objects, sizeof *mine);
    float *shared = room(config->registers, sizeof *shared);
    def.engine = w.engine;
    def.objects = p->rows;
    def.threads = 1;
    def.error = &p->error;
    told(fp3_engine_open(&def, &p->engine), &p->error);
    told(fp3_engine_load(p->engine, group_of(w.all)->image), &p->error);
    for (uint32_t reg = 0; reg < 1u << group_of(w.all)->log2; reg++) {
        told(fp3_engine_read_words(w.all, 0, w.objects, reg, words), &p->error);
        for (uint32_t i = 0; i < p->rows; i++)
            mine[i] = words[p->number[i]];
        told(fp3_engine_write_words(p->engine, 0, p->rows, reg, mine), &p->error);
    }
    told(fp3_engine_read_shared(w.all, 0, config->registers, shared), &p->error);
    told(fp3_engine_write_shared(p->engine, 0, config->registers, shared), &p->error);
    give_lists(p);
    fp3_engine_use(p->engine, p->first, p->own);
    told(fp3_engine_set_numbers(p->engine, p->number), &p->error);
    fp3_engine_set_exchange(p->engine, &(fp3_exchange){.end = exchange, .user = p});
    free(words);
    free(mine);
    free(shared);
}

/* ---- between phases ---- */

static fp3_status exchange(void *user, fp3_engine *engine) {
    part *p = user;
    const uint64_t published = fp3_layout_published(&fp3_engine_layout(engine)->groups[0]);
    uint32_t *rows = room(p->rows, sizeof *rows), *words = room(p->rows, sizeof *words);
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; i < p->own; i++)
        rows[i] = p->first + i;
    for (uint32_t reg = 0; !status && reg < 64; reg++) {
        if (!(published >> reg & 1))
            continue;
        status = fp3_engine_gather(engine, reg, rows, p->own, words);
        for (uint32_t i = 0; i < p->own; i++)
            w.now[(size_t)reg * w.objects + p->number[rows[i]]] = words[i];
    }
    pthread_barrier_wait(&w.barrier);
    for (uint32_t reg = 0; !status && reg < 64; reg++)
        for (uint32_t i = 0; !status && published >> reg & 1 && i < p->guest_count; i++) {
            status =
                fp3_engine_write_words(engine, p->guests[i], 1, reg,
                                       &w.now[(size_t)reg * w.objects + p->number[p->guests[i]]]);
            p->words++;
        }
    pthread_barrier_wait(&w.barrier);
    free(rows);
    free(words);
    return status;
}

static void *run(void *of) {
    part *p = of;
    p->status = fp3_engine_run(p->engine, w.steps, NULL);
    return NULL;
}

/* ---- all ---- */

static uint32_t differing(void) {
    uint32_t *all = room(w.objects, sizeof *all), *mine = room(w.objects, sizeof *mine), count = 0;
    for (uint32_t reg = 0; reg < 1u << group_of(w.all)->log2; reg++)
        for (uint32_t k = 0; k < w.parts; k++) {
            part *p = &w.part[k];
            told(fp3_engine_read_words(w.all, 0, w.objects, reg, all), &p->error);
            told(fp3_engine_read_words(p->engine, p->first, p->own, reg, mine), &p->error);
            for (uint32_t i = 0; i < p->own; i++)
                count += mine[i] != all[p->number[p->first + i]];
        }
    free(all);
    free(mine);
    return count;
}

int main(int argc, char **argv) {
    fp3_scene *scene = NULL;
    fp3_error error;
    if (argc != 6)
        return 2;
    told(fp3_scene_open(argv[1], NULL, &scene, &error), &error);
    w = (world){.scene = scene,
                .steps = (uint32_t)atoi(argv[2]),
                .parts = (uint32_t)atoi(argv[3]),
                .engine = argv[4]};
    fp3_engine_def def = fp3_scene_engine(scene);
    def.engine = "fast";
    def.error = &error;
    told(fp3_engine_open(&def, &w.all), &error);
    told(fp3_scene_load(scene, w.all, &error), &error);
    w.objects = group_of(w.all)->objects;
    w.whose = room(w.objects, sizeof *w.whose);
    w.now = room((size_t)64 * w.objects, sizeof *w.now);
    const uint32_t each = (w.objects / w.parts + FP3_USE_STEP - 1) / FP3_USE_STEP * FP3_USE_STEP;
    for (uint32_t i = 0; i < w.objects; i++)
        w.whose[i] = strcmp(argv[5], "strewn") ? (i / each < w.parts ? i / each : w.parts - 1)
                                               : i * 7919 / 16 % w.parts;
    pthread_barrier_init(&w.barrier, NULL, w.parts);
    for (uint32_t k = 0; k < w.parts; k++)
        choose(&w.part[k], k);
    for (uint32_t k = 0; k < w.parts; k++)
        open_part(&w.part[k]);
    for (uint32_t k = 0; k < w.parts; k++)
        pthread_create(&w.part[k].thread, NULL, run, &w.part[k]);
    told(fp3_engine_run(w.all, w.steps, NULL), &error);
    uint32_t guests = 0;
    uint64_t words = 0;
    for (uint32_t k = 0; k < w.parts; k++) {
        pthread_join(w.part[k].thread, NULL);
        told(w.part[k].status, &w.part[k].error);
        guests += w.part[k].guest_count;
        words += w.part[k].words;
    }
    const uint32_t count = differing();
    printf("parts %" PRIu32 ", guests %" PRIu32 ", words %" PRIu64 ", differing %" PRIu32 "\n",
           w.parts, guests, words, count);
    fflush(stdout);
    return count != 0;
}
