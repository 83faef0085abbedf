// units_bench: the netlist of tests/fpga/units.v (units_netlist) beside its source, which it must equal in every cycle.
//
//     vvp units.vvp +pairs=N +seed=S
`default_nettype none
`timescale 1ns / 1ps
module units_bench;
    reg     clk = 1'b0;
    integer cycle = 0, errors = 0, pairs = 1000, seed = 1, gap;
    always #5 clk = !clk;

    // Special values, equal or near exponents, few ones, few zeros, or anything.
    reg         sub = 1'b0;
    reg  [31:0] a = 32'd0, b = 32'd0;
    function [31:0] operand(input integer kind, input [31:0] near, input [31:0] x, input integer by);
        case (kind)
            0:       operand = {x[31], {8{x[30]}}, x[29] ? 23'd0 : x[22:0]};             // zero, subnormal, infinity, NaN
            1:       operand = {x[31], 8'd1 + {6'd0, x[30:29]}, 23'd0} - {31'd0, x[0]};   // about the smallest normal
            2:       operand = {x[31], x[30:23], {23{x[0]}} ^ (23'd1 << x[5:1])};
            3:       operand = {x[31], near[30:23] + by[7:0], x[22:0]};
            4:       operand = {!near[31], near[30:0]} + {30'd0, x[1:0]};
            5:       operand = {x[31], 8'd254 - near[30:23] + by[7:0], x[22:0]};          // a product of 1
            6:       operand = {x[31], 8'd127 - near[30:23] + by[7:0], x[22:0]};          // a product about 2^-127
            default: operand = x;
        endcase
    endfunction
    always @(negedge clk) begin
        gap = $unsigned($random(seed)) % 32 - 16;
        sub <= $random(seed);
        a   <= operand($random(seed) & 3, 32'd0, $random(seed), gap);
        b   <= operand($random(seed) & 7, a, $random(seed), gap);
    end

    wire [73:0] source, netlist;
    units u_source (.clk_i(clk), .sub_i(sub), .a_i(a), .b_i(b), .sum_o(source[31:0]), .product_o(source[63:32]),
        .sum_flags_o(source[68:64]), .product_flags_o(source[73:69]));
    units_netlist u_netlist (.clk_i(clk), .sub_i(sub), .a_i(a), .b_i(b), .sum_o(netlist[31:0]), .product_o(netlist[63:32]),
        .sum_flags_o(netlist[68:64]), .product_flags_o(netlist[73:69]));
    always @(posedge clk) begin
        cycle <= cycle + 1;
        if (cycle > 4 && (source !== netlist || ^source === 1'bx)) begin
            errors <= errors + 1;
            if (errors < 4) $display("sub %b a %h b %h: %h, source %h", sub, a, b, netlist, source);
        end
    end

    initial begin
        cycle = $value$plusargs("pairs=%d", pairs) + $value$plusargs("seed=%d", seed);
        cycle = 0;
        wait (cycle == pairs);
        $display("%s: %0d pairs, %0d errors", errors == 0 ? "PASS" : "FAIL", pairs, errors);
        $finish;
    end
endmodule
`default_nettype wire
