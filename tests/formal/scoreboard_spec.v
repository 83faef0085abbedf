// scoreboard_spec: the promises of fp3_scoreboard.v, stated for a queue of issued instructions.
//
// An instruction has its operands in the cycle after its issue, and its result `latency` cycles
// later. So `age` cycles after its issue its result is due in latency + 1 - age cycles. A reader
// that issues now has its operands in the next cycle: a result due in 1 is in its unit's result
// register just then; one due in 0 is in the register file in time.
//
// LEMMAS = 1 adds what the induction must know of the scoreboard's registers. No promise needs it.
`default_nettype none
module scoreboard_spec #(
    parameter REG_W       = 5,
    parameter BYPASS      = 1,
    parameter CHAIN       = 1,
    parameter ADD_LATENCY = 1,
    parameter MUL_LATENCY = 1,
    parameter LEMMAS      = 1
) (
    input wire               clk_i,
    input wire               rst_i,
    input wire               issue_i,
    input wire               to_add_i,
    input wire               to_mul_i,
    input wire               to_chain_i,
    input wire               reads_c_i,
    input wire [4*REG_W-1:0] names_i,    // c, b, a, d
    input wire [4*REG_W-1:0] who_i       // four registers, chosen once: the promises are about these
);
    localparam BOTH   = ADD_LATENCY + MUL_LATENCY;
    localparam OLDEST = 1 + (CHAIN != 0 ? BOTH : ADD_LATENCY > MUL_LATENCY ? ADD_LATENCY : MUL_LATENCY);

    wire       blocked, taken, write, write_mul, empty;
    wire [1:0] a_bypass, b_bypass, c_bypass;
    wire [REG_W-1:0] write_d;
    fp3_scoreboard #(.REG_W(REG_W), .BYPASS(BYPASS), .CHAIN(CHAIN),
                 .ADD_LATENCY(ADD_LATENCY), .MUL_LATENCY(MUL_LATENCY)) u_scoreboard (
        .clk_i(clk_i), .rst_i(rst_i), .issue_i(issue_i),
        .to_add_i(to_add_i), .to_mul_i(to_mul_i), .to_chain_i(to_chain_i), .reads_c_i(reads_c_i),
        .d_i(names_i[0 +: REG_W]), .a_i(names_i[REG_W +: REG_W]),
        .b_i(names_i[2*REG_W +: REG_W]), .c_i(names_i[3*REG_W +: REG_W]),
        .blocked_o(blocked), .taken_o(taken),
        .a_bypass_o(a_bypass), .b_bypass_o(b_bypass), .c_bypass_o(c_bypass),
        .write_o(write), .write_mul_o(write_mul), .write_d_o(write_d), .empty_o(empty));

    // What the scheduler does -------------------------------------------------------------------
    reg                 started_q = 1'b0;
    reg [4*REG_W-1:0]   who_q;
    wire                named = to_add_i || to_mul_i || to_chain_i;
    always @(posedge clk_i) {started_q, who_q} <= {1'b1, who_i};
    always @* begin
        assume (started_q ? who_i == who_q : rst_i);
        assume ({2'b00, to_add_i} + {2'b00, to_mul_i} + {2'b00, to_chain_i} <= 3'd1);
        assume (CHAIN != 0 || !to_chain_i);
        assume (!issue_i || (named && !blocked && !taken));
    end

    // The queue: place k is for what issued k cycles ago -----------------------------------------
    reg  [OLDEST:1]  there_q, add_q, mul_q, chain_q;
    reg  [REG_W-1:0] d_q [1:OLDEST];
    integer          k, n, q;
    function due(input [2:0] kind, input integer age, input integer cycles);
        due = (kind[0] && ADD_LATENCY + 1 == age + cycles) || (kind[1] && MUL_LATENCY + 1 == age + cycles)
           || (kind[2] && BOTH + 1 == age + cycles);
    endfunction
    always @(posedge clk_i) begin
        there_q[1] <= issue_i && !rst_i;
        {chain_q[1], mul_q[1], add_q[1]} <= {to_chain_i, to_mul_i, to_add_i};
        d_q[1] <= names_i[0 +: REG_W];
        for (q = 2; q <= OLDEST; q = q + 1) begin
            there_q[q] <= there_q[q-1] && !due({chain_q[q-1], mul_q[q-1], add_q[q-1]}, q - 1, 0) && !rst_i;
            {chain_q[q], mul_q[q], add_q[q]} <= {chain_q[q-1], mul_q[q-1], add_q[q-1]};
            d_q[q] <= d_q[q-1];
        end
    end

    // What follows for this cycle ----------------------------------------------------------------
    reg              writes, writes_mul, meets, later, port;
    reg  [REG_W-1:0] writes_d;
    reg  [3:0]       flying;         // a result for this register is on its way
    reg  [3:0]       early;          // so that an instruction must not name it
    reg  [3:0]       overtaken;      // another for it was issued behind this one too early
    reg  [1:0]       from [0:3];     // the newest: {in the multiplier's, in the adder's result register}
    reg              now, next, mine;
    always @* begin
        {writes, writes_mul, meets, later, port, now, next, mine} = 8'd0;
        {flying, early, overtaken} = 12'd0;
        writes_d = {REG_W{1'b0}};
        for (n = 0; n < 4; n = n + 1) from[n] = 2'b00;
        for (k = OLDEST; k >= 1; k = k - 1) begin             // the youngest is last
            now  = due({chain_q[k], mul_q[k], add_q[k]}, k, 0);
            next = due({chain_q[k], mul_q[k], add_q[k]}, k, 1);
            mine = (to_add_i && due({chain_q[k], mul_q[k], add_q[k]}, k, ADD_LATENCY + 1))
                || (to_mul_i && due({chain_q[k], mul_q[k], add_q[k]}, k, MUL_LATENCY + 1))
                || (to_chain_i && due({chain_q[k], mul_q[k], add_q[k]}, k, BOTH + 1));
            if (there_q[k] && now) begin
                meets      = meets || writes;
                writes     = 1'b1;
                writes_mul = mul_q[k];
                writes_d   = d_q[k];
            end
            if (there_q[k] && !now) later = 1'b1;
            if (there_q[k] && mine) port = 1'b1;
            for (n = 0; n < 4; n = n + 1)
                if (there_q[k] && d_q[k] == who_i[REG_W*n +: REG_W]) begin
                    overtaken[n] = overtaken[n] || flying[n];
                    flying[n]    = BYPASS == 0 || !now;
                    early[n]     = early[n] || BYPASS == 0 || !(now || next);
                    from[n]      = BYPASS != 0 && next ? {mul_q[k], !mul_q[k]} : 2'b00;
                end
        end
    end
    localparam [7:0] OLDEST_8 = OLDEST;
    reg  [7:0] quiet_q;              // cycles without an issue
    always @(posedge clk_i)
        if (rst_i || issue_i)         quiet_q <= rst_i ? OLDEST_8 : 8'd0;
        else if (quiet_q != OLDEST_8) quiet_q <= quiet_q + 8'd1;

    wire about = names_i == who_i;
    always @* if (started_q) begin
        assert (!meets);                                     // one result at most for the write port
        assert (overtaken == 4'd0);                          // no destination is in flight
        assert (write == (writes && !rst_i));
        if (write) assert (write_mul == writes_mul && write_d == writes_d);
        assert (empty == !later);
        // An instruction is refused for these reasons and no others: what may issue does.
        if (about) assert (blocked == (|early[2:0] || (early[3] && reads_c_i)));
        if (named) assert (taken == port);
        if (quiet_q == OLDEST_8) assert (empty && (!about || !blocked) && (!named || !taken));
        // Operands come from where their newest value is.
        if (about && named && !blocked) begin
            assert (a_bypass == from[1] && b_bypass == from[2]);
            if (reads_c_i) assert (c_bypass == from[3]);
        end
    end

    // For the induction: slot s is for the result that is due in s cycles -----------------------
    localparam SLOTS = OLDEST < 3 ? 3 : OLDEST;
    (* hierconn *) wire [SLOTS-1:0]       \u_scoreboard.valid_q ;
    (* hierconn *) wire [SLOTS-1:0]       \u_scoreboard.mul_q ;
    (* hierconn *) wire [(1<<REG_W)-1:0]  \u_scoreboard.busy_q ;
    (* hierconn *) wire [SLOTS*REG_W-1:0] \u_scoreboard.destinations ;
    genvar g;
    generate
        if (LEMMAS != 0) begin : g_lemmas
            for (g = 0; g < 4; g = g + 1) begin : g_busy
                always @* if (started_q) assert (\u_scoreboard.busy_q [who_i[REG_W*g +: REG_W]] == early[g]);
            end
            for (g = 0; g < SLOTS; g = g + 1) begin : g_slot
                reg in, twice, product;
                reg [REG_W-1:0] into;
                integer i;
                always @* begin
                    {in, twice, product} = 3'b000;
                    into = {REG_W{1'b0}};
                    for (i = 1; i <= OLDEST; i = i + 1)
                        if (there_q[i] && due({chain_q[i], mul_q[i], add_q[i]}, i, g))
                            {twice, in, product, into} = {twice || in, 1'b1, mul_q[i], d_q[i]};
                end
                always @* if (started_q) begin
                    assert (\u_scoreboard.valid_q [g] == in && !twice);
                    if (in) assert (\u_scoreboard.mul_q [g] == product
                                    && \u_scoreboard.destinations [REG_W*g +: REG_W] == into);
                end
            end
            for (g = 1; g <= OLDEST; g = g + 1) begin : g_place
                localparam [7:0] AGE = g;
                always @* if (started_q && there_q[g]) begin
                    assert ({2'b00, add_q[g]} + {2'b00, mul_q[g]} + {2'b00, chain_q[g]} == 3'd1);
                    assert (!add_q[g] || g <= ADD_LATENCY + 1);
                    assert (!mul_q[g] || g <= MUL_LATENCY + 1);
                    assert (!chain_q[g] || (CHAIN != 0 && g <= BOTH + 1));
                    assert (quiet_q < AGE);
                end
            end
        end
    endgenerate
endmodule
`default_nettype wire
