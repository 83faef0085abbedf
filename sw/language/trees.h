/* SPDX-License-Identifier: Apache-2.0 */
/* trees.h - rooted trees, which count the conditions for the order of an integrator.
 *
 * As in Hairer, Norsett and Wanner, Solving Ordinary Differential Equations I, chapter II.2.
 */
#ifndef FP3_TREES_H
#define FP3_TREES_H

enum {
    FP3_TREE_ORDER = 8,   /* vertices of the largest */
    FP3_TREE_COUNT = 200, /* 1 + 1 + 2 + 4 + 9 + 20 + 48 + 115 */
    FP3_TREE_TEXT = 32    /* bytes of a tree as text, its NUL included */
};

typedef struct {
    unsigned order; /* vertices */
    unsigned child_count;
    unsigned child[FP3_TREE_ORDER - 1]; /* indices of smaller trees, in falling order */
    double gamma;                       /* density: order times the gammas of the children */
} fp3_tree;

/* All of them, by order. */
void fp3_trees(fp3_tree trees[FP3_TREE_COUNT]);

/* "t" is one vertex, "[[t],t]" a root with the children [t] and t. */
void fp3_tree_text(const fp3_tree *trees, unsigned tree, char text[FP3_TREE_TEXT]);

#endif
