// ice40_bench: each version of rtl/fpga/ice40 beside the generic one, which it must equal in every cycle.
//
// The test gives these versions other names: ice40_ before theirs.
`default_nettype none
`timescale 1ns / 1ps
module ice40_bench;
    reg     clk = 1'b0;
    integer cycle = 0, errors = 0;
    always #5 clk = !clk;
    always @(posedge clk) cycle <= cycle + 1;
    wire settled = cycle > 8;          // registers fill, and words that were read early are x

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
    always @(posedge clk) if (cycle < 150) begin       // the model of a multiplier is slow
        a <= significand($random & 7);
        b <= significand($random & 7);
    end
    genvar i;
    generate
        for (i = 0; i < 6; i = i + 1) begin : g_product
            localparam       FRAC = i < 4 ? 23 : i == 4 ? 16 : 20;
            localparam [3:0] CUTS = 5 * i;
            wire [2*FRAC+1:0] generic, device;
            fp3_fp_mul_product #(.FRAC(FRAC), .CUTS(CUTS)) u_generic (.clk_i(clk),
                .a_i(a[FRAC:0]), .b_i(b[FRAC:0]), .p_o(generic));
            ice40_fp_mul_product #(.FRAC(FRAC), .CUTS(CUTS)) u_device (.clk_i(clk),
                .a_i(a[FRAC:0]), .b_i(b[FRAC:0]), .p_o(device));
            always @(posedge clk) if (settled && generic !== device) begin
                errors = errors + 1;
                $display("product FRAC %0d CUTS %b: %h, generic %h", FRAC, CUTS, device, generic);
            end
        end

        // Few addresses, so that most reads meet a write, and one of many words.
        for (i = 0; i < 2; i = i + 1) begin : g_ram
            localparam ADDR_W = i == 0 ? 2 : 8;
            reg               write = 1'b0;
            reg  [ADDR_W-1:0] write_addr = 0, read_addr = 0;
            reg  [31:0]       value = 0;
            wire [31:0]       generic, device;
            fp3_ram_forward #(.ADDR_W(ADDR_W)) u_generic (.clk_i(clk), .write_i(write), .write_addr_i(write_addr),
                .write_value_i(value), .read_addr_i(read_addr), .read_value_o(generic));
            ice40_ram_forward #(.ADDR_W(ADDR_W)) u_device (.clk_i(clk), .write_i(write), .write_addr_i(write_addr),
                .write_value_i(value), .read_addr_i(read_addr), .read_value_o(device));
            always @(posedge clk) begin
                {write, value} <= {$random, $random};
                write_addr     <= $random & 3;
                read_addr      <= $random & 3;
                if (settled && generic !== device) begin
                    errors = errors + 1;
                    $display("ram of %0d: %h, generic %h", 1 << ADDR_W, device, generic);
                end
            end
        end
    endgenerate

    // Counters whose events are many, few or none; two of them are just below 2^32 and 2^40 after the first clear.
    localparam N = 12;
    reg          clear = 1'b1, read = 1'b0, high = 1'b0, shown = 1'b0;
    reg  [N-1:0] events = 0;
    reg  [3:0]   index = 0;
    integer      age = -2000;          // cycles since the last clear: the busy counters carry after 256
    wire [31:0]  generic, device;
    fp3_counters #(.N(N)) u_generic (.clk_i(clk), .clear_i(clear), .event_i(events),
        .read_i(read), .index_i(index), .high_i(high), .value_o(generic));
    ice40_counters #(.N(N)) u_device (.clk_i(clk), .clear_i(clear), .event_i(events),
        .read_i(read), .index_i(index), .high_i(high), .value_o(device));
    always @(posedge clk) begin
        age    <= clear && cycle > 4 ? 0 : age + 1;
        clear  <= cycle < 4 || (age > 256 && $random % 8 == 0);
        events <= {8'hff, 4'd0} | ($random & 12'h00f & $random);
        read   <= !read && ($random & 3) == 0;
        index  <= $unsigned($random) % N;
        high   <= $random;
        if (cycle == 20) begin
            u_generic.g_counter[4].count_q  <= 48'h0000_ffff_fff0;
            u_device.memory[4]              <= 40'h00ff_ffff;
            u_device.g_counter[4].g_some.low_q <= 8'hf0;
            u_generic.g_counter[5].count_q  <= 48'h00ff_ffff_ff80;
            u_device.memory[5]              <= 40'hffff_ffff;
            u_device.g_counter[5].g_some.low_q <= 8'h80;
            u_device.fresh_q                <= u_device.fresh_q & ~12'h030;
        end
        shown  <= read;
        if (cycle > 24 && shown && generic !== device) begin
            errors = errors + 1;
            $display("cycle %0d: count %h, generic %h", cycle, device, generic);
        end
    end

    always @(posedge clk) if (errors > 20 || cycle == 5000) begin
        $display("%0s: %0d cycles, %0d errors", errors == 0 ? "PASS" : "FAIL", cycle, errors);
        $finish;
    end
endmodule
`default_nettype wire
