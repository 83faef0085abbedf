# ship_sleep.s - Equations (1) as in ship_madd.s, the same bits, until a step changes the velocity
# by less than eps: then the ship sleeps, and costs nothing until the host wakes it.
#
# What is compared is v1 - v0 itself, so v0 must still be there when v1 is: v1 has a register of its
# own, and 3 instructions more than in ship_madd.s subtract, copy and decide. A ship that sleeps has
# finished the step that put it to sleep, position included; `slept` holds that step's number, v and
# s are what ship_madd.s gives after as many steps. A NaN is not less than eps: it never sleeps.
#
# `sleep` ends the step part, since nothing of that part is executed after it. What a step leaves
# unfinished belongs into the last part, which is executed for a ship that fell asleep as for all
# others, once, in the visit in which it did: so the position of ship.s, one step behind, would come
# out right, too. Here s is complete at the end of a step, and F alone is left for the next one: the
# first part computes it again at the beginning of a visit.
#
# With --params programs/ship.cfg --set slept=0 --set eps=1e-5 she sleeps after 15,170 steps: 119 s,
# at 99.6 % of her speed.

.state  v s                 # velocity, position
.state  slept               # 0: awake
.param  T C rm              # thrust, drag coefficient, 1/m
.shared h                   # time step
.shared eps                 # a change of velocity below which a ship is left alone
.const  half 0.5
.const  two 2.0
.const  sixth 0.16666667    # the FP32 number next to 1/6
.temp   k1 k2 k3 k4
.temp   t F a               # velocity, force, acceleration
.temp   sum                 # k1 + 2*k2 + 2*k3 + k4 as far as it is known
.temp   v1 dv

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
    madd sum, two, k2, k1   #     k1 + 2*k2
    msub F, C, t, T
    mul  a, F, rm           # a = F/m
    mul  k3, h, a           # k3 = h*a

    add  t, v, k3           # F = T - C*(v0 + k3)
    msub F, C, t, T
    madd sum, two, k3, sum  #     k1 + 2*k2 + 2*k3
    mul  a, F, rm           # a = F/m
    mul  k4, h, a           # k4 = h*a

    add  sum, sum, k4       # v1 = v0 + (k1 + 2*k2 + 2*k3 + k4)/6
    madd v1, sixth, sum, v
    sub  dv, v1, v
    add  v, v1, -0.0        # v = v1, bit for bit, also for v1 = -0.0
    msub F, C, v, T         # F = T - C*v0 of the next step
    madd s, h, v, s         # s = s + h*v1
    sleep slept, dv, eps    # |v1 - v0| < eps
