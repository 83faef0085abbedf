# ship_paper.s - Equations (1) in the order of the text, with nothing rearranged, after instructions
# that initialise the registers. For comparison with the paper, whose first step includes such
# instructions and whose later ones do not; ship.s is the program to use.
#
# The host gives the same names as to ship.s: v and s as state, the others as shared constants, from
# which the nine initialisations copy (x + -0.0 is x, bit for bit). v and s are initialised in place.

.state  v s                     # velocity, position
.shared T C rm h                # thrust, drag coefficient, 1/m, time step
.temp   thrust drag over_m step_h half two sixth    # the object's own copies
.temp   F a k1 k2 k3 k4         # force, acceleration, and Runge and Kutta's four
.temp   t sum                   # velocity and drag; the weighted sum

first:
    add  thrust, T, -0.0
    add  drag, C, -0.0
    add  over_m, rm, -0.0
    add  step_h, h, -0.0
    add  half, 0.5, -0.0
    add  two, 2.0, -0.0
    add  sixth, 0.16666667, -0.0
    add  v, v, -0.0
    add  s, s, -0.0

step:
    mul  t, drag, v             # F = T - C*v0
    sub  F, thrust, t
    mul  a, F, over_m           # a = F/m
    mul  k1, step_h, a          # k1 = h*a

    mul  t, half, k1            # F = T - C*(v0 + k1/2)
    add  t, v, t
    mul  t, drag, t
    sub  F, thrust, t
    mul  a, F, over_m           # a = F/m
    mul  k2, step_h, a          # k2 = h*a

    mul  t, half, k2            # F = T - C*(v0 + k2/2)
    add  t, v, t
    mul  t, drag, t
    sub  F, thrust, t
    mul  a, F, over_m           # a = F/m
    mul  k3, step_h, a          # k3 = h*a

    add  t, v, k3               # F = T - C*(v0 + k3)
    mul  t, drag, t
    sub  F, thrust, t
    mul  a, F, over_m           # a = F/m
    mul  k4, step_h, a          # k4 = h*a

    mul  t, two, k2             # v1 = v0 + (k1 + 2*k2 + 2*k3 + k4)/6
    add  sum, k1, t
    mul  t, two, k3
    add  sum, sum, t
    add  sum, sum, k4
    mul  t, sixth, sum
    add  v, v, t

    mul  t, step_h, v           # s = s + h*v1
    add  s, s, t
