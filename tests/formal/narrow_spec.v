// narrow_spec: fp3_narrow.v and fp3_widen.v against the numbers that their bits mean, for every word, every random number and every
// narrow word. Magnitudes of binary16 are compared in units of 2^-63, those of bfloat16 as integers, as their bits are ordered.
`default_nettype none
module narrow_spec #(
    parameter STORAGE = 1,
    parameter LEMMAS  = 1
) (
    input wire        clk_i,
    input wire [31:0] word_i,
    input wire        draws_i,
    input wire [15:0] random_i,
    input wire [15:0] half_i
);
    wire [15:0] narrow;
    wire        over;
    wire [31:0] wide;
    fp3_narrow #(.STORAGE(STORAGE)) u_narrow (.clk_i(clk_i), .word_i(word_i), .draws_i(draws_i), .random_i(random_i), .narrow_o(narrow), .over_o(over));
    fp3_widen #(.STORAGE(STORAGE)) u_widen (.narrow_i(half_i), .word_o(wide));

    reg [31:0] late_q, word_q;                             // that of the narrow word
    reg        draws_q;
    reg [15:0] random_q;
    reg [1:0]  age_q = 2'd0;
    always @(posedge clk_i) begin
        {word_q, late_q}     <= {late_q, word_i};
        {draws_q, random_q}  <= {draws_i, random_i};
        if (age_q != 2'd2) age_q <= age_q + 1'b1;
    end
    wire is_nan = word_q[30:0] > 31'h7f800000, is_out = word_q[30:0] == 31'h7f800000;

    localparam W = 82;
    // Of a float below 2^16, and of a narrow word; the first below 2^-64 is 0 here, and less than any draw
    function [W-1:0] of_word(input [30:0] word);
        of_word = word[30:23] < 8'd64 ? 0 : word[30:23] < 8'd87 ? {{W-24{1'b0}}, 1'b1, word[22:0]} >> (8'd87 - word[30:23])
                                          : {{W-24{1'b0}}, 1'b1, word[22:0]} << (word[30:23] - 8'd87);
    endfunction
    function [W-1:0] of_half(input [14:0] half);
        of_half = {{W-11{1'b0}}, half[14:10] != 0, half[9:0]} << ((half[14:10] == 0 ? 0 : half[14:10] - 1) + 39);
    endfunction
    wire [W-1:0] x     = STORAGE == 1 ? word_q[30:0] : of_word(word_q[30:0]);
    wire [14:0]  next  = narrow[14:0] + 1'b1, last = narrow[14:0] - 1'b1;
    wire [W-1:0] here  = STORAGE == 1 ? {narrow[14:0], 16'd0} : of_half(narrow[14:0]);
    wire [W-1:0] above = STORAGE == 1 ? {next, 16'd0} : of_half(next), below = STORAGE == 1 ? {last, 16'd0} : of_half(last);
    wire         large = STORAGE == 2 && word_q[30:23] >= 8'd143;        // 2^16 and more
    localparam [14:0] INFINITE = STORAGE == 1 ? 15'h7f80 : 15'h7c00;
    // The number that is not above x, and by how much of the distance to the next one x is more: in 2^-16 of it
    wire [14:0]  floor = here > x ? last : narrow[14:0];
    wire [W-1:0] under = STORAGE == 1 ? {floor, 16'd0} : of_half(floor);
    wire [4:0]   place = floor[14:10] == 0 ? 5'd0 : floor[14:10] - 1'b1;
    wire [W-1:0] part  = (x - under) >> (STORAGE == 1 ? 0 : 23 + place);
    always @* if (age_q == 2'd2) begin
        if (is_nan) assert (narrow == (STORAGE == 1 ? 16'h7fc0 : 16'h7e00));
        else        assert (narrow[15] == word_q[31]);
        if (is_out || (!is_nan && large)) assert (narrow[14:0] == INFINITE);
        else if (!is_nan) begin
            assert (narrow[14:0] <= INFINITE);
            if (draws_q) begin             // one of the two beside it; the upper one as often as the part says
                assert (under <= x && (narrow[14:0] == floor || (narrow[14:0] == floor + 1'b1)));
                assert ((narrow[14:0] != floor) == (part[15:0] + {1'b0, random_q} > 17'h0ffff));
            end else begin                 // the nearest; of two equally near the even one
                if (x >= here) assert (x - here < above - x || (x - here == above - x && !narrow[0]));
                else           assert (here - x < x - below || (here - x == x - below && !narrow[0]));
            end
        end
        assert (over == (!is_nan && !is_out && narrow[14:0] == INFINITE));
    end
    // Exact, NaNs and infinities too
    always @* begin
        assert (wide[31] == half_i[15]);
        if (STORAGE == 1)                assert (wide == {half_i, 16'd0});
        else if (half_i[14:10] == 5'd31) assert (wide[30:0] == {8'd255, half_i[9:0], 13'd0});
        else if (half_i[14:0] == 0)      assert (wide[30:0] == 0);
        else                             assert (wide[30:23] >= 8'd87 && wide[30:23] < 8'd143 && of_word(wide[30:0]) == of_half(half_i[14:0]));
    end
endmodule
`default_nettype wire
