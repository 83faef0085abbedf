# ship_scale.s - Equations (1) as in ship_madd.s, the same bits, with 14 multiplications a step.
#
# Half of k and twice k ride on the addition that needs them: addh, addt round the half or the double as a
# mul with 0.5 or 2.0 does, and then the sum. 20 instructions, of which 6 only add.

.state  v s                 # velocity, position
.param  T C rm              # thrust, drag coefficient, 1/m
.shared h                   # time step
.const  sixth 0.16666667    # the FP32 number next to 1/6
.temp   k1 k2 k3 k4
.temp   t F a               # velocity, force, acceleration
.temp   sum                 # k1 + 2*k2 + 2*k3 + k4 as far as it is known

first:
    msub F, C, v, T         # F = T - C*v0

step:
    mul  a, F, rm           # a = F/m
    mul  k1, h, a           # k1 = h*a

    addh t, v, k1           # F = T - C*(v0 + k1/2)
    msub F, C, t, T
    mul  a, F, rm           # a = F/m
    mul  k2, h, a           # k2 = h*a

    addh t, v, k2           # F = T - C*(v0 + k2/2)
    addt sum, k1, k2        #     k1 + 2*k2
    msub F, C, t, T
    mul  a, F, rm           # a = F/m
    mul  k3, h, a           # k3 = h*a

    add  t, v, k3           # F = T - C*(v0 + k3)
    msub F, C, t, T
    addt sum, sum, k3       #     k1 + 2*k2 + 2*k3
    mul  a, F, rm           # a = F/m
    mul  k4, h, a           # k4 = h*a

    add  sum, sum, k4       # v1 = v0 + (k1 + 2*k2 + 2*k3 + k4)/6
    madd v, sixth, sum, v
    msub F, C, v, T         # F = T - C*v0 of the next step
    madd s, h, v, s         #     s = s + h*v1
