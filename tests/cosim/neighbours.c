/* neighbours.c - objects that see each other, on the simulated hardware of configuration `world`
 * against the isa engine.
 *
 *     neighbours [SEED [CONFIGURATION [OBJECTS]]]    at most so many objects
 *
 * Chains, cloths, bodies that attract each other and balls that touch, with integrators of one
 * phase and of several; as many objects as one context, some, all and several batches take; random
 * links, so that lists end at different turns, and of some objects, batches or all are empty. Every
 * word of every record must be that of the isa engine, also those of lists' registers, and the
 * flags; a run of several steps is several runs. The hardware's cycles are those that the program's
 * words, the lists and isa/timing.toml say. Programs by hand: what a model does not make.
 */
#include "both.h"
#include "engine/common/partition.h"

#include <fp3/compile.h>

static const char chain[] = "model chain \"masses on a line\"\n"
                            "param m = 1 [kg]\n"
                            "state x = 0 [m]\n"
                            "state v = 0 [m/s]\n"
                            "links springs(k = 100 [N/m], rest = 0.5 [m])\n"
                            "step 0.01 [s]\n"
                            "F = sum(o in springs: o.k*(o.x - x - o.rest))\n"
                            "x' = v\n"
                            "v' = F/m\n";
static const char cloth[] = "model cloth \"masses and springs\"\n"
                            "param m = 0.001 [kg]\n"
                            "shared g[3] = (0, -9.81, 0) [m/s^2]\n"
                            "state x[3] = (0, 0, 0) [m]\n"
                            "state v[3] = (0, 0, 0) [m/s]\n"
                            "links springs(k = 10 [N/m], rest = 0.1 [m])\n"
                            "step 0.001 [s]\n"
                            "F = sum(o in springs: o.k*(1 - o.rest/norm(o.x - x))*(o.x - x))\n"
                            "x' = v\n"
                            "v' = F/m + g\n";
static const char gravity[] = "model gravity \"bodies that attract each other\"\n"
                              "param m = 1 [kg]\n"
                              "shared G = 1 [m^3/kg/s^2]\n"
                              "shared eps = 0.01 [m^2]\n"
                              "shared L = 1 [m]\n"
                              "state x[2] = (0, 0) [m]\n"
                              "state v[2] = (0, 0) [m/s]\n"
                              "all others\n"
                              "step 0.001 [s]\n"
                              "q = sum(o in others: G*o.m/(norm(o.x - x)^2 + eps)*(o.x - x))\n"
                              "x' = v\n"
                              "v' = q/L\n";
/* Two lists, one of them of those that are near. */
static const char balls[] =
    "model balls \"balls that push each other, some of them linked\"\n"
    "shared R = 0.05 [m]\n"
    "shared stiff = 100 [N/m]\n"
    "param m = 0.01 [kg]\n"
    "state x[3] = (0, 0, 0) [m]\n"
    "state v[3] = (0, 0, 0) [m/s]\n"
    "near touch(x, 2*R)\n"
    "links springs(k = 10 [N/m])\n"
    "step 0.001 [s]\n"
    "F = sum(o in touch: (stiff*(norm(o.x - x) - 2*R)/norm(o.x - x))*(o.x - x))\n"
    "T = sum(o in springs: o.k*(o.x - x))\n"
    "x' = v\n"
    "v' = (F + T)/m\n";

/* The same two lists, and what their entries remember. */
static const char grains[] =
    "model grains \"balls that rub, and links that yield\"\n"
    "shared R = 0.05 [m]\n"
    "shared stiff = 100 [N/m]\n"
    "param m = 0.01 [kg]\n"
    "state x[3] = (0, 0, 0) [m]\n"
    "state v[3] = (0, 0, 0) [m/s]\n"
    "near touch(x, 2*R, s[3] = (0, 0, 0) [m])\n"
    "links springs(k = 10 [N/m], way = 0 [m])\n"
    "step 0.001 [s]\n"
    "F = sum(o in touch: (stiff*(norm(o.x - x) - 2*R)/norm(o.x - x))*(o.x - x) + stiff*o.s)\n"
    "T = sum(o in springs: o.k*(o.x - x)*(1 + o.way/R))\n"
    "x' = v\n"
    "v' = (F + T)/m\n"
    "remember o in touch: o.s = o.s + h*(o.v - v)\n"
    "remember o in springs: o.way = o.way + (norm(o.x - x) < 2*R ? 2*R : 0*R)\n";

typedef struct {
    const char *text, *integrator;
    fp3_model *model;
    fp3_compiled *program;
} subject;

static void open_subject(subject *s) {
    fp3_integrator *integrator;
    fp3_compile_def def = fp3_compile_default();
    char *report = NULL;
    def.config = config;
    if (fp3_model_read(s->text, strlen(s->text), "model", &s->model, &report, &error)) {
        printf("FAIL: %s\n", report ? report : error.text);
        exit(1);
    }
    told(fp3_integrator_find(s->integrator, &integrator, &error));
    told(fp3_compile(s->model, integrator, &def, &s->program, &error));
    fp3_integrator_free(&integrator);
}

static void close_subject(subject *s) {
    fp3_compiled_free(&s->program);
    fp3_model_free(&s->model);
}

static void write_both(const both *b, uint32_t reg, const float *values) {
    told(fp3_engine_write(b->isa, 0, b->objects, reg, values));
    told(fp3_engine_write(b->rtl, 0, b->objects, reg, values));
}

static void give_lists(chance *c, const both *b, const fp3_model *model, uint32_t most) {
    links l;
    for (unsigned i = 0; i < model->relation_count; i++) {
        const char *name = model->relations[i].name;
        const fp3_near near = {
            .position = {"x_x", "x_y", "x_z"}, .dimensions = 3, .reach = 0.1, .skin = 0.03};
        const fp3_neighbours some = {.begin = l.begin, .other = l.other, .fields = l.fields},
                             all = {.begin = NULL};
        const int is_near = model->relations[i].kind == FP3_NEAR;
        const fp3_neighbours *given = model->relations[i].kind == FP3_LINKS ? &some : &all;
        const fp3_image *image = b->image;
        const fp3_list *list =
            fp3_lists_of(&group_of(b->isa)->lists, fp3_image_find(image, name, ~0u)->index);
        link_some(c, b->objects, most, list->fields, &l);
        told(is_near ? fp3_engine_set_near(b->isa, 0, name, &near)
                     : fp3_engine_set_neighbours(b->isa, 0, name, given));
        told(is_near ? fp3_engine_set_near(b->rtl, 0, name, &near)
                     : fp3_engine_set_neighbours(b->rtl, 0, name, given));
    }
}

/* ---- models ---- */

static void fill(chance *c, const both *b, const subject *s) {
    const fp3_compiled *program = s->program;
    double params[64], states[64];
    float inputs[64], column[OBJECTS_MAX];
    for (unsigned i = 0; i < s->model->param_count; i++)
        params[i] = s->model->params[i].value;
    for (unsigned i = 0; i < s->model->state_count; i++)
        states[i] = s->model->states[i].value;
    told(fp3_compiled_inputs(program, params, states, s->model->step, inputs, &error));
    for (unsigned i = 0; i < program->input_count; i++) {
        told(fp3_engine_set(b->isa, program->inputs[i].name, inputs[i]));
        told(fp3_engine_set(b->rtl, program->inputs[i].name, inputs[i]));
    }
    for (unsigned i = 0; i < s->model->state_count; i++) {
        const char *name = s->model->states[i].name;
        for (uint32_t k = 0; k < b->objects; k++)
            column[k] = name[0] == 'x' ? 0.25f * (float)(next64(c) >> 40) / 16777216.0f : 0.0f;
        write_both(b, fp3_image_find(b->image, name, ~0u)->index, column);
    }
    for (uint32_t i = 0; i < group_of(b->isa)->lists.shape.list_count; i++) {
        for (uint32_t k = 0; k < b->objects; k++)
            column[k] = (float)(k + i); /* a word like any other */
        write_both(b, group_of(b->isa)->lists.lists[i].reg, column);
    }
}

static void check_subject(chance *c, const char *text, const char *integrator) {
    static const uint32_t counts[] = {1, 2, 7, 23, 24, 25, 53};
    subject s = {text, integrator, NULL, NULL};
    open_subject(&s);
    for (size_t i = 0; i < sizeof counts / sizeof *counts && counts[i] <= most; i++) {
        both b = open_both(s.program->image, counts[i]);
        fill(c, &b, &s);
        give_lists(c, &b, s.model, i % 3 ? LINKS_MAX : 1);
        run_both(&b, 1, s.model->name, integrator);
        run_both(&b, 2, s.model->name, integrator);
        give_lists(c, &b, s.model, 2);
        run_both(&b, 1, s.model->name, integrator);
        give_lists(c, &b, s.model, 0);
        run_both(&b, 1, s.model->name, integrator);
        close_both(&b);
    }
    close_subject(&s);
}

/* ---- programs by hand ---- */

static const struct {
    const char *text, *list;
    uint32_t fields;
} by_hand[] = {
    /* A loop without a word, one with a field alone, and a word that nobody stores. */
    {"s.state a\n.state b\n.param p\n.temp l\nstep:\nld l\nld a\nld b\neach l\nnext\neach l\nldn "
     "b, p\nadd a, a, b\nnext\nst a\nst b\n",
     "l", 0},
    /* Both phases store what neighbours read; one of them is a copy. */
    {"s.state a\n.state b\n.temp l\n.temp t\nstep:\nld l\nld a\neach l\nldl t\nldn b, a\nmadd a, "
     "b, t, a\nnext\nst a\nphase\nld a\nld b\nld l\neach l\nldl t\n"
     "ldn t, a\nadd b, b, t\nnext\nst a\nst b\n",
     "l", 1},
    /* The program ends with a loop, so nothing but the phase before it stores. */
    /* Fields are written: two, one of them not read, in a loop with another sum, of objects that
     * may have no entry; the loop of another phase goes through the list, too. */
    {"s.state a\n.state b\n.temp l\n.temp t\nstep:\nld l\nld a\nld b\neach l\nldl t\naddn "
     "b, b, a\nadd t, t, a\nstl t, 0\nstl b, 1\nnext\nst a\nst b\nphase\nld l\nld a\nld b\neach "
     "l\nmull t, a, 1\nadd b, b, t\nnext\nst a\nst b\n",
     "l", 2},
    /* Phases that are made several times: two of them, then one; the first with a field that grows.
     */
    {"s.state a\n.state b\n.temp l\n.temp t\nstep:\nld l\nld a\nadd a, a, a\nst a\nrepeat 3\nld "
     "l\nld "
     "a\nld b\neach l\nldl t\naddn b, b, a\nadd t, t, b\nstl t, 0\nnext\nst a\nst b\nphase\nld "
     "l\nld "
     "a\neach l\nmull t, a, 0\nadd a, a, t\nnext\nst a\nagain\nld a\nld b\nadd a, a, b\nst "
     "a\nrepeat "
     "5\nld l\nld a\nld b\neach l\naddn b, b, a\naddl a, a, 0\nnext\nst a\nst b\nagain\n",
     "l", 1},
    /* Once, and a step without anything behind. */
    {"s.state a\n.state b\n.temp l\n.temp t\nstep:\nld a\nld l\nadd a, a, a\nst a\nrepeat 1\nld "
     "l\nld a\nld "
     "b\neach l\naddn b, b, a\nnext\nst a\nst b\nagain\nld a\nld b\nadd a, a, b\nst a\n",
     "l", 0},
    {"s.state a\n.temp l\n.temp t\nstep:\nld l\nld a\nadd a, a, a\nst a\nphase\nld a\nld l\nst "
     "a\nphase\nld l\nld a\nst a\n",
     NULL, 0},
};

static void check_by_hand(chance *c) {
    for (size_t i = 0; i < sizeof by_hand / sizeof *by_hand; i++) {
        fp3_assembly *made = NULL;
        links l;
        float column[OBJECTS_MAX];
        told(fp3_assemble(by_hand[i].text + 1, strlen(by_hand[i].text + 1), "hand.s", &made,
                          &error));
        for (uint32_t objects = 1; objects <= 50 && objects <= most; objects += 7) {
            both b = open_both(made->image, objects);
            const fp3_neighbours some = {.begin = l.begin, .other = l.other, .fields = l.fields};
            for (uint32_t reg = 0; reg < words_of(&b); reg++) {
                for (uint32_t k = 0; k < objects; k++)
                    column[k] = (float)below(c, 1000) / 64;
                write_both(&b, reg, column);
            }
            link_some(c, objects, 3, by_hand[i].fields, &l);
            if (by_hand[i].list) {
                told(fp3_engine_set_neighbours(b.isa, 0, by_hand[i].list, &some));
                told(fp3_engine_set_neighbours(b.rtl, 0, by_hand[i].list, &some));
            }
            run_both(&b, 3, "by hand", "one");
            run_both(&b, 2, "by hand", "two");
            close_both(&b);
        }
        fp3_assembly_free(&made);
    }
}

/* Some lanes have no object in the last row, and there a list before was longer: the loop is as
 * long as those that are there. */
static void check_last_row(chance *c) {
    const uint32_t row = fp3_config_find(config)->contexts * fp3_config_find(config)->lanes;
    fp3_assembly *made = NULL;
    links l;
    if (row + 2 > OBJECTS_MAX || fp3_config_find(config)->lanes == 1)
        return;
    told(fp3_assemble(by_hand[0].text + 1, strlen(by_hand[0].text + 1), "hand.s", &made, &error));
    for (int i = 0; i < 3; i++) {
        both b = open_both(made->image, row + 2);
        const fp3_neighbours some = {.begin = l.begin, .other = l.other, .fields = l.fields};
        link_some(c, b.objects, 2 + i, 0, &l);
        told(fp3_engine_set_neighbours(b.isa, 0, "l", &some));
        told(fp3_engine_set_neighbours(b.rtl, 0, "l", &some));
        run_both(&b, 1, "by hand", "a last row");
        close_both(&b);
    }
    fp3_assembly_free(&made);
}

static void give_list(const both *b, const char *name, const fp3_neighbours *given) {
    told(fp3_engine_set_neighbours(b->isa, 0, name, given));
    told(fp3_engine_set_neighbours(b->rtl, 0, name, given));
}

/* After a run: objects are in the lanes that the lists of now ask for. */
static void check_slots(const both *b, uint32_t *slot) {
    told(fp3_partition_find(b->rtl, slot));
    if (memcmp(slot, group_of(b->rtl)->slot, b->objects * sizeof *slot))
        FAIL("objects are not placed by the lists that they have");
}

/* Of two lists one has the links, and either one counts; then the first alone is given anew, and
 * objects move. */
static void check_places(chance *c) {
    static const char text[] = ".state a\n.temp l\n.temp m\nstep:\nld l\nld m\nld a\neach l\n"
                               "addn a, a, a\nnext\neach m\naddn a, a, a\nnext\nst a\n";
    const uint32_t none[OBJECTS_MAX + 1] = {0};
    uint32_t slot[3][OBJECTS_MAX];
    float column[OBJECTS_MAX];
    fp3_assembly *made = NULL;
    links l;
    if (fp3_config_find(config)->lanes == 1)
        return;
    told(fp3_assemble(text, strlen(text), "places.s", &made, &error));
    both b = open_both(made->image, most < 25 ? most : 25);
    const fp3_neighbours some = {.begin = l.begin, .other = l.other, .fields = l.fields},
                         nobody = {.begin = none, .other = none, .fields = l.fields};
    for (uint32_t k = 0; k < b.objects; k++)
        column[k] = (float)k / 4;
    write_both(&b, 0, column);
    link_some(c, b.objects, 2, 0, &l);
    for (int i = 0; i < 2; i++) {
        give_list(&b, "l", i ? &nobody : &some);
        give_list(&b, "m", i ? &some : &nobody);
        run_both(&b, 1, "two lists", i ? "the second" : "the first");
        check_slots(&b, slot[i]);
    }
    link_some(c, b.objects, 2, 0, &l);
    give_list(&b, "l", &some);
    run_both(&b, 1, "two lists", "the first again");
    check_slots(&b, slot[2]);
    if (memcmp(slot[0], slot[1], sizeof *column * b.objects) ||
        !memcmp(slot[1], slot[2], sizeof *column * b.objects))
        FAIL("where objects are depends on which list has the links, or not on the links");
    close_both(&b);
    fp3_assembly_free(&made);
}

int main(int argc, char **argv) {
    chance c = {.state = argc > 1 ? strtoull(argv[1], NULL, 0) : 1};
    if (argc > 2)
        config = argv[2];
    if (argc > 3)
        most = (uint32_t)strtoul(argv[3], NULL, 0);
    check_subject(&c, chain, "euler");
    check_subject(&c, chain, "leapfrog");
    check_subject(&c, chain, "rk4");
    check_subject(&c, cloth, "leapfrog");
    check_subject(&c, cloth, "rk4");
    check_subject(&c, gravity, "euler");
    check_subject(&c, gravity, "leapfrog");
    check_subject(&c, gravity, "rk4");
    check_subject(&c, balls, "euler");
    check_subject(&c, balls, "leapfrog");
    check_subject(&c, balls, "rk4");
    check_subject(&c, grains, "euler");
    check_subject(&c, grains, "leapfrog");
    check_by_hand(&c);
    check_last_row(&c);
    check_places(&c);
    printf("%u runs, %u failed\n", runs, failed);
    return failed != 0;
}
