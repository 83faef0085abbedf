// solo_arith: the pipelined adder and multiplier, and the chain from one to the other.
//
// Purpose   One door to the floating-point cores: operands go in every cycle, meant or not, and
//           a result appears a fixed number of cycles later in the unit's result register.
//           Whoever issues knows when, so neither valid bit nor tag travels with them.
//
//               a, b ──► multiplier ──► mul_value_o
//                              │ chained
//               a, b ──────────┴► adder ──► add_value_o
//
// Latency   ADD_LATENCY, MUL_LATENCY; chained: their sum. Initiation interval 1.
// Hazard    chain_soon_o announces that a chained product takes the adder in the next cycle:
//           no addition may issue then (solo_scheduler checks it), and the adder's operands are to be chain_c_o
//           and the product.
`default_nettype none
module solo_arith #(
`include "config/config.vh"
) (
    input  wire        clk_i,
    input  wire        rst_i,
    // Operands
    input  wire        chain_i,        // the product goes on to the adder: c +/- a * b
    input  wire        subtract_i,
    input  wire [CHOICE_W-1:0] choice_i, // gen/choices.vh: what is made of c, b, and of whether a is 0; chain_i is 1 then
    input  wire [31:0] add_a_i,        // of a chain, too
    input  wire [31:0] add_b_i,
    input  wire [31:0] mul_a_i,
    input  wire [31:0] mul_b_i,
    input  wire [31:0] mul_c_i,
    output wire        chain_soon_o,
    output wire [31:0] chain_c_o,      // the addend of the product that takes the adder in this cycle
    // Results, {NV, DZ, OF, UF, NX}
    output wire [31:0] add_value_o,
    output wire [4:0]  add_flags_o,
    output wire [31:0] mul_value_o,
    output wire [4:0]  mul_flags_o
);
    // The chain's other operand waits for the product.
    wire        chained;               // a product reaches the adder in this cycle
    wire        chain_subtract;
    wire [4:0]  chain_flags;
    wire        no_product;            // in the next cycle
    generate
        if (CHAIN != 0 || VALUES != 0) begin : g_chain
            wire soon;
            delay #(.W(1), .N(MUL_LATENCY-1)) u_soon (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(chain_i), .q_o(soon));
            delay #(.W(1), .N(1)) u_chained (.clk_i(clk_i), .rst_i(rst_i),
                .d_i(soon), .q_o(chained));
            delay #(.W(1), .N(MUL_LATENCY)) u_subtract (.clk_i(clk_i), .rst_i(1'b0),
                .d_i(subtract_i), .q_o(chain_subtract));
            fp_value #(.CONFIG(CONFIG)) u_c (.clk_i(clk_i),
                .choice_i(choice_i), .a_i(mul_c_i), .b_i(mul_b_i), .true_i(|mul_a_i[30:0]),
                .z_o(chain_c_o), .no_product_o(no_product));
            delay #(.W(5), .N(ADD_LATENCY)) u_flags (.clk_i(clk_i), .rst_i(1'b0),
                .d_i(chained ? mul_flags_o : 5'd0), .q_o(chain_flags));
            assign chain_soon_o = soon;
        end else begin : g_no_chain
            wire unused = |{chain_i, choice_i, mul_c_i, rst_i};
            assign {chain_soon_o, chained, chain_subtract, chain_c_o, chain_flags, no_product} = 41'd0;
        end
    endgenerate

    wire [4:0] add_flags;
    adder #(.CONFIG(CONFIG)) u_add (.clk_i(clk_i), .subtract_i(chained ? chain_subtract : subtract_i),
        .a_i(add_a_i), .b_i(add_b_i), .value_o(add_value_o), .flags_o(add_flags));
    multiplier #(.CONFIG(CONFIG)) u_mul (.clk_i(clk_i), .no_product_i(no_product),
        .a_i(mul_a_i), .b_i(mul_b_i), .value_o(mul_value_o), .flags_o(mul_flags_o));
    assign add_flags_o = add_flags | chain_flags;
endmodule
`default_nettype wire
