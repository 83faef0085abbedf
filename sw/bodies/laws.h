/* SPDX-License-Identifier: Apache-2.0 */
/* laws.h - the laws of contacts and joints (programs/bodies/), instruction by instruction.
 *
 * Made by tools/laws.py; do not edit. a and b are the words of the two bodies (state.h), for eight
 * contacts at a time.
 */
#ifndef FP3_BODIES_LAWS_H
#define FP3_BODIES_LAWS_H

#include "wide.h"

#define FP3_BODY2_WORDS "v_x", "v_y", "w", "d_x", "d_y", "q", "m", "i"

typedef struct {
    fp3_wide n_x;
    fp3_wide n_y;
    fp3_wide a1;
    fp3_wide b1;
    fp3_wide c1;
    fp3_wide e1;
    fp3_wide s1;
    fp3_wide j1;
    fp3_wide k1;
    fp3_wide a2;
    fp3_wide b2;
    fp3_wide c2;
    fp3_wide e2;
    fp3_wide s2;
    fp3_wide j2;
    fp3_wide k2;
    fp3_wide mu;
    fp3_wide belt;
    fp3_wide reach;
    fp3_wide jr;
    fp3_wide rate;
    fp3_wide soft;
    fp3_wide fade;
    fp3_wide p1;
    fp3_wide f1;
    fp3_wide p2;
    fp3_wide f2;
    fp3_wide r;
    fp3_wide top1;
    fp3_wide top2;
    fp3_wide out1;
    fp3_wide out2;
} fp3_contact2_row;
#define FP3_CONTACT2_WORDS                                                                         \
    "n_x", "n_y", "a1", "b1", "c1", "e1", "s1", "j1", "k1", "a2", "b2", "c2", "e2", "s2", "j2",    \
        "k2", "mu", "belt", "reach", "jr", "rate", "soft", "fade", "p1", "f1", "p2", "f2", "r",    \
        "top1", "top2", "out1", "out2"

FP3_WIDELY void fp3_contact2(fp3_contact2_row *row, fp3_wide *a, fp3_wide *b, fp3_wide push,
                             fp3_wide inverse, fp3_wide least) {
    fp3_wide t0 = row->p1 + row->p2;
    t0 = row->reach * t0;
    fp3_wide t1 = b[2] - a[2];
    t1 = row->r - row->jr * t1;
    fp3_wide t2 = fp3_wide_all(-0.0f) - t0;
    t1 = fp3_wide_max(t1, t2);
    t2 = row->r + fp3_wide_all(-0.0f);
    row->r = fp3_wide_min(t1, t0);
    t2 = row->r - t2;
    t0 = b[1] - a[1];
    t0 = row->n_x * t0;
    t1 = b[0] - a[0];
    t0 = t0 - row->n_y * t1;
    t1 = b[2] + b[7] * t2;
    t2 = a[2] - a[7] * t2;
    t0 = t0 + row->e1 * t1;
    t0 = t0 - row->c1 * t2;
    t0 = t0 - row->belt;
    t0 = row->f1 - row->k1 * t0;
    fp3_wide t3 = row->mu * row->p1;
    fp3_wide t4 = fp3_wide_all(-0.0f) - t3;
    t0 = fp3_wide_max(t0, t4);
    t4 = row->f1 + fp3_wide_all(-0.0f);
    row->f1 = fp3_wide_min(t0, t3);
    t4 = row->f1 - t4;
    t0 = a[6] * t4;
    t3 = b[6] * t4;
    fp3_wide t5 = a[1] - t0 * row->n_x;
    t0 = a[0] + t0 * row->n_y;
    fp3_wide t6 = b[1] + t3 * row->n_x;
    t3 = b[0] - t3 * row->n_y;
    fp3_wide t7 = t6 - t5;
    t7 = row->n_x * t7;
    fp3_wide t8 = b[7] * row->e1;
    t1 = t1 + t8 * t4;
    t8 = t3 - t0;
    t7 = t7 - row->n_y * t8;
    t7 = t7 + row->e2 * t1;
    t8 = a[7] * row->c1;
    t2 = t2 - t8 * t4;
    t7 = t7 - row->c2 * t2;
    t7 = t7 - row->belt;
    t7 = row->f2 - row->k2 * t7;
    t4 = row->mu * row->p2;
    t8 = fp3_wide_all(-0.0f) - t4;
    t7 = fp3_wide_max(t7, t8);
    t8 = row->f2 + fp3_wide_all(-0.0f);
    row->f2 = fp3_wide_min(t7, t4);
    t8 = row->f2 - t8;
    t4 = b[3] - a[3];
    t4 = t4 * row->n_x;
    t7 = b[4] - a[4];
    t4 = t4 + t7 * row->n_y;
    t7 = a[6] * t8;
    t0 = t0 + t7 * row->n_y;
    t5 = t5 - t7 * row->n_x;
    t7 = b[6] * t8;
    t3 = t3 - t7 * row->n_y;
    t6 = t6 + t7 * row->n_x;
    t7 = row->s1 + t4;
    t7 = t7 + row->b1 * b[5];
    t7 = t7 - row->a1 * a[5];
    t4 = row->s2 + t4;
    t4 = t4 + row->b2 * b[5];
    t4 = t4 - row->a2 * a[5];
    fp3_wide t9 = t3 - t0;
    t9 = t9 * row->n_x;
    fp3_wide t10 = b[7] * row->e2;
    t1 = t1 + t10 * t8;
    t10 = t6 - t5;
    t9 = t9 + t10 * row->n_y;
    t9 = t9 + row->b1 * t1;
    t10 = push * row->rate;
    fp3_wide t11 = a[7] * row->c2;
    t2 = t2 - t11 * t8;
    t9 = t9 - row->a1 * t2;
    t8 = t10 * t7;
    t8 = fp3_wide_max(t8, least);
    t10 = t10 * t4;
    t10 = fp3_wide_max(t10, least);
    t11 = fp3_wide_sel(row->soft, fp3_wide_all(1.0f), push);
    fp3_wide t12 = fp3_wide_lt(fp3_wide_all(0.0f), t7);
    t7 = t7 * inverse;
    t7 = fp3_wide_sel(t7, t8, t12);
    t7 = t9 + t7;
    t9 = fp3_wide_sel(fp3_wide_all(1.0f), t11, t12);
    t9 = row->j1 * t9;
    t7 = row->p1 - t9 * t7;
    t9 = push * row->fade;
    t12 = fp3_wide_sel(fp3_wide_all(0.0f), t9, t12);
    t7 = t7 - t12 * row->p1;
    t12 = row->p1 + fp3_wide_all(-0.0f);
    row->p1 = fp3_wide_max(t7, fp3_wide_all(0.0f));
    t12 = row->p1 - t12;
    row->top1 = fp3_wide_max(row->top1, row->p1);
    t7 = a[6] * t12;
    t0 = t0 - t7 * row->n_x;
    t5 = t5 - t7 * row->n_y;
    t7 = b[6] * t12;
    t3 = t3 + t7 * row->n_x;
    t6 = t6 + t7 * row->n_y;
    t7 = t3 - t0;
    t7 = t7 * row->n_x;
    t8 = b[7] * row->b1;
    t1 = t1 + t8 * t12;
    t8 = t6 - t5;
    t7 = t7 + t8 * row->n_y;
    t7 = t7 + row->b2 * t1;
    t8 = a[7] * row->a1;
    t2 = t2 - t8 * t12;
    t7 = t7 - row->a2 * t2;
    t8 = fp3_wide_lt(fp3_wide_all(0.0f), t4);
    t4 = t4 * inverse;
    t4 = fp3_wide_sel(t4, t10, t8);
    t4 = t7 + t4;
    t11 = fp3_wide_sel(fp3_wide_all(1.0f), t11, t8);
    t8 = fp3_wide_sel(fp3_wide_all(0.0f), t9, t8);
    t11 = row->j2 * t11;
    t4 = row->p2 - t11 * t4;
    t4 = t4 - t8 * row->p2;
    t8 = row->p2 + fp3_wide_all(-0.0f);
    row->p2 = fp3_wide_max(t4, fp3_wide_all(0.0f));
    t8 = row->p2 - t8;
    row->top2 = fp3_wide_max(row->top2, row->p2);
    t4 = a[6] * t8;
    a[0] = t0 - t4 * row->n_x;
    a[1] = t5 - t4 * row->n_y;
    t4 = a[7] * row->a2;
    a[2] = t2 - t4 * t8;
    t2 = b[6] * t8;
    b[0] = t3 + t2 * row->n_x;
    b[1] = t6 + t2 * row->n_y;
    t2 = b[7] * row->b2;
    b[2] = t1 + t2 * t8;
}

FP3_WIDELY void fp3_warm2(fp3_contact2_row *row, fp3_wide *a, fp3_wide *b) {
    fp3_wide t0 = row->p1 + row->p2;
    fp3_wide t1 = row->f1 + row->f2;
    fp3_wide t2 = t0 * row->n_x;
    t2 = t2 - t1 * row->n_y;
    a[0] = a[0] - a[6] * t2;
    t0 = t0 * row->n_y;
    t0 = t0 + t1 * row->n_x;
    a[1] = a[1] - a[6] * t0;
    t1 = row->p1 * row->a1;
    t1 = t1 + row->p2 * row->a2;
    t1 = t1 + row->f1 * row->c1;
    t1 = t1 + row->f2 * row->c2;
    t1 = t1 + row->r;
    a[2] = a[2] - a[7] * t1;
    b[0] = b[0] + b[6] * t2;
    b[1] = b[1] + b[6] * t0;
    t0 = row->p1 * row->b1;
    t0 = t0 + row->p2 * row->b2;
    t0 = t0 + row->f1 * row->e1;
    t0 = t0 + row->f2 * row->e2;
    t0 = t0 + row->r;
    b[2] = b[2] + b[7] * t0;
}

FP3_WIDELY void fp3_bounce2(fp3_contact2_row *row, fp3_wide *a, fp3_wide *b) {
    fp3_wide t0 = b[0] - a[0];
    t0 = t0 * row->n_x;
    fp3_wide t1 = b[1] - a[1];
    t0 = t0 + t1 * row->n_y;
    t0 = t0 + row->b1 * b[2];
    t0 = t0 - row->a1 * a[2];
    t0 = t0 - row->out1;
    t0 = row->p1 - row->j1 * t0;
    t0 = fp3_wide_max(t0, fp3_wide_all(0.0f));
    t1 = fp3_wide_lt(fp3_wide_all(0.0f), row->out1);
    fp3_wide t2 = fp3_wide_lt(fp3_wide_all(0.0f), row->top1);
    t1 = t1 * t2;
    t2 = row->p1 + fp3_wide_all(-0.0f);
    row->p1 = fp3_wide_sel(t0, row->p1, t1);
    t2 = row->p1 - t2;
    row->top1 = fp3_wide_max(row->top1, row->p1);
    t0 = a[6] * t2;
    t1 = b[6] * t2;
    fp3_wide t3 = a[0] - t0 * row->n_x;
    t0 = a[1] - t0 * row->n_y;
    fp3_wide t4 = b[0] + t1 * row->n_x;
    t1 = b[1] + t1 * row->n_y;
    fp3_wide t5 = t4 - t3;
    t5 = t5 * row->n_x;
    fp3_wide t6 = b[7] * row->b1;
    t6 = b[2] + t6 * t2;
    fp3_wide t7 = t1 - t0;
    t5 = t5 + t7 * row->n_y;
    t5 = t5 + row->b2 * t6;
    t7 = a[7] * row->a1;
    t2 = a[2] - t7 * t2;
    t5 = t5 - row->a2 * t2;
    t5 = t5 - row->out2;
    t5 = row->p2 - row->j2 * t5;
    t5 = fp3_wide_max(t5, fp3_wide_all(0.0f));
    t7 = fp3_wide_lt(fp3_wide_all(0.0f), row->out2);
    fp3_wide t8 = fp3_wide_lt(fp3_wide_all(0.0f), row->top2);
    t7 = t7 * t8;
    t8 = row->p2 + fp3_wide_all(-0.0f);
    row->p2 = fp3_wide_sel(t5, row->p2, t7);
    t8 = row->p2 - t8;
    row->top2 = fp3_wide_max(row->top2, row->p2);
    t5 = a[6] * t8;
    a[0] = t3 - t5 * row->n_x;
    a[1] = t0 - t5 * row->n_y;
    t0 = a[7] * row->a2;
    a[2] = t2 - t0 * t8;
    t0 = b[6] * t8;
    b[0] = t4 + t0 * row->n_x;
    b[1] = t1 + t0 * row->n_y;
    t0 = b[7] * row->b2;
    b[2] = t6 + t0 * t8;
}

#endif
