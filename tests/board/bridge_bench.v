// bridge_bench: plays a script on the serial line of uart_bridge and writes what comes of it.
//
// +in=FILE   b XX   a byte (hexadecimal, as all numbers)        x XX   a byte whose stop bit is low
//            k N    the line is low for N bits                  g N    ... for N cycles
//            i N    nothing for N cycles                        a 0    until one more answer is whole
// +out=FILE  t XX   a byte from the bridge; w ADDRESS DATA, r ADDRESS DATA: a transfer on the bus, in the order of their ends.
//            The last line is `end`, or says what went wrong.
//
// The slave has 1024 words at 0; an address beyond them is an error. +seed=N chooses how long it waits; 0: it never does.
`default_nettype none
`timescale 1ns/1ps
module bridge_bench;
    parameter DIVISOR  = 4;
    parameter PERMILLE = 1000;         // of a bit's length, as the host has it
    localparam integer CLOCK = 10, TIMEOUT = 600 * 10 * DIVISOR;
    localparam real    HOST_BIT = CLOCK * DIVISOR * PERMILLE / 1000.0;

    reg clk = 1'b0, rst = 1'b1, rxd = 1'b1;
    always #(CLOCK / 2.0) clk = !clk;

    wire        txd, awvalid, wvalid, bready, arvalid, rready;
    wire [23:0] awaddr, araddr;
    wire [31:0] wdata;
    wire [3:0]  wstrb;
    wire [2:0]  awprot, arprot;
    reg         awready = 1'b0, wready = 1'b0, arready = 1'b0, bvalid = 1'b0, rvalid = 1'b0;
    reg  [1:0]  bresp, rresp;
    reg  [31:0] rdata;
    fp3_uart_bridge #(.DIVISOR(DIVISOR), .ADDRESS_W(24)) dut (
        .clk_i(clk), .rst_i(rst), .uart_rxd(rxd), .uart_txd(txd),
        .m_axi_awaddr(awaddr), .m_axi_awprot(awprot), .m_axi_awvalid(awvalid), .m_axi_awready(awready),
        .m_axi_wdata(wdata), .m_axi_wstrb(wstrb), .m_axi_wvalid(wvalid), .m_axi_wready(wready),
        .m_axi_bresp(bresp), .m_axi_bvalid(bvalid), .m_axi_bready(bready),
        .m_axi_araddr(araddr), .m_axi_arprot(arprot), .m_axi_arvalid(arvalid), .m_axi_arready(arready),
        .m_axi_rdata(rdata), .m_axi_rresp(rresp), .m_axi_rvalid(rvalid), .m_axi_rready(rready));

    integer             in, out, got, n, seed, chance, answers = 0, awaited = 0, waited, length = 0;
    reg [8*8-1:0]       op;
    reg [1023:0]        name;
    task stop(input [8*16-1:0] why);
        begin $fwrite(out, "%0s\n", why); $fclose(out); $finish; end
    endtask

    // The slave: each channel waits as it likes -------------------------------------------------------
    reg [31:0]  memory [0:1023];
    reg         aw_q = 1'b0, w_q = 1'b0, ar_q = 1'b0;
    reg [23:0]  aw_to, ar_from;
    reg [31:0]  w_data;
    function likes(input integer unused);
        likes = seed == 0 || $random(chance) % 3 != 0;
    endfunction
    reg  was = 1'b1;                   // most cycles have no transfer, and cost nothing here
    wire is = |{awvalid, wvalid, arvalid, aw_q, w_q, ar_q, bvalid, rvalid};
    always @(posedge clk) was <= is;
    always @(posedge clk) if (is || was) begin
        awready <= likes(0); wready <= likes(0); arready <= likes(0);
        if (awvalid && awready) {aw_q, aw_to} <= {1'b1, awaddr};
        if (wvalid && wready)   {w_q, w_data} <= {1'b1, wdata};
        if (arvalid && arready) {ar_q, ar_from} <= {1'b1, araddr};
        if (wvalid && wstrb !== 4'b1111) stop("strobes");
        if (((awvalid && awready) && aw_q) || ((wvalid && wready) && w_q) || ((arvalid && arready) && ar_q)) stop("two at once");
        if (bvalid && bready) bvalid <= 1'b0;
        else if (aw_q && w_q && !bvalid && likes(0)) begin
            $fwrite(out, "w %h %h\n", aw_to, w_data);
            if (aw_to < 4096) memory[aw_to[11:2]] <= w_data;
            {bvalid, bresp, aw_q, w_q} <= {1'b1, aw_to < 4096 ? 2'b00 : {1'b1, aw_to[2]}, 2'b00};
        end else if (!bvalid) bresp <= 2'bxx;
        if (rvalid && rready) rvalid <= 1'b0;
        else if (ar_q && !rvalid && likes(0)) begin
            $fwrite(out, "r %h %h\n", ar_from, ar_from < 4096 ? memory[ar_from[11:2]] : 32'd0);
            rdata <= ar_from < 4096 ? memory[ar_from[11:2]] : 32'd0;
            {rvalid, rresp, ar_q} <= {1'b1, ar_from < 4096 ? 2'b00 : {1'b1, ar_from[2]}, 1'b0};
        end else if (!rvalid) {rresp, rdata} <= 34'dx;
    end
    // What stands until it is taken has to stand still.
    reg         aw_held = 1'b0, w_held = 1'b0, ar_held = 1'b0;
    reg [23:0]  aw_was, ar_was;
    reg [31:0]  w_was;
    always @(posedge clk) if (is || was) begin
        {aw_held, w_held, ar_held} <= {awvalid && !awready, wvalid && !wready, arvalid && !arready};
        {aw_was, w_was, ar_was} <= {awaddr, wdata, araddr};
        if ((aw_held && !(awvalid && awaddr === aw_was)) || (w_held && !(wvalid && wdata === w_was)) ||
            (ar_held && !(arvalid && araddr === ar_was))) stop("moved");
    end

    // The line from the bridge, bit for bit -----------------------------------------------------------
    reg [7:0] heard;
    integer   k;
    initial forever begin
        @(negedge txd);
        #(HOST_BIT / 2);
        if (txd) stop("glitch");
        for (k = 0; k < 8; k = k + 1) begin #(HOST_BIT) heard[k] = txd; end
        #(HOST_BIT);
        if (txd !== 1'b1) stop("no stop bit");
        if (^heard === 1'bx) stop("unknown bits");
        $fwrite(out, "t %h\n", heard);
        if (heard != 8'hc0) length = length + 1;
        else if (length > 0) begin answers = answers + 1; length = 0; end
    end

    // The script --------------------------------------------------------------------------------------
    task send(input [7:0] value, input last);
        begin
            rxd = 1'b0; #(HOST_BIT);
            for (got = 0; got < 8; got = got + 1) begin rxd = value[got]; #(HOST_BIT); end
            rxd = last; #(HOST_BIT);
            if (!last) begin rxd = 1'b1; #(HOST_BIT); end
        end
    endtask
    initial begin
        if (!$value$plusargs("in=%s", name)) $finish;
        in = $fopen(name, "r");
        if (!$value$plusargs("out=%s", name)) $finish;
        out = $fopen(name, "w");
        if (!$value$plusargs("seed=%d", seed)) seed = 0;
        chance = seed;
        for (n = 0; n < 1024; n = n + 1) memory[n] = 32'd0;
        #(5 * CLOCK) rst = 1'b0;
        #(HOST_BIT + 3.7);
        while ($fscanf(in, "%s %h\n", op, n) == 2)
            case (op)
            "b": send(n[7:0], 1'b1);
            "x": send(n[7:0], 1'b0);
            "k": begin rxd = 1'b0; #(n * HOST_BIT) rxd = 1'b1; #(HOST_BIT); end
            "g": begin rxd = 1'b0; #(n * CLOCK) rxd = 1'b1; #(HOST_BIT); end
            "i": #(n * CLOCK);
            "a": begin
                awaited = awaited + 1;
                for (waited = 0; answers < awaited && waited < TIMEOUT; waited = waited + 1) @(posedge clk);
                if (answers < awaited) stop("no answer");
            end
            default: stop("bad script");
            endcase
        #(60 * HOST_BIT);
        stop("end");
    end
endmodule
`default_nettype wire
