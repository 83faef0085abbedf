// SPDX-License-Identifier: Apache-2.0
// access.vh: the bundle ACCESS, an access of the host, which goes from lane to lane.
// front/decoded.vh shows how a bundle is used.
//
//     valid, write
//     space                       lane_host.vh
//     lane                        which lane; not for constants, which all lanes have
//     address                     a word of the space
//     whole                       of a record: all 32 bits, with STORAGE
`define FP3_ACCESS_W (6 + LANE_W + STORE_W)
`define FP3_ACCESS_FIELDS \
    wire access_valid, access_write, access_whole; \
    wire [2:0] access_space; \
    wire [LANE_W-1:0] access_lane; \
    wire [STORE_W-1:0] access_address;
`define FP3_ACCESS {access_valid, access_write, access_whole, access_space, access_lane, access_address}
