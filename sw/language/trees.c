/* SPDX-License-Identifier: Apache-2.0 */
#include "trees.h"

#include <assert.h>

typedef struct {
    fp3_tree *trees;
    unsigned count;
} forest;

/* Completes the draft in every way by children with `left` vertices in all. Children are chosen in
 * falling order, below `limit`, so each set of children is found once. */
static void grow(forest *f, const fp3_tree *draft, unsigned left, unsigned limit) {
    if (left == 0) {
        assert(f->count < FP3_TREE_COUNT);
        f->trees[f->count++] = *draft;
        return;
    }
    for (unsigned i = limit; i-- > 0;) {
        const fp3_tree *child = &f->trees[i];
        if (child->order > left)
            continue;
        fp3_tree larger = *draft;
        larger.child[larger.child_count++] = i;
        larger.gamma *= child->gamma;
        grow(f, &larger, left - child->order, i + 1);
    }
}

void fp3_trees(fp3_tree trees[FP3_TREE_COUNT]) {
    forest f = {.trees = trees};
    for (unsigned order = 1; order <= FP3_TREE_ORDER; order++) {
        const fp3_tree root = {.order = order, .gamma = order};
        grow(&f, &root, order - 1, f.count);
    }
}

static char *write_tree(const fp3_tree *trees, unsigned tree, char *text) {
    const fp3_tree *t = &trees[tree];
    if (t->child_count == 0) {
        *text++ = 't';
        return text;
    }
    for (unsigned i = 0; i < t->child_count; i++) {
        *text++ = i ? ',' : '[';
        text = write_tree(trees, t->child[i], text);
    }
    *text++ = ']';
    return text;
}

void fp3_tree_text(const fp3_tree *trees, unsigned tree, char text[FP3_TREE_TEXT]) {
    *write_tree(trees, tree, text) = '\0';
}
