# SPDX-License-Identifier: Apache-2.0
create_clock -name s_axi_aclk -period 10.000 [get_ports s_axi_aclk]
