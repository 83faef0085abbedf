// axi_drawn: a master that makes the transfers of docs/drawings/axi_write.wave and axi_read.wave, and prints every cycle of them.
//
// Use       iverilog -g2012 -s axi_drawn -c rtl/fp3.f tests/docs/axi_drawn.v build/rtl/fp3_single.v, then vvp; +waves=FILE.fst for a viewer.
// Output    A line for each cycle, with the values that both sides see at its end: the part, awvalid, awready, awaddr, wvalid,
//           wready, wdata, bvalid, bready, bresp, arvalid, arready, araddr, rvalid, rready, rdata, rresp; numbers hexadecimal.
`default_nettype none
`timescale 1ns/1ps
module axi_drawn;
`include "gen/registers.vh"
    localparam [17:0] NOWHERE = 18'h00064, OBJECTS = 18'h20000;
    reg         clk = 1'b0, rst = 1'b1;
    reg         awvalid = 1'b0, wvalid = 1'b0, arvalid = 1'b0, bready = 1'b1, rready = 1'b1;
    reg  [17:0] awaddr = 18'd0, araddr = 18'd0;
    reg  [31:0] wdata = 32'd0;
    wire        awready, wready, bvalid, arready, rvalid, irq;
    wire [1:0]  bresp, rresp;
    wire [31:0] rdata;
    reg  [8*8-1:0] part = "";
    always #5 clk = !clk;

    fp3_single dut (
        .s_axi_aclk(clk), .s_axi_aresetn(!rst),
        .s_axi_awaddr(awaddr), .s_axi_awprot(3'b000), .s_axi_awvalid(awvalid), .s_axi_awready(awready),
        .s_axi_wdata(wdata), .s_axi_wstrb(4'b1111), .s_axi_wvalid(wvalid), .s_axi_wready(wready),
        .s_axi_bresp(bresp), .s_axi_bvalid(bvalid), .s_axi_bready(bready),
        .s_axi_araddr(araddr), .s_axi_arprot(3'b000), .s_axi_arvalid(arvalid), .s_axi_arready(arready),
        .s_axi_rdata(rdata), .s_axi_rresp(rresp), .s_axi_rvalid(rvalid), .s_axi_rready(rready),
        .irq(irq));

    always @(posedge clk)
        if (part != "")
            $display("%0s %b %b %h %b %b %h %b %b %h %b %b %h %b %b %h %h", part, awvalid, awready, awaddr, wvalid, wready, wdata,
                     bvalid, bready, bresp, arvalid, arready, araddr, rvalid, rready, rdata, rresp);

    // Address and data together; the next one when this one is answered.
    task write(input [17:0] address, input [31:0] data);
        begin
            {awvalid, awaddr, wvalid, wdata} <= {1'b1, address, 1'b1, data};
            @(posedge clk);
            while (awvalid && !awready) @(posedge clk);
            {awvalid, wvalid} <= 2'b00;
            while (!bvalid) @(posedge clk);
        end
    endtask

    // The next address as soon as this one is taken.
    task read(input [17:0] address);
        begin
            {arvalid, araddr} <= {1'b1, address};
            @(posedge clk);
            while (!arready) @(posedge clk);
        end
    endtask

    reg [8*256-1:0] waves;
    initial begin
        if ($value$plusargs("waves=%s", waves)) begin
            $dumpfile(waves);
            $dumpvars(0, axi_drawn);
        end
        repeat (4) @(posedge clk);
        rst <= 1'b0;
        repeat (8) @(posedge clk);
        write(OBJECTS, 32'd5);
        write(OBJECTS + 18'd4, 32'd6);
        @(posedge clk);
        part <= "write";
        @(posedge clk);
        write({2'd0, ADDR_STEPS}, 32'd3);
        write({2'd0, ADDR_ID}, 32'd7);
        @(posedge clk);
        part <= "";
        repeat (20) @(posedge clk);
        part <= "read";
        @(posedge clk);
        read(OBJECTS);
        read(OBJECTS + 18'd4);
        read(NOWHERE);
        arvalid <= 1'b0;
        repeat (16) @(posedge clk);
        $finish;
    end
endmodule
`default_nettype wire
