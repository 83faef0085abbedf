"""The scene stars by others: all pairs, leapfrog, drift-kick-drift. Each is a function of a lab that yields rows."""

from world_peers import row, shortest
from fp3world.truth import Stars


def cases(lab):
    """With whether the energy is asked for: a step of the larger form takes too long for many of them."""
    for label in ("stars, 1024",) if lab.quick else ("stars, 1024", "stars, 16384"):
        yield Stars(label, lab.quick), label == "stars, 1024"


def rebound_stars(lab):
    """Double precision."""
    import numpy as np
    import rebound
    for stars, is_long in cases(lab):
        simulation = rebound.Simulation()
        for (x, y, z), (a, b, c) in zip(*(column.tolist() for column in stars.start(lab))):
            simulation.add(m=1 / stars.objects, x=x, y=y, z=z, vx=a, vy=b, vz=c)
        simulation.integrator, simulation.gravity, simulation.softening, simulation.dt = "leapfrog", "basic", stars.soft, stars.h
        error = None
        if is_long:
            simulation.steps(stars.steps)
            simulation.synchronize()
            found = np.array([(*body.xyz, *body.vxyz) for body in simulation.particles])
            error = stars.error(lab, found[:, :3], found[:, 3:])
        yield row(stars.name, stars.objects, shortest(simulation.steps, 5 if lab.quick else max(1, 10 ** 8 // stars.objects ** 2), 3), error)


def warp_stars(lab):
    """float32."""
    import numpy as np
    import warp as wp
    wp.config.kernel_cache_dir = str(lab.folder / "warp")  # not in the home of who runs it

    @wp.kernel
    def drift(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), h: float):
        k = wp.tid()
        x[k] += h * v[k]

    @wp.kernel
    def kick(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3), h: float, m: float, soft_square: float, objects: int):
        k = wp.tid()
        total = wp.vec3(0.0, 0.0, 0.0)
        for o in range(objects):
            way = x[o] - x[k]
            square = wp.dot(way, way) + soft_square
            total += (1.0 / (square * wp.sqrt(square))) * way
        v[k] += (h * m) * total
    for stars, is_long in cases(lab):
        x, v = (wp.array(column, dtype=wp.vec3, device="cpu") for column in stars.start(lab))
        half = wp.launch(drift, dim=stars.objects, inputs=[x, v, stars.h / 2], device="cpu", record_cmd=True)
        whole = wp.launch(kick, dim=stars.objects, inputs=[x, v, stars.h, 1 / stars.objects, stars.soft ** 2, stars.objects], device="cpu", record_cmd=True)

        def turn(steps):
            for _ in range(steps):
                half.launch()
                whole.launch()
                half.launch()
        error = None
        if is_long:
            turn(stars.steps)
            error = stars.error(lab, *(column.numpy().astype(np.float64) for column in (x, v)))
        yield row(stars.name, stars.objects, shortest(turn, 5 if lab.quick else max(1, 10 ** 8 // stars.objects ** 2), 3), error)
