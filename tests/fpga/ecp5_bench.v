// ecp5_bench: each ECP5 version beside the generic one, which it must equal in every cycle.
//
// The test gives the versions of rtl/fpga/ecp5 other names: ecp5_ before theirs.
`default_nettype none
`timescale 1ns / 1ps
module ecp5_bench;
    reg     clk = 1'b0;
    integer cycle = 0, errors = 0;
    always #5 clk = !clk;
    always @(posedge clk) cycle <= cycle + 1;

    // Significands: few ones, few zeros, or anything.
    reg [23:0] a = 24'd0, b = 24'd0;
    function [23:0] significand(input integer kind);
        reg [23:0] x;
        begin
            x = $random;
            case (kind)
                0:       significand = 24'd1 << x[4:0];
                1:       significand = ~(24'd1 << x[4:0]);
                2:       significand = 24'hffffff << x[4:0];
                3:       significand = 24'hffffff >> x[4:0];
                default: significand = x;
            endcase
        end
    endfunction
    // First all pairs of high parts, for the tile that is logic.
    wire [11:0] pair = cycle;
    reg  [23:0] next_a, next_b;
    always @(posedge clk) begin
        next_a = significand($random & 7);
        next_b = significand($random & 7);
        if (cycle < 4096) {next_a[23:18], next_b[23:18]} = pair;
        a <= next_a;
        b <= next_b;
    end

    // What a comparison must wait for: registers fill, and words that were read early are x.
    wire settled = cycle > 8;
    localparam [79:0] FEWER = {5'd17, 5'd15, 5'd7, 5'd17, 5'd2, 5'd20, 5'd18};
    genvar i;
    generate
        // All cuts, and fewer bits: three tiles, and one.
        for (i = 0; i < 23; i = i + 1) begin : g_product
            localparam       FRAC = i < 16 ? 23 : FEWER[5 * (i % 16) +: 5];
            localparam [3:0] CUTS = i < 16 ? i : i == 19 ? 5 : i == 21 ? 2 : 15;
            wire [2*FRAC+1:0] generic, device, wide;
            // What cuts and fewer bits change, some hundred cycles show; all pairs go through the product with all cuts.
            reg  [23:0] x = 24'd0, y = 24'd0;
            always @(posedge clk) if (cycle < 500 || i == 15) {x, y} <= {a, b};
            fp3_fp_mul_product #(.FRAC(FRAC), .CUTS(CUTS)) u_generic (.clk_i(clk),
                .a_i(x[FRAC:0]), .b_i(y[FRAC:0]), .p_o(generic));
            ecp5_fp_mul_product #(.FRAC(FRAC), .CUTS(CUTS)) u_device (.clk_i(clk),
                .a_i(x[FRAC:0]), .b_i(y[FRAC:0]), .p_o(device));
            always @(posedge clk) if (settled && generic !== device) begin
                errors = errors + 1;
                $display("product FRAC %0d CUTS %b: %h, generic %h", FRAC, CUTS, device, generic);
            end
            wide_fp_mul_product #(.FRAC(FRAC), .CUTS(CUTS)) u_wide (.clk_i(clk),
                .a_i(x[FRAC:0]), .b_i(y[FRAC:0]), .p_o(wide));
            always @(posedge clk) if (settled && generic !== wide) begin
                errors = errors + 1;
                $display("wide product FRAC %0d CUTS %b: %h, generic %h", FRAC, CUTS, wide, generic);
            end
        end

        // One bit, and words of any width: every choice of every four bits comes up.
        for (i = 0; i < 2; i = i + 1) begin : g_mux4
            localparam W = i == 0 ? 1 : 26;
            wire [4*W-1:0] words = {a, b, ~a, ~b, a, b};
            wire [1:0]     n = a[4:3] ^ b[1:0];
            wire [W-1:0]   generic, device;
            fp3_mux4 #(.W(W)) u_generic (.n_i(n), .d0_i(words[0 +: W]), .d1_i(words[W +: W]),
                .d2_i(words[2*W +: W]), .d3_i(words[3*W +: W]), .q_o(generic));
            ecp5_mux4 #(.W(W)) u_device (.n_i(n), .d0_i(words[0 +: W]), .d1_i(words[W +: W]),
                .d2_i(words[2*W +: W]), .d3_i(words[3*W +: W]), .q_o(device));
            always @(posedge clk) if (settled && generic !== device) begin
                errors = errors + 1;
                $display("mux4 W %0d: %h, generic %h", W, device, generic);
            end
        end

        // Memories of every shape of block, one or several beside each other, and more words than a block has.
        for (i = 0; i < 10; i = i + 1) begin : g_ram
            localparam ADDR_W = i < 7 ? 8 + i : i == 7 ? 9 : i == 8 ? 3 : 15;
            localparam W      = i == 7 ? 40 : i < 4 ? 32 : 5;
            reg               write = 1'b0, read = 1'b1;
            reg  [ADDR_W-1:0] write_addr = 0, read_addr = 0;
            reg  [W-1:0]      value = 0;
            wire [W-1:0]      generic, device;
            fp3_ram_registered #(.ADDR_W(ADDR_W), .W(W)) u_generic (.clk_i(clk), .write_i(write),
                .write_addr_i(write_addr), .write_value_i(value), .read_i(read), .read_addr_i(read_addr), .read_value_o(generic));
            ecp5_ram_registered #(.ADDR_W(ADDR_W), .W(W)) u_device (.clk_i(clk), .write_i(write),
                .write_addr_i(write_addr), .write_value_i(value), .read_i(read), .read_addr_i(read_addr), .read_value_o(device));
            // Mostly at either end of the memory, so that what was written is read. Never both at once.
            reg               meet_1 = 1'b1, meet_2 = 1'b1;
            reg  [ADDR_W-1:0] next;
            always @(posedge clk) begin
                next = $random;
                if ($random & 7) next = {next[1], {ADDR_W-3{next[2]}}, next[1:0]};
                write      <= $random;
                read       <= $random | $random;
                write_addr <= next;
                value      <= {$random, $random};
                next = $random;
                if ($random & 7) next = {next[1], {ADDR_W-3{next[2]}}, next[1:0]};
                read_addr  <= next;
                if (read) {meet_2, meet_1} <= {meet_1, write && write_addr == read_addr};
                if (settled && !meet_2) begin
                        if (generic !== device) begin
                        errors <= errors + 1;
                        $display("ram %0d x %0d: %h, generic %h", 1 << ADDR_W, W, device, generic);
                    end
                end
            end
        end
    endgenerate

    always @(negedge clk) if (errors > 0 || cycle == 3000) begin
        $display("%s: %0d cycles, %0d errors", errors == 0 ? "PASS" : "FAIL", cycle, errors);
        $finish;
    end
endmodule
`default_nettype wire
