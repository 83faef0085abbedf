/* SPDX-License-Identifier: Apache-2.0 */
/* kanata_log.c - see kanata_log.h. Konata wants the events of all instructions by cycle, so those
 * in flight are kept and advanced together. */
#include "kanata_log.h"

#include "stages.h"

#include <fp3/image.h>
#include <fp3/isa.h>
#include <inttypes.h>
#include <stdlib.h>

/* An instruction in flight. */
typedef struct {
    size_t id; /* its row */
    fp3_stages is;
    unsigned begun; /* stages that have begun */
} flight;

typedef struct {
    const fp3_kanata_rows *of;
    FILE *out;
    uint64_t said;     /* the cycle that the log has come to */
    uint64_t executed; /* rows that have ended so, so far */
    flight *flights;
    size_t count, room;
} writer;

static void say_cycle(writer *w, uint64_t cycle) {
    if (cycle > w->said)
        fprintf(w->out, "C\t%" PRIu64 "\n", cycle - w->said);
    w->said = cycle;
}

/* ---- what an instruction is, and what became of it ---- */

static void say_birth(const writer *w, size_t id) {
    const fp3_traced *t = &w->of->rows[id];
    const fp3_config *config = w->of->config;
    char text[FP3_WORD_TEXT_SIZE];
    if (fp3_word_text(t->word, w->of->image, text, NULL))
        snprintf(text, sizeof text, "0x%08" PRIx32, t->word);
    fprintf(w->out, "I\t%zu\t%zu\t%" PRIu32 "\n", id, id,
            t->scheduler * config->contexts + t->context);
    fprintf(w->out, "L\t%zu\t0\t%" PRIu32 ": %s\n", id, t->pc, text);
    if (fp3_config_schedulers(config) * config->contexts > 1)
        fprintf(w->out, "L\t%zu\t1\tscheduler %" PRIu32 ", context %" PRIu32 "\\n\n", id,
                t->scheduler, t->context);
}

static void say_value(const writer *w, uint32_t op, uint32_t bits) {
    if (op != FP3_OP_SLEEP && op != FP3_OP_LDS) {
        char number[FP3_NUMBER_TEXT_SIZE];
        fp3_number_text(bits, number);
        fprintf(w->out, " = %s", number);
    } else if (bits == 0 || bits == FP3_REMOVED) {
        fprintf(w->out, " = %s", bits ? "removed by the host" : "awake");
    } else {
        fprintf(w->out, " = step %" PRIu32, bits);
    }
    fprintf(w->out, " (0x%08" PRIx32 ")", bits);
}

static void say_result(const writer *w, const fp3_traced *t, const fp3_instruction *in) {
    static const char *const names[] = {"inexact", "underflow", "overflow", "divide-by-zero",
                                        "invalid"};
    const char *name = fp3_image_name(w->of->image, in->d);
    if (name)
        fprintf(w->out, ": %s", name);
    else
        fprintf(w->out, ": %c%" PRIu32, FP3_BANK_OBJECT_PREFIX, in->d);
    say_value(w, in->op, t->bits);
    for (int i = 4; i >= 0; i--)
        if (t->flags >> i & 1)
            fprintf(w->out, " %s", names[i]);
}

static void say_outcome(const writer *w, size_t id) {
    const fp3_traced *t = &w->of->rows[id];
    fp3_instruction in = {0};
    fp3_word_decode(t->word, &in, NULL);
    fprintf(w->out, "L\t%zu\t1\t", id);
    if (t->outcome == FP3_NO_OBJECT)
        fprintf(w->out, "not executed: no object");
    else
        fprintf(w->out, "object %" PRIu32, t->object);
    if (t->has_result)
        say_result(w, t, &in);
    else if (t->outcome == FP3_ASLEEP)
        fprintf(w->out, ": not executed, the object sleeps");
    else if (t->outcome == FP3_EXECUTED)
        fprintf(w->out, in.op == FP3_OP_ST ? ": stored" : ": no change");
    fputc('\n', w->out);
}

/* ---- cycle by cycle ---- */

/* All that happens to it in this cycle. Whether it goes on. */
static int advance(writer *w, flight *f, uint64_t cycle) {
    const int ends = cycle == f->is.end;
    const int begins = f->begun < f->is.count && cycle == f->is.stages[f->begun].from;
    const int is_executed = w->of->rows[f->id].outcome == FP3_EXECUTED;
    if (!ends && !begins)
        return 1;
    say_cycle(w, cycle);
    if (f->begun)
        fprintf(w->out, "E\t%zu\t0\t%s\n", f->id, f->is.stages[f->begun - 1].name);
    if (begins) {
        fprintf(w->out, "S\t%zu\t0\t%s\n", f->id, f->is.stages[f->begun++].name);
        if (f->begun == f->is.count)
            say_outcome(w, f->id);
        return 1;
    }
    fprintf(w->out, "R\t%zu\t%" PRIu64 "\t%d\n", f->id, w->executed, !is_executed);
    w->executed += (uint64_t)is_executed;
    return 0;
}

static fp3_status begin(writer *w, size_t id, fp3_error *error) {
    if (w->count == w->room) {
        w->room = w->room ? 2 * w->room : 64;
        flight *flights = realloc(w->flights, w->room * sizeof *flights);
        if (!flights)
            return fp3_no_memory(error);
        w->flights = flights;
    }
    const fp3_traced *t = &w->of->rows[id];
    flight *f = &w->flights[w->count++];
    *f = (flight){.id = id, .is = fp3_stages_of(w->of->config, t)};
    say_cycle(w, t->issued);
    say_birth(w, id);
    advance(w, f, t->issued);
    return FP3_OK;
}

fp3_status fp3_kanata_log(const fp3_kanata_rows *rows, FILE *out, fp3_error *error) {
    writer w = {.of = rows, .out = out, .said = rows->count ? rows->rows[0].issued : 0};
    fp3_status status = FP3_OK;
    size_t next = 0;
    fprintf(out, "C=\t%" PRIu64 "\n", w.said);
    for (uint64_t cycle = w.said; !status && (next < rows->count || w.count);) {
        size_t left = 0;
        for (size_t i = 0; i < w.count; i++)
            if (advance(&w, &w.flights[i], cycle))
                w.flights[left++] = w.flights[i];
        w.count = left;
        for (; !status && next < rows->count && rows->rows[next].issued == cycle; next++)
            status = begin(&w, next, error);
        cycle = w.count || next == rows->count ? cycle + 1 : rows->rows[next].issued;
    }
    free(w.flights);
    return status;
}
