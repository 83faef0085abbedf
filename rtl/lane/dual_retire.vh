// SPDX-License-Identifier: Apache-2.0
// dual_retire.vh: the bundle DUAL_RETIRE, which goes from lane to lane TO_END cycles after
// DUAL_ISSUE: what the ends of two instructions need.
// front/decoded.vh shows how a bundle is used.
//
//     sum_valid, product_valid    an instruction ends; without it nothing else of its stream is set
//     sum_adds, sum_loads         it writes a sum, or a word of the store; a store does neither
//     product_loads               it writes a word of the store, and no product
//     .._row, .._context          whose; register: which one is written
//     load_row, load_register     what is read of the store, if one of them loads
`define FP3_DUAL_RETIRE_W (5 + 3*ROW_W + 2*REG_W + REGISTER_W)
`define FP3_DUAL_RETIRE_FIELDS \
    wire retire_sum_valid, retire_sum_adds, retire_sum_loads, retire_product_valid, retire_product_loads; \
    wire [ROW_W-1:0] retire_sum_row, retire_product_row, retire_load_row; \
    wire [CONTEXT_W-1:0] retire_sum_context, retire_product_context; \
    wire [REGISTER_W-1:0] retire_sum_register, retire_product_register, retire_load_register;
`define FP3_DUAL_RETIRE {retire_sum_valid, retire_sum_adds, retire_sum_loads, retire_product_valid, retire_product_loads, \
    retire_sum_row, retire_product_row, retire_load_row, retire_sum_context, retire_product_context, \
    retire_sum_register, retire_product_register, retire_load_register}
