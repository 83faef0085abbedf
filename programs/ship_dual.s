# ship_dual.s - Equations (1) as in ship_scale.s, the same bits, for a lane that adds and multiplies at once.
#
# Sums are in registers of even number, products in those of odd number, and what the host gives is where its
# partner is not. 14 products and 13 sums a step, a product after a sum and a sum after a product but for one place:
# 14 cycles per object-step.

.state  v = r0  s = r2      # velocity, position
.param  T = r4              # thrust
.param  C = r1  rm = r3     # drag coefficient, 1/m
.shared h                   # time step
.const  sixth 0.16666667    # the FP32 number next to 1/6
.temp   F = r6  t = r8      # force, velocity within the step
.temp   sum = r10           # k1 + 2*k2 + 2*k3 + k4 as far as it is known
.temp   a = r5  k = r7  k1 = r9  p = r11

first:
    mul  p, C, v            # F = T - C*v0
    sub  F, T, p

step:
    mul  a, F, rm           # a = F/m
    mul  k1, h, a           # k1 = h*a
    addh t, v, k1           # F = T - C*(v0 + k1/2)
    mul  p, C, t
    sub  F, T, p
    mul  a, F, rm
    add  sum, k1, -0.0      #     k1, among the sums
    mul  k, h, a            # k2
    addh t, v, k            # F = T - C*(v0 + k2/2)
    mul  p, C, t
    sub  F, T, p
    mul  a, F, rm
    addt sum, sum, k        #     k1 + 2*k2
    mul  k, h, a            # k3
    add  t, v, k            # F = T - C*(v0 + k3)
    mul  p, C, t
    sub  F, T, p
    mul  a, F, rm
    addt sum, sum, k        #     k1 + 2*k2 + 2*k3
    mul  k, h, a            # k4
    add  sum, sum, k
    mul  p, sixth, sum      # v1 = v0 + (k1 + 2*k2 + 2*k3 + k4)/6
    add  v, v, p
    mul  p, C, v            # F = T - C*v0 of the next step
    sub  F, T, p
    mul  k, h, v            # s = s + h*v1
    add  s, s, k
