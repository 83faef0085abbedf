/* SPDX-License-Identifier: Apache-2.0 */
/* crew.c - threads (base/threads.h) do lists of stages, single stages and tasks in turn, and each
 * stage finds what the one before has written. For the thread sanitizer: nothing is atomic here.
 *
 *     crew THREADS ROUNDS
 */
#include "base/laps.h"

#include <stdio.h>
#include <stdlib.h>

#define WORDS 240

typedef struct {
    uint32_t from[WORDS], to[WORDS];
} words;

static void add(void *of, uint32_t first, uint32_t end) {
    words *w = of;
    for (uint32_t i = first; i < end; i++)
        w->to[i] = w->from[i] + w->from[WORDS - 1 - i]; /* of another part */
}

static void back(void *of, uint32_t first, uint32_t end) {
    words *w = of;
    for (uint32_t i = first; i < end; i++)
        w->from[i] = w->to[WORDS - 1 - i] % 1000 + 1;
}

static void count(void *of, uint32_t number) { ((uint32_t *)of)[16 * number]++; }

/* Every third list is another one, so who still reads the old one is waited for. */
static void go(fp3_laps *laps, fp3_threads *crew, words *w, uint32_t round, uint32_t parts) {
    fp3_laps_begin(laps, crew);
    for (uint32_t i = 0; i < 20 + round / 3 % 50; i++) {
        fp3_laps_add(laps, add, w, 0, WORDS, parts);
        fp3_laps_add(laps, back, w, 0, WORDS, i % 4 ? parts : 1);
    }
    if (fp3_laps_do(laps))
        exit(2);
    const fp3_lap share[] = {{add, w, 0, WORDS, parts}, {back, w, 0, WORDS, parts}};
    for (uint32_t i = 0; i < 2; i++)
        if (crew)
            fp3_threads_share(crew, share[i]);
        else
            share[i].part(w, 0, WORDS);
}

int main(int argc, char **argv) {
    const uint32_t most = argc > 2 ? (uint32_t)atoi(argv[1]) : 2;
    const uint32_t rounds = argc > 2 ? (uint32_t)atoi(argv[2]) : 100;
    words *shared = calloc(1, sizeof *shared), *alone = calloc(1, sizeof *alone);
    fp3_laps laps = {0};
    fp3_threads *crew;
    int is_wrong = !shared || !alone || fp3_threads_make(most, &crew, NULL);
    for (uint32_t round = 0; !is_wrong && round < rounds; round++) {
        uint32_t done[16 * 64] = {0};
        fp3_threads_held_up(crew); /* else all that follows would be done alone */
        go(&laps, crew, shared, round, most);
        for (uint32_t i = 0; i < 20 + round / 3 % 50 + 1; i++) {
            add(alone, 0, WORDS);
            back(alone, 0, WORDS);
        }
        for (uint32_t i = 0; i < WORDS; i++)
            is_wrong |= shared->from[i] != alone->from[i] || shared->to[i] != alone->to[i];
        fp3_threads_run(crew, count, done, most);
        is_wrong |= done[0] != 1;
        for (uint32_t i = 1; i < most; i++)
            is_wrong |= done[16 * i] > 1;
    }
    if (shared && alone)
        fp3_threads_free(&crew);
    fp3_laps_free(&laps);
    free(shared);
    free(alone);
    return is_wrong ? printf("another word with %u threads\n", most), 1 : 0;
}
