/* SPDX-License-Identifier: Apache-2.0 */
/* spill.c - see spill.h. The pass goes through the part in order. It takes a register from the
 * value whose next use is farthest away, weighed by cost (Belady, IBM Systems Journal 5, 1966). */
#include "spill.h"

#include <assert.h>
#include <fp3/isa.h>
#include <stdlib.h>
#include <string.h>

#define NONE FP3_NONE_INDEX
#define FAR (UINT32_MAX / 4)
#define BIT(reg) (UINT64_C(1) << (reg))

/* A value lives in a cell: the cell of an owner has the number of its register, the other cells
 * follow, one for each node. Time counts twice a position: instruction p reads at 2 p and writes at
 * 2 p + 1. */
typedef struct {
    const fp3_block *block;
    const uint32_t *order;
    const fp3_spill_ends *ends;
    uint32_t owners, cells, registers;
    uint32_t *used; /* cells of node i: used[4 i + k] of operand k, used[4 i + 3] of its result */
    uint32_t *begin,
        *access;          /* times at which cell c is in use: access[begin[c] .. begin[c + 1]) */
    uint32_t *cursor;     /* of each cell: the first of them that is still to come */
    uint32_t *due;        /* of each cell: when it is needed next */
    uint32_t *reg, *word; /* of each cell: the register, the word that has its value, or NONE */
    uint32_t occupant[FP3_BANK_OBJECT_COUNT]; /* the cell in a register, or NONE */
    uint32_t guest[FP3_BANK_OBJECT_COUNT];    /* the cell in the word of one without an owner */
    uint64_t pinned;                          /* registers that this instruction reads */
    uint32_t now;
    uint32_t room;
    int is_stuck, is_full; /* no register is left; no memory */
    fp3_spilled *made;
} spiller;

static uint32_t cell_of(const spiller *s, fp3_ref ref) {
    if (ref.at == FP3_AT_OP) {
        const uint32_t written = s->block->nodes[ref.index].writes;
        return written == NONE ? s->owners + ref.index : fp3_code_variable(s->block->code, written);
    }
    return ref.at == FP3_AT_VARIABLE ? fp3_code_variable(s->block->code, ref.index)
           : ref.at == FP3_AT_PARAM  ? fp3_code_param(s->block->code, ref.index)
                                     : NONE;
}

static void find_cells(const spiller *s) {
    for (uint32_t i = 0; i < s->block->count; i++) {
        for (uint32_t k = 0; k < 3; k++)
            s->used[4 * i + k] = cell_of(s, fp3_node_operand(&s->block->nodes[i], k));
        s->used[4 * i + 3] = cell_of(s, (fp3_ref){FP3_AT_OP, i});
    }
}

static uint32_t operand_cell(const spiller *s, uint32_t node, uint32_t k) {
    return s->used[4 * node + k];
}

static uint32_t result_cell(const spiller *s, uint32_t node) { return s->used[4 * node + 3]; }

/* ---- when a cell is needed ---- */

static void note_access(const spiller *s, uint32_t cell, uint32_t at, int is_filling) {
    if (cell == NONE)
        return;
    if (is_filling)
        s->access[s->cursor[cell]++] = at;
    else
        s->begin[cell + 1]++;
}

static void find_accesses(const spiller *s) {
    for (int is_filling = 0; is_filling < 2; is_filling++) {
        for (uint32_t p = 0; p < s->block->count; p++) {
            for (uint32_t k = 0; k < 3; k++)
                note_access(s, operand_cell(s, s->order[p], k), 2 * p, is_filling);
            note_access(s, result_cell(s, s->order[p]), 2 * p + 1, is_filling);
        }
        for (uint32_t c = 0; !is_filling && c < s->cells; c++)
            s->begin[c + 1] += s->begin[c];
        memcpy(s->cursor, s->begin, s->cells * sizeof *s->cursor);
    }
}

static int is_over(const spiller *s, uint32_t cell) {
    return s->cursor[cell] == s->begin[cell + 1];
}

static int is_owner(const spiller *s, uint32_t cell) { return cell < s->owners; }

/* Whether its register must have it in the end. */
static int is_out(const spiller *s, uint32_t cell) {
    return is_owner(s, cell) && (s->ends->is_open || s->ends->out >> cell & 1);
}

static uint32_t find_due(const spiller *s, uint32_t cell) {
    const uint32_t end = 2 * s->block->count;
    if (!is_over(s, cell))
        return s->access[s->cursor[cell]];
    if (!is_out(s, cell))
        return FAR;
    const int is_again = s->ends->is_open && s->begin[cell] < s->begin[cell + 1];
    return end + (is_again ? s->access[s->begin[cell]] : s->ends->is_open ? end : 0);
}

static int is_dead(const spiller *s, uint32_t cell) {
    if (!is_over(s, cell))
        return s->access[s->cursor[cell]] & 1;
    return !is_out(s, cell) && !(is_owner(s, cell) && s->ends->saved >> cell & 1);
}

static void pass_time(const spiller *s, uint32_t cell, uint32_t time) {
    while (!is_over(s, cell) && s->access[s->cursor[cell]] <= time)
        s->cursor[cell]++;
    s->due[cell] = find_due(s, cell);
}

/* ---- instructions ---- */

static void emit(spiller *s, const fp3_line *line) {
    if (s->made->count == s->room) {
        fp3_line *lines = realloc(s->made->lines, 2 * s->room * sizeof *lines);
        if (!lines) {
            s->is_full = 1;
            return;
        }
        s->made->lines = lines;
        s->room *= 2;
    }
    s->made->lines[s->made->count++] = *line;
    if (line->d >= s->made->registers)
        s->made->registers = line->d + 1;
}

static void emit_spill(spiller *s, uint32_t op, uint32_t reg) {
    s->made->spills++;
    emit(s, &(fp3_line){.op = op, .d = reg, .note = NONE, .from = NONE});
}

static void emit_move(spiller *s, uint32_t from, uint32_t to) {
    const fp3_step_code *code = s->block->code;
    const uint32_t minus_zero = code->minus_zero == NONE ? code->constant_count : code->minus_zero;
    s->made->moves++;
    emit(s, &(fp3_line){.op = FP3_OP_ADD,
                        .d = to,
                        .operand = {from, FP3_BANK_SHARED_BASE + minus_zero, 0},
                        .note = NONE,
                        .from = NONE});
}

/* ---- where cells are ---- */

static void leave_register(spiller *s, uint32_t cell) {
    if (s->reg[cell] != NONE)
        s->occupant[s->reg[cell]] = NONE;
    s->reg[cell] = NONE;
}

static void leave_word(spiller *s, uint32_t cell) {
    if (s->word[cell] != NONE && !is_owner(s, cell))
        s->guest[s->word[cell]] = NONE;
    s->word[cell] = NONE;
}

static void enter(spiller *s, uint32_t cell, uint32_t reg) {
    s->reg[cell] = reg;
    s->occupant[reg] = cell;
}

static void bury(spiller *s, uint32_t cell) {
    if (cell == NONE || !is_dead(s, cell))
        return;
    leave_register(s, cell);
    leave_word(s, cell);
}

/* Its value stays in the word. */
static void evict(spiller *s, uint32_t cell) {
    const uint32_t reg = s->reg[cell];
    if (s->word[cell] == NONE) {
        emit_spill(s, FP3_OP_ST, reg);
        s->word[cell] = reg;
        if (!is_owner(s, cell))
            s->guest[reg] = cell;
    }
    leave_register(s, cell);
}

/* ---- which register ---- */

typedef struct {
    uint32_t cost; /* instructions */
    uint32_t due;  /* when its next reader needs it */
} offer;

static void be_due(offer *o, uint32_t time) {
    if (time < o->due)
        o->due = time;
}

/* What it takes to evict a cell from its register. 0: it has no other place. */
static int ask_occupant(const spiller *s, uint32_t cell, offer *o) {
    const uint32_t reg = s->reg[cell];
    if (!is_owner(s, cell) && s->word[cell] == NONE && (is_owner(s, reg) || s->guest[reg] != NONE))
        return 0;
    const int is_last = s->due[cell] == FAR; /* it has to be stored anyway */
    o->cost += (s->word[cell] == NONE && !is_last) + !is_last;
    be_due(o, s->due[cell]);
    return 1;
}

/* end: until then it is wanted; who wants it longer than it is there has to move. */
static int ask_register(const spiller *s, uint32_t reg, uint32_t end, offer *o) {
    const uint32_t cell = s->occupant[reg];
    *o = (offer){0, FAR};
    if (cell != NONE && !ask_occupant(s, cell, o))
        return 0;
    const uint32_t waiting = is_owner(s, reg) ? reg : s->guest[reg];
    if (waiting != NONE && waiting != cell)
        be_due(o, s->due[waiting]);
    o->cost += o->due <= end;
    return 1;
}

/* In order: less for its lifetime; of values that cost nothing the one with the least to lose. */
static int is_better(const spiller *s, const offer *a, const offer *b) {
    const uint64_t x = (uint64_t)a->cost * (b->due - s->now),
                   y = (uint64_t)b->cost * (a->due - s->now);
    if (x != y)
        return x < y;
    return a->cost ? a->due > b->due : a->due < b->due;
}

/* A register for a cell, emptied. NONE: there is none. */
static uint32_t find_register(spiller *s, uint32_t cell, uint64_t but) {
    uint32_t best = NONE;
    offer least = {0};
    const uint32_t end = s->access[s->begin[cell + 1] - 1];
    for (uint32_t reg = 0; reg < s->registers; reg++) {
        offer o;
        if (but >> reg & 1 || !ask_register(s, reg, end, &o))
            continue;
        if (best == NONE || is_better(s, &o, &least)) {
            best = reg;
            least = o;
        }
    }
    if (best == NONE)
        s->is_stuck = 1;
    else if (s->occupant[best] != NONE)
        evict(s, s->occupant[best]);
    return best;
}

/* Somebody needs this one and no other. */
static void clear_register(spiller *s, uint32_t reg) {
    const uint32_t cell = s->occupant[reg];
    if (cell == NONE)
        return;
    if (s->word[cell] != NONE && !(s->pinned >> reg & 1)) {
        leave_register(s, cell);
        return;
    }
    const uint32_t to = find_register(s, cell, s->pinned | BIT(reg));
    if (to == NONE)
        return;
    emit_move(s, reg, to);
    leave_register(s, cell);
    leave_word(s, cell);
    enter(s, cell, to);
    if (s->pinned >> reg & 1)
        s->pinned = (s->pinned & ~BIT(reg)) | BIT(to);
}

static void load(spiller *s, uint32_t cell) {
    const uint32_t reg = s->word[cell];
    assert(reg != NONE);
    clear_register(s, reg);
    if (s->is_stuck)
        return;
    emit_spill(s, FP3_OP_LD, reg);
    enter(s, cell, reg);
}

/* ---- an instruction ---- */

static void pin(spiller *s, uint32_t cell) {
    if (s->reg[cell] != NONE)
        s->pinned |= BIT(s->reg[cell]);
}

static void fetch(spiller *s, uint32_t node) {
    s->pinned = 0;
    for (uint32_t k = 0; k < 3; k++)
        if (operand_cell(s, node, k) != NONE)
            pin(s, operand_cell(s, node, k));
    for (uint32_t k = 0; k < 3 && !s->is_stuck; k++) {
        const uint32_t cell = operand_cell(s, node, k);
        if (cell == NONE || s->reg[cell] != NONE)
            continue;
        load(s, cell);
        pin(s, cell);
    }
}

static uint32_t code_of(const spiller *s, uint32_t node, uint32_t k) {
    const fp3_ref ref = fp3_node_operand(&s->block->nodes[node], k);
    if (ref.at == FP3_AT_CONSTANT)
        return FP3_BANK_SHARED_BASE + ref.index;
    return ref.at == FP3_AT_NOWHERE ? 0 : s->reg[operand_cell(s, node, k)];
}

/* Until the result is written, its operands stay in their registers. The old value of an owner is
 * dead. */
static void put_result(spiller *s, uint32_t cell) {
    if (is_owner(s, cell)) {
        if (s->occupant[cell] != NONE && s->occupant[cell] != cell)
            clear_register(s, cell);
        if (!s->is_stuck)
            enter(s, cell, cell);
    } else {
        const uint32_t reg = find_register(s, cell, 0);
        if (reg != NONE)
            enter(s, cell, reg);
    }
}

static void execute(spiller *s, uint32_t position) {
    const uint32_t i = s->order[position], result = result_cell(s, i);
    const fp3_node *node = &s->block->nodes[i];
    fp3_line line = {.op = node->op.op, .note = node->op.note, .from = node->from};
    s->now = 2 * position;
    fetch(s, i);
    for (uint32_t k = 0; k < 3 && !s->is_stuck; k++)
        line.operand[k] = code_of(s, i, k);
    for (uint32_t k = 0; k < 3 && !s->is_stuck; k++) {
        const uint32_t cell = operand_cell(s, i, k);
        if (cell == NONE)
            continue;
        pass_time(s, cell, s->now);
        bury(s, cell);
    }
    if (s->is_stuck)
        return;
    put_result(s, result);
    if (s->is_stuck)
        return;
    pass_time(s, result, s->now + 1);
    line.d = s->reg[result];
    emit(s, &line);
    bury(s, result);
}

/* ---- the ends ---- */

static void begin(spiller *s) {
    for (uint32_t c = 0; c < s->cells; c++) {
        s->reg[c] = s->word[c] = NONE;
        s->due[c] = find_due(s, c);
    }
    for (uint32_t reg = 0; reg < FP3_BANK_OBJECT_COUNT; reg++)
        s->occupant[reg] = s->guest[reg] = NONE;
    for (uint32_t c = 0; c < s->owners; c++) {
        if (s->ends->in >> c & 1)
            enter(s, c, c);
        if (s->ends->valid >> c & 1)
            s->word[c] = c;
        bury(s, c);
    }
}

static void end(spiller *s) {
    s->now = 2 * s->block->count;
    s->pinned = 0;
    for (uint32_t c = 0; c < s->owners; c++)
        if (s->reg[c] != NONE)
            s->made->left |= BIT(c);
    for (uint32_t c = 0; !s->ends->is_open && c < s->owners; c++)
        if (s->ends->saved >> c & 1 && s->word[c] == NONE) {
            emit_spill(s, FP3_OP_ST, c);
            s->word[c] = c;
        }
    for (uint32_t c = 0; !s->ends->is_open && c < s->owners; c++)
        if (s->ends->out >> c & 1 && s->reg[c] == NONE)
            load(s, c);
}

static int open_spiller(spiller *s) {
    const size_t cells = s->cells + 2u;
    s->room = 64;
    s->made->lines = calloc(s->room, sizeof *s->made->lines); /* a part may have none */
    s->begin = calloc(cells, sizeof *s->begin);
    s->cursor = calloc(cells, sizeof *s->cursor);
    s->due = calloc(cells, sizeof *s->due);
    s->used = calloc(4 * (size_t)s->block->count + 1, sizeof *s->used);
    s->access = calloc(4 * (size_t)s->block->count + 1, sizeof *s->access);
    s->reg = calloc(cells, sizeof *s->reg);
    s->word = calloc(cells, sizeof *s->word);
    return s->made->lines && s->begin && s->cursor && s->due && s->used && s->access && s->reg &&
           s->word;
}

static void close_spiller(spiller *s) {
    free(s->begin);
    free(s->cursor);
    free(s->due);
    free(s->used);
    free(s->access);
    free(s->reg);
    free(s->word);
}

fp3_status fp3_spill(const fp3_block *block, const uint32_t *order, const fp3_spill_ends *ends,
                     fp3_spilled *made, fp3_error *error) {
    spiller s = {.block = block, .order = order, .ends = ends, .made = made};
    *made = (fp3_spilled){.registers = block->code->variable_count + block->code->param_count};
    s.owners = made->registers;
    s.cells = s.owners + block->count;
    s.registers = block->config->registers;
    if (s.owners > s.registers)
        return FP3_E_LIMIT;
    s.is_full = !open_spiller(&s);
    if (!s.is_full) {
        find_cells(&s);
        find_accesses(&s);
        memcpy(s.cursor, s.begin, s.cells * sizeof *s.cursor);
        begin(&s);
        for (uint32_t p = 0; p < block->count && !s.is_stuck && !s.is_full; p++)
            execute(&s, p);
        if (!s.is_stuck && !s.is_full)
            end(&s);
    }
    close_spiller(&s);
    if (s.is_stuck || s.is_full) {
        free(made->lines);
        *made = (fp3_spilled){0};
    }
    return s.is_full ? fp3_no_memory(error) : s.is_stuck ? FP3_E_LIMIT : FP3_OK;
}
