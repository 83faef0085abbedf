// ecp5_tables_bench: as ecp5_bench, what logarithmic arithmetic uses: products of 18 bits, and tables.
`default_nettype none
`timescale 1ns / 1ps
module ecp5_tables_bench;
`include "gen/lns_curves.vh"
    reg        clk = 1'b0;
    integer    cycle = 0, errors = 0;
    reg [17:0] a = 18'd0, b = 18'd0;
    always #5 clk = !clk;
    // Every address comes up.
    always @(posedge clk) begin
        cycle <= cycle + 1;
        a     <= {$random, cycle[9:0]};
        b     <= $random;
    end

    wire settled = cycle > 8;
    genvar i;
    generate
        for (i = 0; i < 8; i = i + 1) begin : g_multiply
            wire [35:0] generic, device;
            fp3_multiply #(.SIGNED(i / 4), .CUTS(i % 4)) u_generic (.clk_i(clk), .a_i(a), .b_i(b), .p_o(generic));
            ecp5_multiply #(.SIGNED(i / 4), .CUTS(i % 4)) u_device (.clk_i(clk), .a_i(a), .b_i(b), .p_o(device));
            always @(posedge clk) if (settled && generic !== device) begin
                errors = errors + 1;
                $display("multiply SIGNED %0d CUTS %0d: %h, generic %h", i / 4, i % 4, device, generic);
            end
        end

        // Tables of words that do not fill their blocks.
        for (i = 0; i < 2; i = i + 1) begin : g_rom
            localparam W = 53, ADDR_W = 9 + i;
            localparam [(W<<ADDR_W)-1:0] TABLE = {POWERS, LOGS};
            wire [W-1:0] generic, device;
            fp3_rom_registered #(.ADDR_W(ADDR_W), .W(W), .WORDS(TABLE)) u_generic (.clk_i(clk), .at_i(a[ADDR_W-1:0]), .word_o(generic));
            ecp5_rom_registered #(.ADDR_W(ADDR_W), .W(W), .WORDS(TABLE)) u_device (.clk_i(clk), .at_i(a[ADDR_W-1:0]), .word_o(device));
            always @(posedge clk) if (settled && generic !== device) begin
                errors = errors + 1;
                $display("rom %0d x %0d: %h, generic %h", 1 << ADDR_W, W, device, generic);
            end
        end
    endgenerate

    always @(negedge clk) if (errors > 0 || cycle == 3000) begin
        $display("%s: %0d cycles, %0d errors", errors == 0 ? "PASS" : "FAIL", cycle, errors);
        $finish;
    end
endmodule
`default_nettype wire
