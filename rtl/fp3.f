// SPDX-License-Identifier: Apache-2.0
// The design for Verilator (-f) and Icarus (-c), from the project's directory.
// One module per file: a module's name is enough to find it.
// Memories are zero at power-up, and the top of a configuration has the ports of the trace. Synthesis
// defines neither.
+define+FP3_ZEROS
+define+FP3_TRACE
+incdir+rtl
+incdir+rtl/gen
-y rtl
-y rtl/bus
-y rtl/config
-y rtl/fp
-y rtl/front
-y rtl/host
-y rtl/lane
-y rtl/lib
-y rtl/lns
-y rtl/sequence
-y rtl/solo
-y rtl/unit
+libext+.v
