// SPDX-License-Identifier: Apache-2.0
// place.vh: the bundle PLACE, the exponent of a product, and what follows from it before the
// product is there: from fp_mul_scale, beside the product, to where it is rounded. For modules with
// a parameter EXP. front/decoded.vh shows how a bundle is used.
//
//     field                       the exponent's field
//     low                         the result is subnormal unless the product's top bit is set
//     over                        the exponent is that of an infinity or more
//     by1, by2                    it is one or two short of that
//     gone                        the result is flushed to zero, whatever the product
`define FP3_PLACE_W (EXP + 5)
`define FP3_PLACE_FIELDS /* verilator lint_off UNUSEDSIGNAL */ \
    wire [EXP-1:0] place_field; \
    wire place_low, place_over, place_by1, place_by2, place_gone; /* verilator lint_on UNUSEDSIGNAL */
`define FP3_PLACE {place_field, place_low, place_over, place_by1, place_by2, place_gone}
// The bit of low, for modules that need no other.
`define FP3_PLACE_LOW 4
