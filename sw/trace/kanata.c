/* kanata.c - see kanata.h. Rows are kept until the end, because Konata wants the events of all
 * instructions by cycle, and what becomes of one is known long after its issue. */
#include "kanata.h"

#include "base/file.h"
#include "image/visit.h"
#include "machine/config.h"

#include <fp3/asm.h>
#include <inttypes.h>
#include <isa.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/mman.h>

/* An instruction of one unit for one context. */
typedef struct {
    uint64_t issued, retired; /* cycles; retired is 0 until it is known */
    uint32_t word, pc, object, bits;
    uint16_t unit, context;
    uint8_t flags;
} row;

/* The context's object in lane 0, as far as its instructions show it. */
typedef struct {
    enum { AWAKE, ASLEEP, ABSENT } state;
    uint32_t object;
} visitor;

/* Where a row is when the log is written: stages by their first cycle, and the cycle after all. */
typedef struct {
    const char *name;
    uint64_t from;
} stage;
typedef struct {
    uint64_t id, end;
    stage stages[6];
    unsigned count, begun; /* begun: how many stages have been */
    int executed;
    visitor seen;
} flight;

struct fp3_kanata {
    char *path;
    const fp3_config *config;
    int shared; /* several schedulers take turns at one adder and one multiplier */
    fp3_image *image;
    uint32_t step, last;               /* of the program that runs: with its loads and stores */
    char (*texts)[FP3_WORD_TEXT_SIZE]; /* by pc; empty: not made yet */
    uint32_t *text_words;              /* the words that they say */
    row *rows;                         /* by issue */
    size_t count, room;
    size_t open;       /* interleave = 0: all before are retired */
    uint64_t latency;  /* interleave = 1: from issue to retirement; 0: not seen yet */
    fp3_status status; /* the first thing that went wrong, and why */
    fp3_error error;
};

static uint32_t op_of(uint32_t word) {
    return word >> FP3_FIELD_OP_LO & ((2u << (FP3_FIELD_OP_HI - FP3_FIELD_OP_LO)) - 1);
}

static uint32_t d_of(uint32_t word) {
    return word >> FP3_FIELD_D_LO & ((2u << (FP3_FIELD_D_HI - FP3_FIELD_D_LO)) - 1);
}

/* With contexts in turn, as rtl/tile/lane.v draws it: cycles from an issue to the arithmetic, and of it. */
static uint32_t reading_of(const fp3_kanata *k) { return 3u + (k->shared ? 1u : 0u); }

static uint32_t arithmetic_of(const fp3_kanata *k) {
    return k->config->mul_latency + k->config->add_latency;
}

/* From an issue to its retirement; until one is seen what the drawing says. */
static uint64_t latency_of(const fp3_kanata *k) {
    return k->latency ? k->latency : 1 + reading_of(k) + arithmetic_of(k) + 1;
}

/* ---- open and free ---------------------------------------------------------------------------- */

/* A store's machine runs the image's code between loads and stores. */
static fp3_status find_parts(fp3_kanata *k, fp3_error *error) {
    k->step = k->image->step;
    k->last = k->image->last;
    if (!k->config->interleave)
        return FP3_OK;
    fp3_visit *visit = NULL;
    fp3_status status = fp3_visit_make(k->image, &visit, error);
    if (status)
        return status;
    k->step = visit->step;
    k->last = visit->last;
    fp3_visit_free(&visit);
    return FP3_OK;
}

fp3_status fp3_kanata_open(const char *path, const char *config, const fp3_image *image,
                           fp3_kanata **kanata, fp3_error *error) {
    *kanata = NULL;
    const fp3_config *found = fp3_config_find(config);
    if (!found)
        return fp3_fail(error, FP3_E_ARGUMENT, "no configuration '%s'", config);
    fp3_kanata *k = calloc(1, sizeof *k);
    if (!k)
        return fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    k->config = found;
    k->shared = found->schedulers > 1;
    k->path = strdup(path);
    k->texts = calloc(FP3_IMAGE_CODE_LIMIT, sizeof *k->texts);
    k->text_words = calloc(FP3_IMAGE_CODE_LIMIT, sizeof *k->text_words);
    fp3_status status = FP3_OK;
    if (!k->path || !k->texts || !k->text_words)
        status = fp3_fail(error, FP3_E_SYSTEM, "%s: out of memory", path);
    if (!status)
        status = fp3_image_make(image, &k->image, error);
    if (!status)
        status = find_parts(k, error);
    if (status)
        fp3_kanata_free(&k);
    *kanata = k;
    return status;
}

void fp3_kanata_free(fp3_kanata **kanata) {
    fp3_kanata *k = *kanata;
    *kanata = NULL;
    if (!k)
        return;
    fp3_image_free(&k->image);
    free(k->path);
    free(k->texts);
    free(k->text_words);
    free(k->rows);
    free(k);
}

/* ---- what the engine tells -------------------------------------------------------------------- */

static row *grow(fp3_kanata *k) {
    if (k->count == k->room) {
        const size_t room = k->room ? 2 * k->room : 4096;
        row *rows = realloc(k->rows, room * sizeof *rows);
        if (!rows) {
            k->status = fp3_fail(&k->error, FP3_E_SYSTEM, "%s: out of memory", k->path);
            return NULL;
        }
        k->rows = rows;
        k->room = room;
    }
    return &k->rows[k->count++];
}

void fp3_kanata_issue(void *kanata, const fp3_issue *issue) {
    fp3_kanata *k = kanata;
    if (k->status)
        return;
    if (k->count == FP3_KANATA_LIMIT) {
        k->status = fp3_fail(&k->error, FP3_E_ARGUMENT,
                             "%s: the run issued more than %u instructions: log fewer steps or "
                             "objects",
                             k->path, FP3_KANATA_LIMIT);
        return;
    }
    if (issue->scheduler >= fp3_config_schedulers(k->config) ||
        issue->context >= k->config->contexts || issue->pc >= FP3_IMAGE_CODE_LIMIT ||
        (k->count && issue->cycle < k->rows[k->count - 1].issued)) {
        k->status = fp3_fail(&k->error, FP3_E_MISMATCH,
                             "%s: cycle %" PRIu64 ": unit %" PRIu32 " issued word %" PRIu32
                             " for context %" PRIu32 ": out of range or of order",
                             k->path, issue->cycle, issue->scheduler, issue->pc, issue->context);
        return;
    }
    row *r = grow(k);
    if (r)
        *r = (row){.issued = issue->cycle,
                   .word = issue->word,
                   .pc = issue->pc,
                   .unit = (uint16_t)issue->scheduler,
                   .context = (uint16_t)issue->context};
}

static int explains(const row *r, const fp3_retirement *retirement) {
    return !r->retired && r->issued < retirement->cycle && r->unit == retirement->scheduler &&
           r->context == retirement->context && op_of(r->word) != FP3_OP_ST &&
           d_of(r->word) == retirement->reg;
}

/* The first row that was not issued before the cycle. */
static size_t first_at(const fp3_kanata *k, uint64_t cycle) {
    size_t low = 0, high = k->count;
    while (low < high) {
        const size_t middle = low + (high - low) / 2;
        if (k->rows[middle].issued < cycle)
            low = middle + 1;
        else
            high = middle;
    }
    return low;
}

/* The row that was issued latency cycles before and explains the retirement. */
static row *issued_before(fp3_kanata *k, const fp3_retirement *retirement, uint64_t latency) {
    if (retirement->cycle < latency)
        return NULL;
    const uint64_t cycle = retirement->cycle - latency;
    for (size_t i = first_at(k, cycle); i < k->count && k->rows[i].issued == cycle; i++)
        if (explains(&k->rows[i], retirement))
            return &k->rows[i];
    return NULL;
}

/* The oldest one: the writes of one register come in program order. */
static row *oldest(fp3_kanata *k, const fp3_retirement *retirement) {
    while (k->open < k->count && k->rows[k->open].retired)
        k->open++;
    for (size_t i = k->open; i < k->count; i++)
        if (explains(&k->rows[i], retirement))
            return &k->rows[i];
    return NULL;
}

/* With interleaved contexts not everything retires, so the order does not say which: but all
 * results are equally late, so the cycle does. */
static row *find(fp3_kanata *k, const fp3_retirement *retirement) {
    if (!k->config->interleave)
        return oldest(k, retirement);
    row *r = issued_before(k, retirement, latency_of(k));
    if (!r && !k->latency)
        r = oldest(k, retirement);
    if (r)
        k->latency = retirement->cycle - r->issued;
    return r;
}

void fp3_kanata_retire(void *kanata, const fp3_retirement *retirement) {
    fp3_kanata *k = kanata;
    if (k->status || retirement->lane != 0)
        return;
    row *r = find(k, retirement);
    if (!r) {
        k->status = fp3_fail(&k->error, FP3_E_MISMATCH,
                             "%s: cycle %" PRIu64 ": unit %" PRIu32 " wrote register %" PRIu32
                             " of context %" PRIu32 ": no instruction that was issued does that",
                             k->path, retirement->cycle, retirement->scheduler, retirement->reg,
                             retirement->context);
        return;
    }
    r->retired = retirement->cycle;
    r->object = retirement->object;
    r->bits = retirement->bits;
    r->flags = (uint8_t)retirement->flags;
}

/* ---- what became of each ---------------------------------------------------------------------- */

/* Whether it writes a register whenever it is executed. */
static int always_writes(uint32_t op) { return op != FP3_OP_ST && op != FP3_OP_SLEEP; }

/* Whether the row was executed, for lane 0; *v goes from before it to after it. */
static int execute(const fp3_kanata *k, const row *r, visitor *v) {
    const uint32_t op = op_of(r->word);
    if (!k->config->interleave)
        v->state = AWAKE;
    else if (r->pc == 0 && k->step > 0) /* a visit begins */
        v->state = AWAKE;
    if (r->retired) {
        v->object = r->object;
        if (v->state == ABSENT || (v->state == ASLEEP && r->pc < k->last))
            v->state = AWAKE; /* so it is another visit */
        if (op == FP3_OP_SLEEP)
            v->state = ASLEEP;
        else if (op == FP3_OP_LDS && r->bits)
            v->state = ABSENT;
        return 1;
    }
    if (v->state == AWAKE && always_writes(op))
        v->state = ABSENT; /* the lane has no object for this context */
    return !always_writes(op) && v->state != ABSENT && (v->state == AWAKE || r->pc >= k->last);
}

static void add_stage(flight *f, const char *name, uint64_t from, uint64_t end) {
    if (from < end)
        f->stages[f->count++] = (stage){name, from};
}

/* What works beside the multiplier, and how an operand comes to the adder. */
static const char *beside_of(uint32_t op, int is_shared) {
    switch (op) {
    case FP3_OP_MIN:
    case FP3_OP_MAX:
    case FP3_OP_ABS:
    case FP3_OP_LT:
    case FP3_OP_LE:
    case FP3_OP_SEL:
    case FP3_OP_RCP:
    case FP3_OP_RSQRT:
        return "Va";
    case FP3_OP_MUL:
    case FP3_OP_MADD:
    case FP3_OP_MSUB:
        return "Mu";
    default:
        return is_shared ? "Wa" : "Mu";
    }
}

/* One object: issue, its unit from the next cycle on, and the write. */
static void stages_of_one(const fp3_kanata *k, const row *r, flight *f, uint64_t write) {
    const uint32_t op = op_of(r->word);
    const int adds_at_once = op == FP3_OP_ADD || op == FP3_OP_SUB;
    const uint64_t from = r->issued + 1;
    add_stage(f, "Is", r->issued, write);
    if (!adds_at_once)
        add_stage(f, beside_of(op, 0), from, write);
    if (op != FP3_OP_MUL)
        add_stage(f, "Ad", adds_at_once ? from : from + k->config->mul_latency, write);
    add_stage(f, "Wb", write, f->end);
}

/* Contexts in turn: everything takes as long as multiplier and adder together. A sum and a product
 * go through both, unless these are shared. */
static void stages_of_many(const fp3_kanata *k, const row *r, flight *f, uint64_t write) {
    const uint64_t tail = arithmetic_of(k) + 1; /* from the operands to the write */
    const uint64_t from = write > r->issued + tail ? write - tail : r->issued;
    const uint64_t read = from > r->issued + reading_of(k) ? from - reading_of(k) : r->issued;
    const uint32_t op = op_of(r->word);
    add_stage(f, "Is", r->issued, read);
    add_stage(f, "Rd", read, from);
    if (op == FP3_OP_LD || op == FP3_OP_LDS || op == FP3_OP_ST) {
        add_stage(f, "Me", from, write - 1);
    } else if (op == FP3_OP_SLEEP) {
        add_stage(f, "Cm", from, write - 1);
    } else {
        add_stage(f, beside_of(op, k->shared), from, write - 1);
        add_stage(f, k->shared && op == FP3_OP_MUL ? "Wa" : "Ad", from + k->config->mul_latency,
                  write - 1);
    }
    add_stage(f, "Wb", write - 1, f->end);
}

static flight fly(const fp3_kanata *k, size_t id, visitor *v) {
    const row *r = &k->rows[id];
    const uint64_t write = r->retired ? r->retired : r->issued + latency_of(k);
    flight f = {.id = id, .end = write + 1};
    f.executed = execute(k, r, v);
    f.seen = *v;
    if (k->config->interleave)
        stages_of_many(k, r, &f, write);
    else
        stages_of_one(k, r, &f, write);
    return f;
}

/* ---- the log ---------------------------------------------------------------------------------- */

typedef struct {
    fp3_kanata *kanata;
    FILE *out;
    uint64_t said;     /* the cycle that the log has come to */
    uint64_t retired;  /* rows that were executed, so far */
    visitor *visitors; /* by thread */
    flight *flights;
    size_t count, room;
} writer;

static void say_cycle(writer *w, uint64_t cycle) {
    if (cycle > w->said)
        fprintf(w->out, "C\t%" PRIu64 "\n", cycle - w->said);
    w->said = cycle;
}

static const char *word_text(fp3_kanata *k, const row *r) {
    char *text = k->texts[r->pc];
    if (!*text || k->text_words[r->pc] != r->word) {
        if (fp3_word_text(r->word, k->image, text, NULL))
            snprintf(text, FP3_WORD_TEXT_SIZE, "0x%08" PRIx32, r->word);
        k->text_words[r->pc] = r->word;
    }
    return text;
}

static void say_result(const writer *w, const row *r) {
    static const char *const names[] = {"inexact", "underflow", "overflow", "divide-by-zero",
                                        "invalid"};
    const char *name = fp3_image_name(w->kanata->image, d_of(r->word));
    if (name)
        fprintf(w->out, ": %s", name);
    else
        fprintf(w->out, ": %c%" PRIu32, FP3_BANK_OBJECT_PREFIX, d_of(r->word));
    if (op_of(r->word) == FP3_OP_SLEEP || op_of(r->word) == FP3_OP_LDS) {
        if (r->bits == 0 || r->bits == FP3_REMOVED)
            fprintf(w->out, " = %s", r->bits ? "removed by the host" : "awake");
        else
            fprintf(w->out, " = step %" PRIu32, r->bits);
    } else {
        char number[FP3_NUMBER_TEXT_SIZE];
        fp3_number_text(r->bits, number);
        fprintf(w->out, " = %s", number);
    }
    fprintf(w->out, " (0x%08" PRIx32 ")", r->bits);
    for (int i = 4; i >= 0; i--)
        if (r->flags >> i & 1)
            fprintf(w->out, " %s", names[i]);
}

static void say_outcome(const writer *w, const flight *f) {
    const row *r = &w->kanata->rows[f->id];
    fprintf(w->out, "L\t%" PRIu64 "\t1\t", f->id);
    if (f->seen.state == ABSENT && !r->retired) {
        fprintf(w->out, "not executed: no object\n");
        return;
    }
    fprintf(w->out, "object %" PRIu32, f->seen.object);
    if (r->retired)
        say_result(w, r);
    else if (!f->executed)
        fprintf(w->out, ": not executed, it sleeps");
    else
        fprintf(w->out, op_of(r->word) == FP3_OP_ST ? ": stored" : ": no change");
    fputc('\n', w->out);
}

static void say_birth(const writer *w, const flight *f) {
    const row *r = &w->kanata->rows[f->id];
    fprintf(w->out, "I\t%" PRIu64 "\t%" PRIu64 "\t%" PRIu32 "\n", f->id, f->id,
            r->unit * w->kanata->config->contexts + r->context);
    fprintf(w->out, "L\t%" PRIu64 "\t0\t%" PRIu32 ": %s\n", f->id, r->pc, word_text(w->kanata, r));
    if (fp3_config_schedulers(w->kanata->config) * w->kanata->config->contexts > 1)
        fprintf(w->out, "L\t%" PRIu64 "\t1\tunit %u, context %u\\n\n", f->id, r->unit, r->context);
}

/* All that happens to it in this cycle. Whether it goes on. */
static int advance(writer *w, flight *f, uint64_t cycle) {
    const int ends = cycle == f->end;
    const int begins = f->begun < f->count && cycle == f->stages[f->begun].from;
    if (!ends && !begins)
        return 1;
    say_cycle(w, cycle);
    if (f->begun)
        fprintf(w->out, "E\t%" PRIu64 "\t0\t%s\n", f->id, f->stages[f->begun - 1].name);
    if (begins) {
        fprintf(w->out, "S\t%" PRIu64 "\t0\t%s\n", f->id, f->stages[f->begun++].name);
        if (f->begun == f->count)
            say_outcome(w, f);
        return 1;
    }
    fprintf(w->out, "R\t%" PRIu64 "\t%" PRIu64 "\t%d\n", f->id, w->retired, !f->executed);
    w->retired += (uint64_t)f->executed;
    return 0;
}

static fp3_status begin(writer *w, size_t id) {
    fp3_kanata *k = w->kanata;
    if (w->count == w->room) {
        w->room = w->room ? 2 * w->room : 64;
        flight *flights = realloc(w->flights, w->room * sizeof *flights);
        if (!flights)
            return fp3_fail(&k->error, FP3_E_SYSTEM, "%s: out of memory", k->path);
        w->flights = flights;
    }
    const row *r = &k->rows[id];
    flight *f = &w->flights[w->count++];
    *f = fly(k, id, &w->visitors[r->unit * k->config->contexts + r->context]);
    say_cycle(w, r->issued);
    say_birth(w, f);
    advance(w, f, r->issued);
    return FP3_OK;
}

static fp3_status write_rows(writer *w) {
    fp3_kanata *k = w->kanata;
    w->said = k->count ? k->rows[0].issued : 0;
    fprintf(w->out, "Kanata\t0004\nC=\t%" PRIu64 "\n", w->said);
    size_t next = 0;
    for (uint64_t cycle = w->said; next < k->count || w->count;) {
        size_t left = 0;
        for (size_t i = 0; i < w->count; i++)
            if (advance(w, &w->flights[i], cycle))
                w->flights[left++] = w->flights[i];
        w->count = left;
        for (; next < k->count && k->rows[next].issued == cycle; next++) {
            fp3_status status = begin(w, next);
            if (status)
                return status;
        }
        cycle = w->count || next == k->count ? cycle + 1 : k->rows[next].issued;
    }
    return FP3_OK;
}

static fp3_status write_log(fp3_kanata *k, FILE *out) {
    const size_t threads = (size_t)fp3_config_schedulers(k->config) * k->config->contexts;
    writer w = {.kanata = k, .out = out, .visitors = calloc(threads, sizeof *w.visitors)};
    fp3_status status = FP3_OK;
    if (!w.visitors)
        status = fp3_fail(&k->error, FP3_E_SYSTEM, "%s: out of memory", k->path);
    if (!status)
        status = write_rows(&w);
    free(w.visitors);
    free(w.flights);
    if (!status && (fflush(out) || ferror(out)))
        status =
            fp3_fail(&k->error, FP3_E_SYSTEM, "%s: the log does not fit a temporary file", k->path);
    return status;
}

/* By way of a temporary file, since a long log is large, and path must not hold half of one. */
static fp3_status save(fp3_kanata *k) {
    FILE *out = tmpfile();
    if (!out)
        return fp3_fail(&k->error, FP3_E_SYSTEM, "%s: no temporary file", k->path);
    fp3_status status = write_log(k, out);
    const long size = status ? 0 : ftell(out);
    void *log =
        status ? MAP_FAILED : mmap(NULL, (size_t)size, PROT_READ, MAP_PRIVATE, fileno(out), 0);
    if (!status && log == MAP_FAILED)
        status = fp3_fail(&k->error, FP3_E_SYSTEM, "%s: out of memory", k->path);
    if (!status)
        status = fp3_file_write(k->path, log, (size_t)size, &k->error);
    if (log != MAP_FAILED)
        munmap(log, (size_t)size);
    fclose(out);
    return status;
}

fp3_status fp3_kanata_close(fp3_kanata **kanata, fp3_error *error) {
    fp3_kanata *k = *kanata;
    if (!k)
        return FP3_OK;
    fp3_status status = k->status ? k->status : save(k);
    if (status)
        fp3_fail(error, status, "%s", k->error.text);
    fp3_kanata_free(kanata);
    return status;
}
