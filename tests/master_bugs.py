"""Bugs of the master of AXI4, file by file: (name, right, wrong). Its bench (tests/modules/master_bench.py) must see each, and so must the proof of
the file's module, where there is one (tests/formal/control.py). `right` is in the file once."""

BUGS = {
    "fp3_bursts.v": [
        ("a burst crosses 4 KB", "ends ? left_q[7:0] - 8'd1 : up", "ends ? left_q[7:0] - 8'd1 : 8'd255"),
        ("an address that does not stand", "else if (valid_q)              valid_q <= !ready_i;", "else if (valid_q)              valid_q <= 1'b0;"),
        ("a range of a multiple of 1 KB has a burst more", "left_q <= {{WORDS_W-8{1'b0}}, up}", "left_q < {{WORDS_W-8{1'b0}}, up}"),
        ("an error does not end a range", "else if (stop_i && !valid_q)   left_q", "else if (1'b0)   left_q"),
    ],
    "fp3_transfer.v": [
        ("a word that the processor does not take is lost", "(!full_q || failed || asked)", "1'b1"),
        ("a word is moved twice", "(full_q && !asked && !failed)", "(full_q && (!asked || owed_q == 10'd3) && !failed)"),
        ("a word for memory is lost", "(waits || failed) && (!sends_q || wready_i)", "(waits || failed)"),
        ("words that were refused are written", "{waiting, !failed,", "{waiting, 1'b1,"),
        ("a word that could not be read is moved", "req_valid_o = busy_q && !failed &&", "req_valid_o = busy_q &&"),
        ("over before memory has said so", "&& bursts_q == {BURSTS_W+1{1'b0}}", ""),
        ("over before the processor has said so", "&& open_i == {OPEN_W{1'b0}};", ";"),
        ("a run's end is not waited for", "wait_q ? waited_q :", "wait_q ? 1'b1 :"),
        ("however a run ends, the list goes on", "(comes && answer_rdata_i !=", "(comes && 1'b0 && answer_rdata_i !="),
        ("what is not possible is done", "wrong_q <= wrong_q || |rdata_i[31:WORDS_W];", "wrong_q <= wrong_q;"),
        ("nothing of a place is left out", "skip_q & {6{run_ends}}", "6'd0"),
        ("after the first run of words no other one", "run_ends ? run_q : run_left_q - 6'd1", "run_left_q - 6'd1"),
        ("an error is told as if nothing was left out", "skip_q & {6{due_ends}}", "6'd0"),
        ("a part is made once more", "again_q ? again_left_q : words_q", "again_q ? again_left_q : words_q + 1'b1"),
        ("a part within a part", "again_q && again_at_q != next_q", "1'b0"),
        ("a list ends before its part is made again", "fetch || back ||", "fetch ||"),
        ("after an error a part is still under way", "if (start || repeats) again_q", "if (repeats) again_q"),
        ("an error of memory's is none", "bad    = (reads && rerror_i) || (closes && berror_i)", "bad    = reads && rerror_i"),
        ("the first burst for all", "else if (closes)  oldest_q", "else if (closes && rst_i)  oldest_q"),
        ("the last word of a burst is not said", "&memory_q[9:2] || words_q", "words_q"),
        ("a list wraps within 1 KB", "next_q <= first + 30'd4;", "next_q <= {first[31:10], first[9:2] + 8'd4};"),
    ],
    "fp3_master.v": [
        ("all addresses wrap", "|bytes[31:ADDRESS_W] ? NOWHERE :", "1'b0 ? NOWHERE :"),
        ("the host gets the answers of a transfer", "(read_i && !moves)", "read_i"),
    ],
    "fp3_turns.v": [
        ("turns change with requests under way", "turns = other && still && (spent || !owner)", "turns = other && (spent || !owner)"),
        ("the host waits for the end", "made_q[TURN_W] && other", "made_q[TURN_W] && other && !moves_q"),
        ("what is alone streams", "(move_streams_i ? !alone_q : still)", "1'b1"),
        ("soon after one that was alone", "&& rest_q == 3'd0;", ";"),
        ("a write and a read answered at once are one", "wrote_i} - {{OPEN_W-1{1'b0}}, read_i};", "wrote_i || read_i};"),
    ],
}
