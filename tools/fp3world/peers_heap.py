"""The scene heap by others: balls at rest in a box. Each is a function of a lab that yields rows."""

from world_peers import row, shortest
from fp3world.scene import Failed
from fp3world.truth import Heap


def lammps_heap(lab):
    """Double precision: gran/hooke, from where fp3 has the balls at rest. Nothing turns the balls, so that their damping is that of the scene."""
    import numpy as np
    from fp3world import granular
    heap = Heap(lab.quick)
    x, v = heap.start(lab)
    count, forces = len(x), f"{heap.stiff} 0"
    of_pair, of_wall = 2 * heap.damp / heap.mass, heap.damp / heap.mass  # of the reduced mass, which is half a ball's
    box = granular.lammps().lammps(cmdargs=["-log", "none", "-screen", "none"])
    box.commands_string(f"""units si
        atom_style sphere
        atom_modify map array
        boundary f f f
        comm_modify vel yes
        region box block 0 {heap.side} 0 1000 0 {heap.side}
        create_box 1 box""")
    box.create_atoms(count, list(range(1, count + 1)), [1] * count, x.ravel().tolist(), v.ravel().tolist())
    walls = "\n".join(f"fix {axis} all wall/gran hooke {forces} {of_wall} {of_wall} 10000 1 {axis}plane 0 {high}" for axis, high in (("x", heap.side), ("y", "NULL"), ("z", heap.side)))
    box.commands_string(f"""set group all diameter {2 * heap.radius}
        set group all mass {heap.mass}
        neighbor {0.4 * heap.radius} bin
        neigh_modify every 1 delay 0 check yes
        pair_style gran/hooke {forces} {of_pair} {of_pair} 10000 1
        pair_coeff * *
        timestep {heap.h!r}
        fix gravity all gravity {heap.g} vector 0 -1 0
        {walls}
        fix steps all nve
        thermo 0""")
    box.command(f"run {heap.steps} post no")
    if box.get_natoms() != count:
        raise Failed(f"{count - box.get_natoms():g} of {count} balls are out of the box")
    order = np.argsort(box.numpy.extract_atom("id")[:count])
    error = heap.error(lab, box.numpy.extract_atom("x")[:count][order])
    seconds = shortest(lambda steps: box.command(f"run {steps} pre no post no"), *((5, 3) if lab.quick else (50, 9)))
    yield row(heap.case.name(lab.quick), count, seconds, error)


def box2d_heap(lab):
    """float32, in two dimensions: another scene. Circles without friction, 31 deep, in a box; contacts are solved as constraints."""
    import numpy as np
    import pyb2d3 as b2
    count, wide = (90, 10) if lab.quick else (10000, 321)
    radius, side = Heap.radius, 2 * Heap.radius * wide
    smooth = {"friction": 0.0, "restitution": 0.0}
    world, bodies, place = b2.World(gravity=(0, -Heap.g)), b2.Bodies(), np.random.default_rng(1)
    world.sleeping_enabled = False
    for ends in (((0, 0), (side, 0)), ((0, 0), (0, side)), ((side, 0), (side, side))):
        world.create_static_body().create_shape(b2.shape_def(material=b2.surface_material(**smooth)), b2.segment(*ends))
    for k in range(count):
        x, y = k % (wide - 1), k // (wide - 1)
        ball = world.body_factory().dynamic().position((2 * radius * (x + 0.55) + radius * (y % 2) * 0.4 + place.uniform(0, radius / 4), 2 * radius * (1.01 * y + 0.5)))
        bodies.append(ball.add_circle(center=(0, 0), radius=radius).surface_material(**smooth).create().id)

    def turn(steps):
        for _ in range(steps):
            world.step(1 / 60, 4)
    turn(300 if lab.quick else 900)
    fastest, lowest = abs(bodies.get_linear_velocities()).max(), bodies.get_positions().min()
    if not (fastest < 0.1 and lowest > 0.8 * radius):
        raise Failed(f"not at rest: a speed of {fastest:.3g} m/s, a ball {lowest:.3g} m from the box")
    yield row("heap, 2D" + ", small" * lab.quick, count, shortest(turn, *((5, 3) if lab.quick else (20, 9))), None, "1/60 s in 4 substeps")
