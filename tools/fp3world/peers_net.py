"""The scene net by others: springs between 128 x 128 masses, held along an edge. Each is a function of a lab that yields rows."""

import subprocess

from world_peers import row, shortest
from fp3world.scene import Failed
from fp3world.truth import Net


def measured(lab, net, turn, positions, steps=50, repeats=15):
    turn(net.steps)
    error = net.error(lab, positions())
    seconds = shortest(turn, *((5, 3) if lab.quick else (steps, repeats)))
    net.check(positions())
    return row(net.case.name(lab.quick), net.objects, seconds, error)


def taichi_net(lab):
    """float32; neighbours by a stencil."""
    import taichi as ti
    ti.init(arch=ti.cpu, cpu_max_num_threads=1, log_level=ti.ERROR, offline_cache=False)
    net = Net(lab.quick)
    columns, rows, a, w, h = net.columns, net.rows, net.spacing, net.w, net.h
    ways = [(sign * x, sign * y, k) for x, y, k in net.ways() for sign in (-1, 1)]
    x, v = (ti.Vector.field(3, ti.f32, shape=(rows, columns)) for _ in range(2))

    @ti.kernel
    def kick():
        for j, i in x:
            force = ti.Vector([0.0, -net.g / w, 0.0])
            for n in ti.static(range(len(ways))):
                p, q = i + ways[n][0], j + ways[n][1]
                if 0 <= p < columns and 0 <= q < rows:
                    way = x[q, p] - x[j, i]
                    force += ways[n][2] * (1 - a * ti.static((ways[n][0] ** 2 + ways[n][1] ** 2) ** 0.5) / way.norm()) * way
            if j > 0:
                v[j, i] += h * w * force

    @ti.kernel
    def drift():
        for j, i in x:
            x[j, i] += h * v[j, i]

    def turn(steps):
        for _ in range(steps):
            kick()
            drift()
        ti.sync()
    x.from_numpy(net.start().reshape(rows, columns, 3).astype("f4"))
    yield measured(lab, net, turn, lambda: x.to_numpy().reshape(-1, 3))


def warp_net(lab):
    """float32; neighbours by a stencil, whose loop is unrolled."""
    import warp as wp
    wp.config.kernel_cache_dir = str(lab.folder / "warp")  # not in the home of who runs it
    net = Net(lab.quick)
    columns, rows, a, pull, hw, h = net.columns, net.rows, net.spacing, -net.g / net.w, net.h * net.w, net.h
    ways = [(sign * x, sign * y, k) for x, y, k in net.ways() for sign in (-1, 1)]
    tables = [wp.types.vector(len(ways), kind)([way[n] for way in ways]) for n, kind in enumerate((int, int, float))]
    to, across, stiffness = map(wp.constant, tables)
    rest = wp.constant(wp.types.vector(len(ways), float)([a * (x * x + y * y) ** 0.5 for x, y, _ in ways]))
    count = wp.constant(len(ways))

    @wp.kernel
    def kick(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3)):
        k = wp.tid()
        i, j = k % columns, k // columns
        force = wp.vec3(0.0, pull, 0.0)
        for n in range(count):
            p, q = i + to[n], j + across[n]
            if p >= 0 and p < columns and q >= 0 and q < rows:
                way = x[p + columns * q] - x[k]
                force += (stiffness[n] * (1.0 - rest[n] / wp.length(way))) * way
        if j > 0:
            v[k] += hw * force

    @wp.kernel
    def drift(x: wp.array(dtype=wp.vec3), v: wp.array(dtype=wp.vec3)):
        k = wp.tid()
        x[k] += h * v[k]
    x, v = wp.array(net.start(), dtype=wp.vec3, device="cpu"), wp.zeros(net.objects, dtype=wp.vec3, device="cpu")
    calls = [wp.launch(kernel, dim=net.objects, inputs=[x, v], device="cpu", record_cmd=True) for kernel in (kick, drift)]

    def turn(steps):
        for _ in range(steps):
            for call in calls:
                call.launch()
    yield measured(lab, net, turn, x.numpy)


def mujoco_net(lab):
    """Double precision. Bodies that slide along three axes; springs are the edges of flexes of dimension 1, one for each stiffness."""
    import mujoco
    import numpy as np
    net = Net(lab.quick)
    slides = "".join(f'<joint type="slide" axis="{axis}"/>' for axis in ("1 0 0", "0 1 0", "0 0 1"))
    bodies = "".join(f'<body name="b{k}" pos="{x} {y} {z}"><inertial pos="0 0 0" mass="{1 / net.w!r}" diaginertia="1e-9 1e-9 1e-9"/>{slides if k >= net.columns else ""}</body>'
                     for k, (x, y, z) in enumerate(net.start().tolist()))
    names, vertices = " ".join(f"b{k}" for k in range(net.objects)), "0 0 0 " * net.objects

    def flex(stiffness):
        k = np.arange(net.objects)
        elements = ""
        for to, across, stiff in net.ways():
            p, q = k % net.columns + to, k // net.columns + across
            inside = (p >= 0) & (p < net.columns) & (q < net.rows) & (stiff == stiffness)
            elements += "".join(f"{a} {b} " for a, b in zip(k[inside], (p + net.columns * q)[inside]))
        return (f'<flex dim="1" radius="0.001" body="{names}" vertex="{vertices}" element="{elements}"><edge stiffness="{stiffness}" damping="0"/>'
                '<contact contype="0" conaffinity="0" selfcollide="none"/></flex>')
    flexes = "".join(map(flex, sorted(set(net.stiffness.values()))))
    model = mujoco.MjModel.from_xml_string(f'<mujoco><option timestep="{net.h!r}" gravity="0 {-net.g} 0" integrator="Euler"><flag contact="disable" constraint="disable"/></option>'
                                           f"<worldbody>{bodies}</worldbody><deformable>{flexes}</deformable></mujoco>")
    data = mujoco.MjData(model)

    def positions():
        mujoco.mj_kinematics(model, data)
        return data.xpos[1:]
    yield measured(lab, net, lambda steps: mujoco.mj_step(model, data, steps), positions, 10, 5)


def bullet_net(lab):
    """float32, by bench/world/bullet.cpp: springs as in fp3; and another model, threads that each step makes as long as they were, in one pass."""
    import numpy as np
    net = Net(lab.quick)
    steps, repeats = (5, 3) if lab.quick else (10, 5)
    for kind, variant in (("springs", ""), ("threads", "another model: threads of the same number")):
        done = subprocess.run(list(map(str, [lab.bullet, kind, net.columns, net.rows, net.steps, steps, repeats])), capture_output=True, text=True)
        if done.returncode:
            raise Failed(done.stderr.strip() or f"exit code {done.returncode}")
        numbers = np.array(done.stdout.split(), float)
        if len(numbers) != 6 * net.objects + 1:
            raise Failed(f"{len(numbers)} numbers, expected {6 * net.objects + 1}")
        found, later = numbers[:-1].reshape(2, -1, 3)
        error = net.error(lab, found) if kind == "springs" else None
        if not net.difference(lab, found) < 0.05:
            raise Failed(f"{kind}: {net.difference(lab, found):.3g} of its length from where the net is, expected less than 0.05")
        net.check(later)
        yield row(net.case.name(lab.quick), net.objects, float(numbers[-1]), error, variant)
