# ship.s - Equations (1): a ship under constant thrust and linear drag, one RK4 step of its
# velocity, then the position.
#
#   F(v) = T - C*v      a(v) = F(v)/m      k(v) = h*a(v)
#   k1 = k(v0)   k2 = k(v0 + k1/2)   k3 = k(v0 + k2/2)   k4 = k(v0 + k3)
#   v1 = v0 + (k1 + 2*k2 + 2*k3 + k4)/6
#   s  = s + h*v1
#
# 30 operations a step: 12 additions and subtractions, 18 multiplications. The host gives 1/m as rm.
#
# Instructions issue in this order and wait for their operands. A step's critical path is the chain
# v0 .. k4, v1 and on to the next step's C*v0; everything else stands behind an instruction of the
# chain, one at a time, in the cycle that the chain cannot use. So C*v0 is computed at the end of the
# step before (the first part computes the first one), ahead of h*v1; and the position is one step
# behind: s = s + p comes early in the next step, and the last part adds the last p.

.state  v s                 # velocity, position
.param  T C rm              # thrust, drag coefficient, 1/m
.shared h                   # time step
.const  half 0.5
.const  two 2.0
.const  sixth 0.16666667    # the FP32 number next to 1/6
.temp   k1 k2 k3 k4
.temp   t F a               # of the chain: velocity and drag, force, acceleration
.temp   w sum p             # in its shadow: 2*k2 or 2*k3, the weighted sum, h*v1

first:
    add  p, -0.0, -0.0      # no position to catch up with: s + -0.0 is s, bit for bit, also for s = -0.0
    mul  t, C, v            # C*v0

step:
    sub  F, T, t            # F = T - C*v0
    add  s, s, p            #     the position of the step before
    mul  a, F, rm           # a = F/m
    mul  k1, h, a           # k1 = h*a

    mul  t, half, k1        # F = T - C*(v0 + k1/2)
    add  t, v, t
    mul  t, C, t
    sub  F, T, t
    mul  a, F, rm           # a = F/m
    mul  k2, h, a           # k2 = h*a

    mul  t, half, k2        # F = T - C*(v0 + k2/2)
    mul  w, two, k2         #     2*k2
    add  t, v, t
    add  sum, k1, w         #     k1 + 2*k2
    mul  t, C, t
    sub  F, T, t
    mul  a, F, rm           # a = F/m
    mul  k3, h, a           # k3 = h*a

    add  t, v, k3           # F = T - C*(v0 + k3)
    mul  w, two, k3         #     2*k3
    mul  t, C, t
    add  sum, sum, w        #     k1 + 2*k2 + 2*k3
    sub  F, T, t
    mul  a, F, rm           # a = F/m
    mul  k4, h, a           # k4 = h*a

    add  sum, sum, k4       # v1 = v0 + (k1 + 2*k2 + 2*k3 + k4)/6
    mul  t, sixth, sum
    add  v, v, t
    mul  t, C, v            # C*v0 of the next step
    mul  p, h, v            #     h*v1, for the position

last:
    add  s, s, p            # the position of the last step
