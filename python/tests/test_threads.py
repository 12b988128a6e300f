"""Threads, signals, forks, and arrays that change while they are drawn."""

import gc
import os
import signal
import subprocess
import sys
import textwrap
import threading
import time

import numpy as np
import pytest
from conftest import box, uniform

import voltet


def test_other_threads_run_while_it_works(cube):
    slab = uniform(voltet.Grid(**cube), (1500, 1500))
    counted, done = 0, threading.Event()
    threading.Thread(target=lambda: (slab.render(), done.set())).start()
    while not done.wait(0.001):
        counted += 1
    assert counted > 5


def test_pipelines_in_several_threads_draw_one_grid(cube):
    grid = voltet.Grid(**cube)
    expected = uniform(grid).render()
    found = []

    def draw():
        slab = uniform(grid)
        found.extend(slab.render() for _ in range(5))

    threads = [threading.Thread(target=draw) for _ in range(6)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert len(found) == 30 and all(np.array_equal(rgba, expected) for rgba in found)


def test_one_pipeline_serves_one_thread_at_a_time(slab):
    caught = []

    def inner(node, stage, fraction):
        try:
            slab.render()
        except voltet.UsageError as error:
            caught.append(str(error))

    slab.render(progress=inner)
    assert caught and "in use" in caught[0] and "thread" in caught[0]


def test_numbers_that_change_while_they_are_drawn_do_no_harm(cube):
    grid = voltet.Grid(**cube)
    slab = uniform(grid, (200, 200))
    stop = threading.Event()

    def write():
        random = np.random.default_rng(1)
        while not stop.is_set():
            cube["tetrahedra"][random.integers(0, 625, 20), random.integers(0, 4, 20)] = random.integers(0, 2**32, 20)
            cube["points"][random.integers(0, 216, 5)] = random.choice([np.nan, np.inf, 1e300, 0.3])
            cube["point_data"]["T"][random.integers(0, 216, 5)] = np.nan
            cube["points"][:], cube["tetrahedra"][:] = box()

    thread = threading.Thread(target=write)
    thread.start()
    try:
        for i in range(40):
            slab["view"]["eye"] = [0.5 + 0.01 * i, -4.0, 0.5]
            try:
                slab.render()
            except voltet.Error:
                pass
    finally:
        stop.set()
        thread.join()
    cube["points"][:], cube["tetrahedra"][:] = box()
    cube["point_data"]["T"][:] = cube["points"] @ [1.0, 2.0, 0.0]
    assert np.isfinite(slab.render()).all()


def script(text: str, **options):
    return subprocess.Popen([sys.executable, "-c", textwrap.dedent(text)], text=True, stdout=-1, stderr=-1, **options)


LONG = """
import sys, time, numpy as np, voltet
sys.path.insert(0, {tests!r})
from conftest import box, uniform
points, tetrahedra = box(30)
grid = voltet.Grid(points, tetrahedra=tetrahedra, point_data={{"T": points[:, 0]}})
slab = uniform(grid, (4000, 4000), integrator="reference")
"""


def test_ctrl_c_stops_it_long_before_its_end():
    text = LONG.format(tests=os.path.dirname(__file__)) + textwrap.dedent("""
    done = 0.0

    def follow(node, stage, fraction):
        global done
        if node == "picture":
            if done == 0.0:
                print("begun", flush=True)
            done = max(done, fraction, 1e-9)

    try:
        slab.render(progress=follow)
        print("ended", flush=True)
    except KeyboardInterrupt:
        print("stopped at", done, flush=True)
    slab["picture"]["integrator"] = "analytic"
    slab["view"]["size"] = [8, 8]
    print(slab.render().shape, flush=True)
    """)
    run = script(text)
    assert run.stdout.readline() == "begun\n"
    run.send_signal(signal.SIGINT)
    stopped, at = run.stdout.readline().rsplit(maxsplit=1)
    assert stopped == "stopped at" and float(at) < 0.5
    out, err = run.communicate(timeout=300)
    assert out.strip() == "(8, 8, 4)" and run.returncode == 0, err


def test_ctrl_c_interrupts_a_filter_that_never_returns():
    text = LONG.format(tests=os.path.dirname(__file__)) + textwrap.dedent("""
    @voltet.gradient_filter("for-ever")
    def for_ever(points, tetrahedra, scalar):
        print("begun", flush=True)
        while True:
            pass

    small = voltet.scene(grid, method="for-ever", size=(8, 8))
    try:
        small.volume("gradient")
    except KeyboardInterrupt:
        print("stopped", flush=True)
    small["gradient"]["method"] = "least-squares"
    print(small.render().shape, flush=True)
    """)
    run = script(text)
    assert run.stdout.readline() == "begun\n"
    time.sleep(0.3)
    run.send_signal(signal.SIGINT)
    start = time.monotonic()
    assert run.stdout.readline() == "stopped\n"
    assert time.monotonic() - start < 1.0
    out, err = run.communicate(timeout=60)
    assert out.strip() == "(8, 8, 4)" and run.returncode == 0, err


def forked(work, seconds=30):
    """Does work in a fork of this process: what it says, or how it was ended."""
    reading, writing = os.pipe()
    child = os.fork()
    if child == 0:
        os.close(reading)
        signal.signal(signal.SIGALRM, signal.SIG_DFL)
        # Ends a child that hangs, whatever it holds.
        signal.alarm(seconds)
        try:
            work()
            said = "done"
        except voltet.UsageError as error:
            said = f"refused: {error}"
        except BaseException as error:
            said = repr(error)
        os.write(writing, said.encode())
        os._exit(0)
    os.close(writing)
    text = b""
    while part := os.read(reading, 4096):
        text += part
    os.close(reading)
    status = os.waitpid(child, 0)[1]
    return text.decode() if status == 0 else f"ended by {status}"


def is_told(said):
    return said.startswith("refused: this process was forked") and "spawn" in said


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_every_entry_of_a_forked_process_works_or_is_refused(slab, cube, tmp_path):
    picture, grid = slab.render(), voltet.Grid(**cube)
    slab.save(tmp_path / "slab.toml")
    result = voltet.run(tmp_path / "slab.toml")

    @voltet.gradient_filter("before-the-fork")
    def before(points, tetrahedra, scalar):
        return np.zeros((len(points), 3))

    drawn, file = slab.render(), voltet.Pipeline.open(tmp_path / "slab.toml")

    def register():
        voltet.gradient_filter("after-the-fork")(before)

    def change():
        slab["view"]["size"] = [5, 5]

    works = {
        "text": lambda: slab.text, "nodes": lambda: list(slab), "change": change, "undo": slab.undo, "check": slab.check, "size": slab.size,
        "add": lambda: slab.add("other", "camera", eye=[0, -9, 0], target=[0, 0, 0]), "rename": lambda: slab.rename("view", "seen"),
        "open": lambda: voltet.Pipeline.open(tmp_path / "slab.png"), "repr": lambda: slab._repr_html_(),
        "file check": lambda: voltet.check(tmp_path / "slab.toml"), "file save": lambda: file.save(tmp_path / "again.toml"),
        "report": lambda: drawn.report["seconds"], "result": lambda: repr(result), "pixels": lambda: picture.rgba8(),
        "register": register, "new": voltet.Pipeline, "widget": lambda: voltet.widgets.uniform(color=[1, 1, 1], extinction=1.0),
        "forget": grid.modified, "collect": lambda: (slab.__dict__.clear(), grid.__dict__.clear(), gc.collect()),
    }
    refused = {
        "give": lambda: slab.give(grid, "grid"), "render": lambda: (change(), slab.render()), "same picture": slab.render, "run": slab.run, "render until": lambda: slab.render_until(np.full((16, 16), 9.0)),
        "volume": lambda: slab.volume("gradient"), "figures": lambda: slab.figures("gradient"), "pixel": lambda: slab.pixel(2, 2), "study": slab.study,
        "after a new filter": lambda: (register(), change()), "save": lambda: slab.save(tmp_path / "other.toml"), "grid": lambda: voltet.Grid(**cube), "about": lambda: grid.about, "count": lambda: grid.cell_count,
        "pieces": lambda: voltet.Grid.from_pieces([{key: cube[key] for key in ("points", "tetrahedra", "point_data")}]),
        "scene": lambda: voltet.scene(grid), "run of a file": lambda: voltet.run(tmp_path / "slab.toml"), "png": lambda: picture.save(tmp_path / "p.png"),
        "exr": lambda: picture.save(tmp_path / "p.exr"), "shown": picture._repr_png_, "test": lambda: voltet.gradient_test("least-squares"),
    }
    said = {name: forked(entry) for name, entry in [*works.items(), *refused.items()]}
    assert {name: said[name] for name in works} == dict.fromkeys(works, "done")
    assert not {name: said[name] for name in refused if not is_told(said[name])}
    assert slab.render().shape == (16, 16, 4)


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_filters_of_vtk_in_a_forked_process_say_so(cube):
    vtk = pytest.importorskip("vtk")
    import voltet.vtk as vv

    source = vtk.vtkRTAnalyticSource(whole_extent=(-3, 3, -3, 3, -3, 3))
    source.Update()
    kinds = [vv.VoltetRenderer, vv.VoltetGradientMagnitude, vv.VoltetProbe, vv.VoltetVolume]
    filters = [kind() for kind in kinds]
    for filter in filters:
        filter.SetInputData(source.GetOutput())
        filter.Update()
        filter.AddObserver("ErrorEvent", lambda *_: None)

    def update(filter):
        filter.Update()
        assert filter.GetError() is None
        filter.Modified()
        try:
            filter.Update()
        finally:
            assert isinstance(filter.GetError(), voltet.UsageError)

    assert not [said for said in (forked(lambda: update(filter)) for filter in filters) if not is_told(said)]


FORKS = """
import concurrent.futures, multiprocessing, os, signal, sys, numpy as np, voltet
sys.path.insert(0, {tests!r})
from conftest import box, uniform
points, tetrahedra = box()
slab = uniform(voltet.Grid(points, tetrahedra=tetrahedra, point_data={{"T": points[:, 0]}}))

def draw(number):
    try:
        return slab.render().shape
    except voltet.UsageError as error:
        return str(error)
"""


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
@pytest.mark.parametrize("engine", ["cpu", "gpu"])
def test_processes_of_multiprocessing_are_told_and_end(engine):
    text = FORKS.format(tests=os.path.dirname(__file__)) + f"slab['picture']['engine'] = {engine!r}" + textwrap.dedent("""
    try:
        slab.render()
    except voltet.RunError as error:
        sys.exit(f"no device: {error}")
    fork = multiprocessing.get_context("fork")
    with fork.Pool(2) as pool:
        print(*pool.map(draw, range(4)), sep="\\n")
    with concurrent.futures.ProcessPoolExecutor(2, fork) as pool:
        print(*pool.map(draw, range(4)), sep="\\n")
    process = fork.Process(target=draw, args=(1,))
    process.start()
    process.join(20)
    assert process.exitcode == 0, process.exitcode
    # One that ends as programs do, with all that it has.
    child = os.fork()
    if child == 0:
        signal.alarm(20)
        draw(1)
        sys.exit(0)
    assert os.waitpid(child, 0)[1] == 0
    print(slab.render().shape)
    """)
    out, err = script(text).communicate(timeout=120)
    if "no device" in err and engine == "gpu":
        pytest.skip(err)
    lines = out.splitlines()
    assert len(lines) == 9 and all("forked" in line and "spawn" in line for line in lines[:8]) and lines[8] == "(16, 16, 4)", out + err


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_what_is_only_read_before_a_fork_is_drawn_in_it(tmp_path, slab):
    slab.save(tmp_path / "slab.toml")
    voltet.run(tmp_path / "slab.toml")
    text = textwrap.dedent(f"""
    import multiprocessing, voltet
    file = voltet.Pipeline.open({str(tmp_path / "slab.png")!r})
    file.size(), voltet.nodes, voltet.widgets, file.save({str(tmp_path / "again.toml")!r})
    voltet.gradient_filter("zero")(lambda points, tetrahedra, scalar: 0.0 * points)

    def draw(number):
        return file.render().shape

    with multiprocessing.get_context("fork").Pool(2) as pool:
        print(pool.map(draw, range(2)))
    """)
    out, err = script(text).communicate(timeout=120)
    assert out == "[(16, 16, 4), (16, 16, 4)]\n", out + err


def test_the_interpreter_ends_while_something_is_drawn():
    run = script(LONG.format(tests=os.path.dirname(__file__)) + textwrap.dedent("""
    import threading
    threading.Thread(target=slab.render, daemon=True).start()
    time.sleep(0.3)
    """))
    run.communicate(timeout=60)
    assert run.returncode in (0, 1), run.returncode
