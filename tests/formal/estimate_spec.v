// estimate_spec: the estimates of fp3_fp_estimate.v, for every number: each is the largest of its bits that is never too large for a
// number with the same upper bits. So no entry of the table may change.
`default_nettype none
module estimate_spec #(
    parameter CUT    = 0,
    parameter FINITE = 0,
    parameter LEMMAS = 1
) (
    input wire         clk_i,
    input wire         root_i,
    input wire [31:13] a_i
);
    wire [31:13] z, y;                                     // y: of the same number with an exponent that is in the middle
    fp3_fp_estimate #(.CUT(CUT), .FINITE(FINITE)) u_estimate (.clk_i(clk_i), .root_i(root_i), .a_i(a_i), .z_o(z));
    fp3_fp_estimate #(.CUT(CUT), .FINITE(FINITE)) u_middle (.clk_i(clk_i), .root_i(root_i), .a_i({a_i[31], 8'd126, a_i[22:13]}), .z_o(y));
    reg [19:0] late_q, before_q;
    reg [1:0]  age_q = 2'd0;
    always @(posedge clk_i) begin
        {before_q, late_q} <= {late_q, root_i, a_i};
        if (age_q != 2'd2) age_q <= age_q + 1'b1;
    end
    wire         root;
    wire [31:13] a;
    assign {root, a} = CUT != 0 ? before_q : late_q;
    wire [7:0]   e   = a[30:23];
    wire         low = e == 8'd0, top = FINITE == 0 && e == 8'd255, nan = top && a[22:13] != 0;
    localparam [30:13] MOST = FINITE != 0 ? 18'h3ffff : 18'h3fc00;
    wire [31:0]  d   = {21'd0, 1'b1, z[22:13]}, f = a[22:13], g = a[22:14];           // d: 1024 times the estimate's significand
    wire [10:0]  small = {1'b1, y[22:13]} >> (e - 8'd252);
    always @* if (age_q == 2'd2 && !nan) begin
        if (root && (low || (FINITE != 0 && a[31])))     assert (z == {1'b0, MOST});
        else if (root && a[31])                          assert (z == {1'b0, 18'h3fd00});      // a signalling NaN
        else if (!root && low)                           assert (z == {a[31], MOST});
        else if (top)                                    assert (z == {a[31] && !root, 18'd0});
        else if (!root && e >= 8'd253)                   assert (z[31:23] == {a[31], 8'd0} && (FINITE != 0 || z[22:13] == small[9:0]));    // Cell's adder flushes it
        else if (!root) begin                            // d/2 is whole, and y b is at most 1: but not with d/2 + 1
            assert (z[31] == a[31] && z[30:23] == 8'd253 - e && !z[13]);
            assert ((d >> 1) * (f + 1025) <= 32'd1 << 20 && ((d >> 1) + 1) * (f + 1025) > 32'd1 << 20);
        end else begin
            assert (!z[31] && z[30:23] == 8'd190 - ((e + 9'd1) >> 1));
            if (e[0]) assert (!z[13] && (d >> 1) * (d >> 1) * (g + 513) <= 32'd1 << 29 && ((d >> 1) + 1) * ((d >> 1) + 1) * (g + 513) > 32'd1 << 29);
            else      assert (d * d * (g + 513) <= 32'd1 << 30 && (d + 1) * (d + 1) * (g + 513) > 32'd1 << 30);
        end
    end
endmodule
`default_nettype wire
