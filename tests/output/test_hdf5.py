"""What is written as HDF5, read by h5py: the numbers of the CSV, chunks, attributes; full disks, ends in the middle."""

import os
import resource
import shutil
import signal
import subprocess
import zlib

import h5py
import numpy
import peak
import pytest


@pytest.fixture
def record(start, tmp_path):
    """The same run as CSV and as HDF5."""
    def record(program, *arguments, more=(), **options):
        rows = start(program, *arguments, **options)
        start(program, *arguments, *more, output="out.h5", **options)
        return rows, h5py.File(tmp_path / "out.h5")
    return record


def agree(done, file):
    """Every number of the rows stands in the datasets, and there are no others."""
    objects = len({row["object"] for row in done.rows})
    for name in done.names:
        if name == "object":
            continue
        column = [row[name] for row in done.rows]
        data = file[name]
        if name in ("step", "time"):
            column = column[::objects]
            assert data.shape == (len(column),)
        else:
            assert data.shape == (len(done.rows) // objects, objects)
        flat = data[()].reshape(-1)
        assert numpy.array_equal(flat, numpy.array(column, dtype=flat.dtype), equal_nan=flat.dtype.kind == "f"), name
    assert set(file) | {"object"} == set(done.names) | {"hash:chain"} and file["hash:chain"].shape == (len(done.rows) // objects, 8)


@pytest.mark.smoke
@pytest.mark.parametrize("engine", ["isa", "rtl"])
def test_it_has_the_numbers_of_the_csv(record, engine):
    done, file = record("kepler.ode", "-e", engine, "-c", "many_full", "-N", "5", "--spread", "r_x=0.4:0.6", "-n", "20", "--every", "3",
                        "--observe", "v_x,energy,r_y")
    agree(done, file)
    assert {name: str(data.dtype) for name, data in file.items()} == \
        {"v_x": "float32", "energy": "float64", "r_y": "float32", "step": "uint64", "time": "float64", "hash:chain": "uint32"}


def test_one_object_and_many_snapshots(start, tmp_path):
    """More than a chunk of them, and a last one that is not full: 131072 times 8 bytes are 1 MB."""
    (tmp_path / "m.s").write_text(".state x\n.shared h\nstep: add x, x, 1.0\n")
    start("m.s", "-e", "isa", "--set", "x=0.5", "--set", "h=0.5", "-n", "140000", "--every", "1", output="out.h5")
    with h5py.File(tmp_path / "out.h5") as file:
        assert file["x"].chunks == (131072, 1) and file["time"].chunks == (131072,) and file["x"].shape == (140001, 1)
        steps = numpy.arange(140001)
        assert (file["step"][:] == steps).all() and (file["time"][:] == 0.5 * steps).all() and (file["x"][:, 0] == 0.5 + steps).all()


def test_the_registers_of_sleepers_are_integers(record, root):
    done, file = record("ship_sleep.s", "--params", root / "programs/ship.cfg", "-e", "isa", "-c", "shared", "-N", "6",
                        "--set", "eps=2e-3", "--spread", "T=2e5:4e5", "-n", "900", "--every", "100")
    agree(done, file)
    assert file["slept"].dtype == numpy.uint32 and file["slept"][-1].max() > 100
    assert "model" not in file.attrs and "integrator" not in file.attrs


def test_what_it_says_of_itself(record, fp3, root, tmp_path):
    done, file = record("oscillator.ode", "-e", "isa", "-c", "many_full", "-i", "ralston3", "--set", "h=0.1", "-N", "2", "-n", "3", "--every", "1")
    agree(done, file)
    subprocess.run([fp3, "compile", root / "programs/oscillator.ode", "-c", "many_full", "-i", "ralston3", "--image", "x.fp3"],
                   cwd=tmp_path, check=True, stdout=subprocess.DEVNULL)
    version = subprocess.run([fp3, "--version"], capture_output=True, text=True).stdout.split()[-1]
    assert file.attrs["command"].splitlines()[-1].endswith("oscillator.ode") and "ralston3" in file.attrs["command"].splitlines()
    assert {name: value for name, value in file.attrs.items() if name != "command"} == {
        "hash:before": 64 * "0",
        "model": "oscillator", "description": "a mass on a spring with a damper, weakly damped", "integrator": "ralston3", "engine": "isa",
        "configuration": "many_full", "h": float(numpy.float32(0.1)), "fp3_version": version,
        "image_crc32": zlib.crc32((tmp_path / "x.fp3").read_bytes()[:-4])}
    assert file["v"].attrs["units"] == "m/s" and file["x"].attrs["units"] == "m" and file["time"].attrs["units"] == "s"
    assert list(file["time"][:]) == [n * float(numpy.float32(0.1)) for n in range(4)]


def test_compressed_it_is_smaller_and_the_same(record, start, tmp_path):
    run = ("ship.ode", "-e", "isa", "-n", "5000", "--every", "1")
    plain = record(*run)[1]
    hashes = 5001 * 32
    size = (tmp_path / "out.h5").stat().st_size - hashes
    done, file = record(*run, more=("--compress",))
    agree(done, file)
    assert file["v"].compression == "gzip" and plain["v"].compression is None
    assert (tmp_path / "out.h5").stat().st_size - hashes < 0.6 * size
    assert "only HDF5 (a name that ends in .h5 or .hdf5) is compressed" in start("ship.ode", "--compress", code=2).stderr
    assert "--compress: expected --output FILE" in start("ship.ode", "--compress", output=None, code=2).stderr


def test_a_name_says_what_it_is(start, tmp_path):
    for name in ("a.h5", "b.HDF5", "c.H5"):
        start("ship.ode", output=name)
        assert h5py.is_hdf5(tmp_path / name)
    for name in ("a.csv", "h5", "a.h5.txt"):
        start("ship.ode", output=name)
        assert (tmp_path / name).read_text().startswith("step,")


def test_links_are_in_it_once(start, root, tmp_path):
    """A net of 20 x 20 has structural, shear and bending springs; each has two ends."""
    start("--scene", root / "programs/world/cloth.scene", "-n", "4", output="out.h5")
    with h5py.File(tmp_path / "out.h5") as file:
        links = {tuple(sorted(pair)) for pair in file["links:springs"][()].tolist()}
        assert len(links) == len(file["links:springs"]) == 2 * 20 * 19 + 2 * 19 * 19 + 2 * 20 * 18
        assert (0, 1) in links and (0, 20) in links and (0, 21) in links and (0, 40) in links and (0, 22) not in links
        assert not any(name.startswith(("reach", "position")) for name in file.attrs)


def test_who_is_near_is_in_it(start, root, tmp_path):
    start("--scene", root / "programs/world/balls.scene", "-n", "4", output="out.h5")
    with h5py.File(tmp_path / "out.h5") as file:
        assert file.attrs["reach:touch"] == 2 * numpy.float32(0.05) and file.attrs["position:touch"] == "x_x,x_y,x_z"
        assert file["x_y"].attrs["velocity"] == "v_y" and "velocity" not in file["v_y"].attrs
        assert not any(name.startswith("links") for name in file)


def test_many_objects_in_chunks(build, tmp_path):
    """From the writer alone: 600,000 objects are three blocks."""
    env = {**os.environ, "FP3_RTL_DIR": str(build / "lib/fp3")}
    done, most = peak.run([build / "tests/writer_speed", 600001, 3, "many.h5"], cwd=tmp_path, env=env)
    assert done.returncode == 0 and most < 2e8, (done.stderr, most)
    with h5py.File(tmp_path / "many.h5") as file:
        assert file["v"].shape == (3, 600001) and file["v"].chunks == (1, 200001) and file["s"].chunks == (1, 200001)
        first = 200001 * (numpy.arange(600001) // 200001)
        inside = (numpy.arange(600001) - first).astype(numpy.float32)
        for n in range(3):
            base = numpy.float32(n) + numpy.float32(0.001) * first.astype(numpy.float32)
            assert numpy.allclose(file["v"][n], base + numpy.float32(0.001) * inside, rtol=1e-6)


# ---- files ----

def test_what_is_no_file_is_refused(start, tmp_path):
    (tmp_path / "full.h5").symlink_to("/dev/full")
    (tmp_path / "null.h5").symlink_to("/dev/null")
    for name in ("full.h5", "null.h5"):
        assert f"{name}: HDF5 needs a regular file" in start("ship.ode", output=name, code=2).stderr


@pytest.mark.parametrize("share", [0.01, 0.1, 0.5, 0.9, 0.999, 1])
@pytest.mark.parametrize("steps", [10, 40000])
def test_a_full_disk_is_told(start, tmp_path, steps, share):
    """Wherever it is full, the last byte included: some of it is only written when all is flushed."""
    run = ("ship.ode", "-e", "isa", "-n", steps, "--every", "1")
    start(*run, output="out.h5")
    most = int(share * (tmp_path / "out.h5").stat().st_size) - 1
    (tmp_path / "out.h5").write_text("before")

    def small():
        signal.signal(signal.SIGXFSZ, signal.SIG_IGN)
        resource.setrlimit(resource.RLIMIT_FSIZE, (most, most))
    done = start(*run, output="out.h5", preexec_fn=small, code=1)
    assert "out.h5: cannot write: File too large" in done.stderr, done.stderr
    assert (tmp_path / "out.h5").read_text() == "before" and [path.name for path in tmp_path.iterdir()] == ["out.h5"]


def test_the_file_of_before_stays_until_the_new_one_is_whole(killed_while_it_writes, tmp_path):
    (tmp_path / "out.h5").write_text("before")
    killed_while_it_writes("out.h5")
    assert (tmp_path / "out.h5").read_text() == "before"


def test_without_the_writer_it_says_what_it_lacks(start, build, tmp_path):
    where = {**os.environ, "FP3_RTL_DIR": str(tmp_path)}
    shutil.copy(build / "lib/fp3/fp3_single_full.so", tmp_path / "fp3_hdf5.so")
    assert "fp3_hdf5.so does not fit this libfp3" in start("ship.ode", "-e", "isa", output="out.h5", env=where, code=1).stderr
    (tmp_path / "old.c").write_text("const unsigned fp3_hdf5_calls[64] = {0, 80};")
    subprocess.run(["gcc", "-shared", "-fPIC", "old.c", "-o", "fp3_hdf5.so"], cwd=tmp_path, check=True)
    assert "fp3_hdf5.so does not fit this libfp3" in start("ship.ode", "-e", "isa", output="out.h5", env=where, code=1).stderr
    (tmp_path / "fp3_hdf5.so").unlink()
    (tmp_path / "old.c").unlink()
    done = start("ship.ode", "-e", "isa", output="out.h5", env=where, code=1)
    assert "no library for HDF5 files, fp3_hdf5.so" in done.stderr and list(tmp_path.iterdir()) == []
