// SPDX-License-Identifier: Apache-2.0
// fp3_crc32: one byte more in a CRC-32 (IEEE 802.3, clause 3.2.9, bits reflected: zlib's crc32).
//
// Purpose   The check of a packet. A CRC begins with all ones; its complement is sent, low
//           byte first.
// Latency   0
// Promise   Over a message and its CRC, the result is 32'hdebb20e3 if both are whole.
`default_nettype none
module fp3_crc32 (
    input  wire [31:0] crc_i,
    input  wire [7:0]  byte_i,
    output reg  [31:0] crc_o
);
    integer k;
    always @* begin
        crc_o = crc_i ^ {24'd0, byte_i};
        for (k = 0; k < 8; k = k + 1) crc_o = {1'b0, crc_o[31:1]} ^ (crc_o[0] ? 32'hedb88320 : 32'd0);
    end
endmodule
`default_nettype wire
