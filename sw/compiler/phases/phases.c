/* SPDX-License-Identifier: Apache-2.0 */
/* phases.c - sections are converted and scheduled one by one, then put in a row, loads of
 * neighbours in their use. */
#include "phases.h"

#include "compiler/code/check.h"
#include "compiler/integrate/rosenbrock.h"
#include "compiler/schedule/schedule.h"
#include "cut.h"
#include "fold.h"
#include "machine/needs.h"
#include "machine/operation.h"

#include <fp3/isa.h>
#include <inttypes.h>
#include <stdlib.h>
#include <string.h>

#define BIT(reg) (UINT64_C(1) << (reg))

typedef struct {
    fp3_step *step;
    const fp3_options *options;
    conversion *code; /* params and constants of all sections */
    fp3_cut cut;
    fp3_step_code *codes;     /* of each section */
    fp3_schedule **schedules; /* of each section */
    fp3_line *lines;
    uint32_t line_count, line_room;
    uint32_t registers;
    int has_failed;
} maker;

/* ---- what goes with neighbours ---- */

/* Whether others see something that is not there when the step begins, or later than that. */
static int shows_more(const fp3_step *step) {
    for (uint32_t i = 0; i < FP3_PLACES; i++)
        if (step->shown >> i & 1 && step->coupling->phase[i])
            return 1;
    for (uint32_t i = 0; step->shown && i < step->sight.count; i++) {
        const fp3_seen *s = &step->sight.list[i];
        const dag_node *n = &step->values.nodes[s->node];
        if (n->op != NODE_VARIABLE || n->a != fp3_step_word(step, s->state, s->word))
            return 1;
    }
    return 0;
}

int fp3_phases_are_needed(const fp3_step *step) {
    if (step->segment_count)
        return 1;
    for (uint32_t i = 0; i < step->values.count; i++)
        if (fp3_dag_is_fold(step->values.nodes[i].op) || step->values.nodes[i].op == NODE_WORST)
            return 1;
    return step->kept_count > 0 || shows_more(step);
}

fp3_status fp3_phases_check(const fp3_model *model, const fp3_integrator *integrator,
                            const fp3_options *options, fp3_error *error) {
    static const char *const why[] = {
        ("this linearly implicit integrator needs derivatives by states of neighbours, too; 'ros2' "
         "has its order without them"),
        ("the positions one step before the first need sums over neighbours there; 'leapfrog' has "
         "the same order in fewer cycles, 'verlet' makes the same positions")};
    const int wrong = model->relation_count && !fp3_rosenbrock_is_free(integrator) ? 0
                      : integrator->kind == FP3_STOERMER                           ? 1
                                                                                   : -1;
    const int is_seen = options->coupling && (options->coupling->seen || options->coupling->params);
    if ((!model->relation_count && !is_seen) || wrong < 0)
        return FP3_OK;
    if (!model->relation_count)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "objects of model '%s' are seen by others of another group: %s",
                        model->name, why[wrong]);
    return fp3_fail(error, FP3_E_PROGRAM, "model '%s' has '%s' (line %" PRIu32 "): %s", model->name,
                    model->relations[0].name, model->relations[0].line, why[wrong]);
}

/* ---- sections ---- */

/* As a step of its own, which shares the known values. */
static fp3_status as_step(const maker *m, const fp3_section *section, fp3_step *step,
                          fp3_error *error) {
    *step = *m->step;
    step->values = section->values;
    step->variables = calloc(m->step->variable_count + 1u, sizeof *step->variables);
    if (!step->variables)
        return fp3_no_memory(error);
    for (uint32_t i = 0; i < step->variable_count; i++) {
        step->variables[i] = m->step->variables[i];
        step->variables[i].next = section->next[i];
        step->variables[i].first = step->variables[i].last = FP3_NONE;
    }
    return FP3_OK;
}

static fp3_status convert_all(maker *m, fp3_error *error) {
    fp3_status status = fp3_convert_open(m->step, m->code, error);
    for (uint32_t i = 0; !status && i < m->cut.section_count; i++) {
        fp3_step own;
        status = as_step(m, &m->cut.sections[i], &own, error);
        if (!status)
            status = fp3_convert_section(&own, m->options, m->code, &m->codes[i], error);
        free(own.variables);
    }
    for (uint32_t i = 0; !status && i < m->cut.section_count; i++)
        for (uint32_t k = 0; k < m->cut.sections[i].load_count; k++)
            if (m->cut.sections[i].loads[k].op == NODE_OTHER_PARAM)
                fp3_convert_param(m->step, m->options, m->code, m->cut.sections[i].loads[k].index,
                                  m->cut.sections[i].loads[k].word);
    if (!status) {
        fp3_convert_seen(m->step, m->options, m->code);
        fp3_convert_end(m->step, m->code);
    }
    return status;
}

static fp3_status schedule_all(maker *m, fp3_error *error) {
    const fp3_config *config = m->options->config;
    fp3_status status = FP3_OK;
    for (uint32_t i = 0; !status && i < m->cut.section_count; i++) {
        fp3_step_code *code = &m->codes[i];
        code->param_count = m->code->code.param_count;
        code->constant_count = m->code->code.constant_count;
        code->minus_zero = m->code->code.minus_zero;
        status = fp3_check_code(m->step, code, config, error);
        if (!status)
            status = fp3_schedule_make(code, config, &m->schedules[i], error);
        if (!status && m->schedules[i]->registers > m->registers)
            m->registers = m->schedules[i]->registers;
    }
    return status;
}

/* ---- lines ---- */

static void put(maker *m, fp3_line line) {
    if (m->line_count == m->line_room) {
        const uint32_t room = m->line_room ? 2 * m->line_room : 256;
        fp3_line *lines = realloc(m->lines, room * sizeof *lines);
        m->has_failed |= !lines;
        if (!lines)
            return;
        m->lines = lines;
        m->line_room = room;
    }
    m->lines[m->line_count++] = line;
}

static void put_word(maker *m, uint32_t op, uint32_t d, uint32_t a) {
    put(m, (fp3_line){.op = op, .d = d, .operand = {a, 0, 0}, .note = FP3_NONE});
}

/* The register of a neighbour's record that holds it. */
static uint32_t word_of(const maker *m, const fp3_loaded *l) {
    const fp3_step_code *code = &m->code->code;
    if (l->op == NODE_OTHER_STATE)
        return fp3_code_variable(code, fp3_step_word(m->step, l->index, l->word));
    return fp3_code_param(code, fp3_convert_param(m->step, m->options, m->code, l->index, l->word));
}

/* Of a word of a field, in an entry that has these fields. */
static uint32_t number_of(const maker *m, uint64_t fields, uint32_t field, uint32_t word) {
    return (uint32_t)__builtin_popcountll(fields & (BIT(field) - 1)) * m->step->known.words + word;
}

/* The variable to which a section loads a word of a field. */
static uint32_t loaded_to(const fp3_section *s, uint32_t field, uint32_t word, uint32_t unused) {
    for (uint32_t k = 0; k < s->load_count; k++)
        if (s->loads[k].op == NODE_FIELD && s->loads[k].index == field && s->loads[k].word == word)
            return s->loads[k].variable;
    return unused;
}

/* Every loop over links reads the same fields, in the order of the model, so that an entry has one
 * form. */
static void put_fields(maker *m, const fp3_section *s, uint64_t fields, uint32_t unused) {
    for (uint32_t f = 0; f < m->step->model->field_count; f++)
        for (uint32_t word = 0; fields >> f & 1 && word < m->step->known.words; word++)
            put_word(m, FP3_OP_LDL,
                     fp3_code_variable(&m->code->code, loaded_to(s, f, word, unused)), 0);
}

static uint64_t fields_of(const maker *m, uint32_t relation) {
    uint64_t fields = 0;
    for (uint32_t i = 0; i < m->cut.section_count; i++)
        for (uint32_t k = 0; k < m->cut.sections[i].load_count; k++)
            if (m->cut.sections[i].relation == relation &&
                m->cut.sections[i].loads[k].op == NODE_FIELD)
                fields |= BIT(m->cut.sections[i].loads[k].index);
    return fields;
}

static void put_section(maker *m, uint32_t i) {
    const fp3_section *s = &m->cut.sections[i];
    const fp3_schedule *schedule = m->schedules[i];
    const uint32_t each = m->line_count;
    if (s->relation != FP3_NONE) {
        const uint32_t list = fp3_code_variable(&m->code->code, m->cut.list[s->relation]);
        const uint64_t fields = fields_of(m, s->relation);
        put_word(m, FP3_OP_EACH, list, 0);
        for (uint32_t k = 0; k < s->load_count; k++)
            if (s->loads[k].op != NODE_FIELD)
                put_word(m, FP3_OP_LDN, fp3_code_variable(&m->code->code, s->loads[k].variable),
                         word_of(m, &s->loads[k]));
        put_fields(m, s, fields, m->cut.unused);
    }
    for (uint32_t k = 0; k < schedule->step_count; k++)
        put(m, schedule->step[k]);
    for (uint32_t k = 0; k < s->store_count; k++)
        put_word(m, FP3_OP_STL, fp3_code_variable(&m->code->code, s->stores[k].variable),
                 number_of(m, fields_of(m, s->relation), s->stores[k].index, s->stores[k].word));
    if (s->relation == FP3_NONE)
        return;
    if (!m->has_failed)
        m->line_count = each + 1 + fp3_phases_fold(&m->lines[each + 1], m->line_count - each - 1);
    put_word(m, FP3_OP_NEXT, 0, 0);
}

typedef struct {
    uint32_t first, end;    /* its lines, without loads and stores */
    uint64_t reads, writes; /* registers that it reads before it writes them; that it writes, ... */
    uint64_t surely;        /* ... also where an object has no neighbours */
    uint64_t after;         /* registers that a later phase reads before it writes them */
} phase;

static void find_use(const maker *m, phase *p) {
    int is_in_loop = 0;
    for (uint32_t i = p->first; i < p->end; i++) {
        const fp3_line *l = &m->lines[i];
        is_in_loop = l->op == FP3_OP_EACH || (is_in_loop && l->op != FP3_OP_NEXT);
        const fp3_operation *of = fp3_operation_find(l->op);
        for (const char *letter = of->operands; *letter; letter++) {
            const uint32_t r = *letter == 'd' ? l->d : l->operand[*letter - 'a'];
            const int is_read =
                *letter == 'd' ? l->op == FP3_OP_EACH || of->takes_field : *letter != of->number;
            if (is_read && r < FP3_BANK_SHARED_BASE && !(p->writes & BIT(r)))
                p->reads |= BIT(r);
        }
        if (of->writes == FP3_WRITES_ALWAYS) {
            p->writes |= BIT(l->d);
            p->surely |= is_in_loop ? 0 : BIT(l->d);
        }
    }
}

/* The phases of a step follow each other, and the first one of the next step the last. From one
 * repetition to the next nothing goes but states, which are stored anyway. */
static void find_after(phase *phases, uint32_t count) {
    for (int is_new = 1; is_new;) {
        is_new = 0;
        for (uint32_t i = count; i-- > 0;) {
            const phase *next = &phases[(i + 1) % count];
            const uint64_t after = next->reads | (next->after & ~next->surely);
            is_new |= phases[i].after != after;
            phases[i].after = after;
        }
    }
}

/* The word between two phases, or behind the last one. */
static void put_end(maker *m, uint32_t p) {
    const uint32_t next = p + 1 < m->cut.phase_count ? m->cut.times[p + 1] : 0;
    if (m->cut.returns >> p & 1)
        put_word(m, FP3_OP_AGAIN, 0, 0);
    else if (next)
        put_word(m, FP3_OP_REPEAT, next, 0);
    else if (p + 1 < m->cut.phase_count)
        put_word(m, FP3_OP_PHASE, 0, 0);
}

/* Registers of states, which the host reads, and words that neighbours see. */
static uint64_t lasting(const maker *m, uint64_t *published) {
    uint64_t states = 0;
    *published = 0;
    for (uint32_t i = 0; i < m->step->variable_count; i++) {
        const variable *v = &m->step->variables[i];
        const uint32_t reg = fp3_code_variable(&m->code->code, i);
        if (v->role != ROLE_CARRIED && v->role != ROLE_WORST && v->role != ROLE_LIST)
            states |= BIT(reg);
        if ((v->role == ROLE_STATE || v->role == ROLE_LOW) && m->cut.published >> v->state & 1)
            *published |= BIT(reg);
    }
    return states;
}

static void put_phases(maker *m, const fp3_line *lines, const phase *phases) {
    uint64_t published, varying = 0;
    const uint64_t states = lasting(m, &published);
    for (uint32_t p = 0; p < m->cut.phase_count; p++)
        varying |= published & phases[p].writes;
    for (uint32_t p = 0; p < m->cut.phase_count; p++) {
        const uint64_t stored = (phases[p].writes & (states | phases[p].after)) | varying;
        const uint64_t loaded = phases[p].reads | (varying & ~phases[p].writes);
        for (uint32_t r = 0; r < FP3_BANK_OBJECT_COUNT; r++)
            if (loaded & BIT(r))
                put_word(m, FP3_OP_LD, r, 0);
        for (uint32_t i = phases[p].first; i < phases[p].end; i++)
            put(m, lines[i]);
        for (uint32_t r = 0; r < FP3_BANK_OBJECT_COUNT; r++)
            if (stored & BIT(r))
                put_word(m, FP3_OP_ST, r, 0);
        put_end(m, p);
    }
}

static fp3_status make_lines(maker *m, fp3_error *error) {
    phase *phases = calloc(m->cut.phase_count + 1u, sizeof *phases);
    if (!phases)
        return fp3_no_memory(error);
    for (uint32_t p = 0, i = 0; p < m->cut.phase_count; p++) {
        phases[p].first = m->line_count;
        for (; i < m->cut.section_count && m->cut.sections[i].phase == p; i++)
            put_section(m, i);
        phases[p].end = m->line_count;
        if (!m->has_failed)
            find_use(m, &phases[p]);
    }
    find_after(phases, m->cut.phase_count);
    fp3_line *lines = m->lines;
    m->lines = NULL;
    m->line_count = m->line_room = 0;
    if (!m->has_failed)
        put_phases(m, lines, phases);
    free(lines);
    free(phases);
    return m->has_failed ? fp3_no_memory(error) : FP3_OK;
}

/* ---- the interface ---- */

static fp3_status check(const maker *m, fp3_error *error) {
    fp3_needs needs = {.registers = m->registers,
                       .constants = m->code->code.constant_count,
                       .words = m->line_count,
                       .is_visited = 1};
    return fp3_needs_check(&needs, m->options->config, error);
}

static fp3_status finish(maker *m, fp3_schedule **schedule, fp3_error *error) {
    fp3_schedule *made = *schedule = calloc(1, sizeof *made);
    if (!made)
        return fp3_no_memory(error);
    made->step = m->lines;
    made->step_count = m->line_count;
    made->registers = m->registers;
    made->constants = m->code->code.constant_count;
    for (uint32_t i = 0; i < m->cut.section_count; i++)
        made->copies += m->schedules[i]->copies;
    m->lines = NULL;
    return FP3_OK;
}

/* Where words are the same, and objects see each other. */
static const char *name_with_neighbours(const fp3_config *config) {
    const char *found = "world";
    for (uint32_t i = fp3_config_count; i-- > 0;)
        if (fp3_config_computes_as(config, &fp3_configs[i]) &&
            fp3_operation_lacks(&fp3_configs[i], FP3_OP_EACH) == FP3_KEY_NONE)
            found = fp3_configs[i].name;
    return found;
}

static fp3_status check_config(const maker *m, fp3_error *error) {
    const fp3_model *model = m->step->model;
    const fp3_relation *r = model->relations;
    if (fp3_operation_lacks(m->options->config, FP3_OP_EACH) == FP3_KEY_NONE)
        return FP3_OK;
    if (!model->relation_count)
        return fp3_fail(error, FP3_E_PROGRAM,
                        "objects of model '%s' are seen by others of another group, which needs "
                        "`%s`, which configuration '%s' does not have; it is in '%s'",
                        model->name, fp3_key_name(FP3_KEY_NEIGHBOURS), m->options->config->name,
                        name_with_neighbours(m->options->config));
    return fp3_fail_at(error, FP3_E_PROGRAM, NULL, r->line, 1,
                       "'%s' needs `%s`, which configuration '%s' does not have; it is in '%s'",
                       r->name, fp3_key_name(FP3_KEY_NEIGHBOURS), m->options->config->name,
                       name_with_neighbours(m->options->config));
}

static fp3_status make(maker *m, fp3_error *error) {
    fp3_status status = check_config(m, error);
    if (!status)
        status = fp3_cut_make(m->step, &m->cut, error);
    if (status)
        return status;
    m->codes = calloc(m->cut.section_count + 1u, sizeof *m->codes);
    m->schedules = calloc(m->cut.section_count + 1u, sizeof(fp3_schedule *));
    status = m->codes && m->schedules ? convert_all(m, error) : fp3_no_memory(error);
    if (!status)
        status = schedule_all(m, error);
    if (!status)
        status = make_lines(m, error);
    return status ? status : check(m, error);
}

fp3_status fp3_phases_make(fp3_step *step, const fp3_options *options, conversion *code,
                           fp3_schedule **schedule, fp3_error *error) {
    maker m = {.step = step, .options = options, .code = code};
    *schedule = NULL;
    fp3_status status = make(&m, error);
    if (!status)
        status = finish(&m, schedule, error);
    for (uint32_t i = 0; i < m.cut.section_count; i++) {
        if (m.codes) {
            free(m.codes[i].step);
            free(m.codes[i].variables);
        }
        if (m.schedules)
            fp3_schedule_free(&m.schedules[i]);
    }
    free(m.codes);
    free(m.schedules);
    free(m.lines);
    fp3_cut_close(&m.cut);
    return status;
}
