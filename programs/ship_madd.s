# ship_madd.s - Equations (1) as in ship.s, the same bits, in 20 instructions a step.
#
# madd and msub round the product and then the sum, as a mul and an add or sub do, so every one of
# the 30 operations is still there: 10 of the 12 additions are the second half of a madd or msub. As in
# ship.s, a step ends with what the next one waits for: its F(v0) = T - C*v0.

.state  v s                 # velocity, position
.param  T C rm              # thrust, drag coefficient, 1/m
.shared h                   # time step
.const  half 0.5
.const  two 2.0
.const  sixth 0.16666667    # the FP32 number next to 1/6
.temp   k1 k2 k3 k4
.temp   t F a               # velocity, force, acceleration
.temp   sum                 # k1 + 2*k2 + 2*k3 + k4 as far as it is known

first:
    msub F, C, v, T         # F = T - C*v0

step:
    mul  a, F, rm           # a = F/m
    mul  k1, h, a           # k1 = h*a

    madd t, half, k1, v     # F = T - C*(v0 + k1/2)
    msub F, C, t, T
    mul  a, F, rm           # a = F/m
    mul  k2, h, a           # k2 = h*a

    madd t, half, k2, v     # F = T - C*(v0 + k2/2)
    madd sum, two, k2, k1   #     k1 + 2*k2, while t is on its way
    msub F, C, t, T
    mul  a, F, rm           # a = F/m
    mul  k3, h, a           # k3 = h*a

    add  t, v, k3           # F = T - C*(v0 + k3)
    msub F, C, t, T
    madd sum, two, k3, sum  #     k1 + 2*k2 + 2*k3
    mul  a, F, rm           # a = F/m
    mul  k4, h, a           # k4 = h*a

    add  sum, sum, k4       # v1 = v0 + (k1 + 2*k2 + 2*k3 + k4)/6
    madd v, sixth, sum, v
    msub F, C, v, T         # F = T - C*v0 of the next step
    madd s, h, v, s         #     s = s + h*v1
