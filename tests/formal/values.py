"""What becomes of numbers beside adder and multiplier, for every operand: rounding to whole numbers and to 16 bits, exponents, estimates."""

from subject import Subject

CUT, UNCUT = {"CUT": 1, "NEAREST": 1}, {"CUT": 0, "NEAREST": 1}
IEEE, CELL = {"CUT": 1, "FINITE": 0}, {"CUT": 1, "FINITE": 1}
HALF, BFLOAT = {"STORAGE": 2}, {"STORAGE": 1}

RINT = Subject("rint_spec", ("fp3_fp_rint.v", "fp3_cut.v", "gen/isa.vh"), "cut {CUT}, nearest {NEAREST}",
               [{"CUT": cut, "NEAREST": nearest} for cut in (0, 1) for nearest in (0, 1)], [
        ("a tie goes up", "guard && (rest || odd)", "guard", CUT),
        ("a tie goes down", "guard && (rest || odd)", "guard && rest", CUT),
        ("a half and a bit stay below", "half_q ? behind_q : {1'b0, behind_q[22:1]}", "{1'b0, behind_q[22:1]}", CUT),
        ("a whole number has a fraction", "behind_q[i] <= e < WHOLE - i[7:0]", "behind_q[i] <= e <= WHOLE - i[7:0]", CUT),
        ("0.5 counts as less", "half_q  <= e == ONE - 8'd1", "half_q  <= 1'b0", CUT),
        ("a quarter goes up", "(!small_q && |(a_q[22:0] & first))", "|(a_q[22:0] & first)", CUT),
        ("the sign of a zero is lost", "{kept_c[31], small_c", "{kept_c[31] && !(small_c && !up_c), small_c", CUT),
        ("no carry into the exponent", "kept_c[30:0] + (up_c", "{kept_c[30:23], 23'd0} | kept_c[22:0] + (up_c", CUT),
    ], depth=3, cycles=4)

EXPONENT = Subject("exponent_spec", ("fp3_fp_exponent.v", "fp3_cut.v", "fp3_lzc.v"), "cut {CUT}, finite {FINITE}",
                   [{"CUT": cut, "FINITE": finite} for cut in (0, 1) for finite in (0, 1)], [
        ("2^128 is a number", "n_q[7] && (FINITE == 0 || |n_q[6:0])", "n_q[7] && |n_q[6:0]", IEEE),
        ("2^128 is none, without infinities", "n_q[7] && (FINITE == 0 || |n_q[6:0])", "n_q[7]", CELL),
        ("2^-127 is nothing", "is_low && !over_q && below[7:5]", "is_low && !over_q && |below[4:0] && below[7:5]", IEEE),
        ("2^-149 is twice that", "tiny_c} << (5'd22 - place_c)", "tiny_c} << (5'd23 - place_c)", IEEE),
        ("a fraction counts", "is_less ? 8'd0 : shifted", "shifted", IEEE),
        ("what is too large is small", "over_q  <= e > 8'd134", "over_q  <= 1'b0", IEEE),
        ("negative powers are positive", "minus_q <= a_i[31]", "minus_q <= 1'b0", IEEE),
        ("the exponent of 1 is not 0", "&zeros ? 8'd0", "1'b0 ? 8'd0", IEEE),
        ("the exponent of 0 is a number", "|| e == 8'd0", "", IEEE),
        ("a fraction without its bits", "n_q[5:0] << zeros", "n_q[5:0] << 1", IEEE),
        ("exponents have no sign", "log_q && minus_q, !log_q", "1'b0, !log_q", IEEE),
        ("the largest number is not all ones", "{23{most_c}}", "{23{1'b0}}", CELL),
    ], depth=3, cycles=4)

ESTIMATE = Subject("estimate_spec", ("fp3_fp_estimate.v", "fp3_cut.v", "gen/estimates.vh"), "cut {CUT}, finite {FINITE}",
                   [{"CUT": cut, "FINITE": finite} for cut in (0, 1) for finite in (0, 1)], [
        ("the reciprocal's entry for a root", "words[{root_i, root_i ?", "words[{1'b0, root_i ?", IEEE),
        ("one entry is one more", "word_q <= words[", "word_q <= (a_i[22:13] == 10'd300) + words[", IEEE),
        ("another entry is one less", "word_q <= words[", "word_q <= words[{root_i, root_i ? a_i[23:14] : a_i[22:13]}] == 9'h0d4 ? 9'h0d3 : words[", IEEE),
        ("an even exponent is odd", "late_q  <= !e[0];", "late_q  <= 1'b0;", IEEE),
        ("an exponent is one more", "8'd253 - e;", "8'd254 - e;", IEEE),
        ("the exponent of a root ends downwards", "{1'b0, e[7:1]} - {7'd0, e[0]}", "{1'b0, e[7:1]}", IEEE),
        ("1/2^127 is 1/2^126", "late_q  <= high && !e[0]", "late_q  <= 1'b0", IEEE),
        ("1/2^126 has no leading 1", "small_q <= high", "small_q <= 1'b0", IEEE),
        ("1/-0 is positive", "sign_q  <= sign;", "sign_q  <= sign && !low;", IEEE),
        ("the root of a negative number is one", "known_q <= !low && !sign && !top", "known_q <= !low && !top", IEEE),
        ("1/infinity is small", "known_q <= !low && !top;", "known_q <= !low;", IEEE),
        ("1/0 is infinite, without infinities", "nan_q   <= FINITE != 0 && low", "nan_q   <= 1'b0", CELL),
    ], depth=3, cycles=4)

NARROW = Subject("narrow_spec", ("fp3_narrow.v", "fp3_widen.v", "fp3_lzc.v", "fp3_shift_right_sticky.v"), "storage {STORAGE}",
                 [BFLOAT, HALF], [
        ("ties go up", "{15'd0, word_q[16] || more_q}", "16'd1", HALF),
        ("ties go down", "{15'd0, word_q[16] || more_q}", "16'd0", BFLOAT),
        ("what is beyond the first 16 bits does not count", "word_q[16] || more_q", "word_q[16]", HALF),
        ("a draw is one too large", "draws_i ? random_i", "draws_i ? random_i + 1'b1", HALF),
        ("nothing is drawn", "draws_i ? random_i :", "", BFLOAT),
        ("a subnormal word a place too high", "LEAST - word_i[30:23]", "LEAST - 1'b1 - word_i[30:23]", HALF),
        ("subnormal words are normal", "is_small = word_i[30:23] < LEAST", "is_small = 1'b0", HALF),
        ("2^16 is a number", "word_i[30:23] >= ABOVE", "word_i[30:23] > ABOVE", HALF),
        ("what is far below is not", "|distance[7:5] ? 5'd31 : distance[4:0]", "distance[4:0]", HALF),
        ("a NaN is another one", "is_nan_q ? NAN", "1'b0 ? NAN", BFLOAT),
        ("an infinity overflows", "over_q <= !is_out_q &&", "over_q <=", BFLOAT),
        ("an overflow is none", "over_q <= !is_out_q && &sum[30 -: EXPONENT_W]", "over_q <= 1'b0", HALF),
        ("the sign is lost", "narrow_q <= is_nan_q ? NAN : {sign_q,", "narrow_q <= is_nan_q ? NAN : {1'b0,", HALF),
    ], depth=3, cycles=4)

WIDEN = NARROW._replace(sources=("fp3_widen.v", "fp3_narrow.v", "fp3_lzc.v", "fp3_shift_right_sticky.v"), shapes=[], bugs=[
    ("a subnormal word is read a place too low", "narrow_i[9:0] << (zeros + 4'd1)", "narrow_i[9:0] << zeros", HALF),
    ("... and with the exponent of another", "8'd112 - {4'd0, zeros}", "8'd113 - {4'd0, zeros}", HALF),
    ("an infinity is read as 2^16", "is_out ? 8'd255 :", "", HALF),
    ("0 is read as 2^-24", "is_small && is_none ? 8'd0 : exponent", "exponent", HALF),
    ("bfloat16 loses its last bit", "{narrow_i, 16'd0}", "{narrow_i[15:1], 17'd0}", BFLOAT),
])

SUBJECTS = [RINT, EXPONENT, ESTIMATE, NARROW, WIDEN]
