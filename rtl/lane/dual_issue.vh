// SPDX-License-Identifier: Apache-2.0
// dual_issue.vh: the bundle DUAL_ISSUE, which goes from lane to lane where a sum and a product may
// issue at once: the operands of both, each for a context of its own.
// front/decoded.vh shows how a bundle is used.
//
//     minus_x, minus_y            of the sum: +/- x +/- y
//     twice, halve                what y is multiplied with
//     st, st_y                    not a sum: x is stored, or y
//     record_shift, register      as in lane/issue.vh
//     st_row                      the row that is stored; of the store of two cycles ago
//     sum_x, sum_y                {context, half the register's number}: x from the bank of sums, y from
//     product_x, product_y        that of products. Constants are in both, under the highest contexts.
//                                 sum_y is that of the sum that comes two cycles later
`define FP3_DUAL_ISSUE_W (8 + REGISTER_W + ROW_W + 4*BANK_W)
`define FP3_DUAL_ISSUE_FIELDS \
    wire issue_minus_x, issue_minus_y, issue_twice, issue_halve, issue_st, issue_st_y; \
    wire [1:0] issue_record_shift; \
    wire [REGISTER_W-1:0] issue_register; \
    wire [ROW_W-1:0] issue_st_row; \
    wire [BANK_W-1:0] issue_sum_x, issue_sum_y, issue_product_x, issue_product_y;
`define FP3_DUAL_ISSUE {issue_minus_x, issue_minus_y, issue_twice, issue_halve, issue_st, issue_st_y, \
    issue_record_shift, issue_register, issue_st_row, issue_sum_x, issue_sum_y, issue_product_x, issue_product_y}
