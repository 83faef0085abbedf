/* integrators - what the library makes of tables, as lines that a test can read.
 *
 *     integrators list             name, kind, stages, order, order of a position, order by the
 *                                  conditions, worst residual, next one; of each that is built in
 *     integrators show NAME        the same of one, a name or a file, then its coefficients
 *     integrators trees            order, gamma, tree
 */
#include <fp3/model.h>
#include <language/trees.h>
#include <stdio.h>
#include <string.h>

static int fail(fp3_status status, const fp3_error *error) {
    fprintf(stderr, "%s\n", error->text);
    return fp3_exit_code(status);
}

static void print_line(const fp3_integrator *table) {
    double worst = 0, next = 0;
    const unsigned order = fp3_integrator_order(table, &worst, &next);
    printf("%s %d %u %u %u %u %.3g %.3g\n", table->name, table->kind, table->stages, table->order,
           table->position_order, order, worst, next);
}

static void print_coefficients(const fp3_integrator *table) {
    printf("doc %s\nsource %s\n", table->doc, table->source);
    for (unsigned i = 0; i < table->stages; i++) {
        if (table->kind == FP3_SPLITTING) {
            printf("%s %.17g\n", table->substeps[i].is_kick ? "kick" : "drift",
                   table->substeps[i].coefficient);
            continue;
        }
        printf("c %.17g b %.17g a", table->c[i], table->b[i]);
        for (unsigned j = 0; j < i; j++)
            printf(" %.17g", table->a[i][j]);
        printf("\n");
    }
}

static int list(void) {
    const char *name;
    for (unsigned i = 0; (name = fp3_integrator_name(i)); i++) {
        fp3_integrator *table = NULL;
        fp3_error error;
        const fp3_status status = fp3_integrator_find(name, &table, &error);
        if (status)
            return fail(status, &error);
        print_line(table);
        fp3_integrator_free(&table);
    }
    return 0;
}

static int show(const char *name) {
    fp3_integrator *table = NULL;
    fp3_error error;
    const fp3_status status = fp3_integrator_find(name, &table, &error);
    if (status)
        return table ? 3 : fail(status, &error);
    print_line(table);
    print_coefficients(table);
    fp3_integrator_free(&table);
    fp3_integrator_free(&table);
    return 0;
}

static int print_trees(void) {
    fp3_tree trees[FP3_TREE_COUNT];
    fp3_trees(trees);
    for (unsigned i = 0; i < FP3_TREE_COUNT; i++) {
        char text[FP3_TREE_TEXT];
        fp3_tree_text(trees, i, text);
        printf("%u %.0f %s\n", trees[i].order, trees[i].gamma, text);
    }
    return 0;
}

int main(int argc, char **argv) {
    if (argc == 2 && strcmp(argv[1], "list") == 0)
        return list();
    if (argc == 3 && strcmp(argv[1], "show") == 0)
        return show(argv[2]);
    if (argc == 2 && strcmp(argv[1], "trees") == 0)
        return print_trees();
    fprintf(stderr, "usage: integrators list | show NAME | trees\n");
    return 2;
}
