"""Threads, signals, forks, and arrays that change while they are drawn."""

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


def test_ctrl_c_stops_it_within_a_second():
    text = LONG.format(tests=os.path.dirname(__file__)) + textwrap.dedent("""
    print("begun", flush=True)
    try:
        slab.render()
    except KeyboardInterrupt:
        print("stopped", flush=True)
    slab["picture"]["integrator"] = "analytic"
    slab["view"]["size"] = [8, 8]
    print(slab.render().shape, flush=True)
    """)
    run = script(text)
    assert run.stdout.readline() == "begun\n"
    time.sleep(1.0)
    run.send_signal(signal.SIGINT)
    start = time.monotonic()
    assert run.stdout.readline() == "stopped\n"
    assert time.monotonic() - start < 1.0
    out, err = run.communicate(timeout=60)
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


@pytest.mark.skipif(not hasattr(os, "fork"), reason="this system has no fork")
def test_a_forked_process_is_told(slab, cube, tmp_path):
    slab.render()
    reading, writing = os.pipe()
    picture, grid = slab.render(), voltet.Grid(**cube)

    def draw():
        slab["view"]["size"] = [5, 5]
        slab.render()

    # Every entry that works on several threads.
    entries = [draw, lambda: voltet.Grid(**cube), lambda: grid.about, lambda: picture.save(str(tmp_path / "picture.png"))]
    entries += [lambda: voltet.gradient_test("least-squares")]
    child = os.fork()
    if child == 0:
        for entry in entries:
            try:
                entry()
                os.write(writing, b"done;")
            except voltet.UsageError as error:
                os.write(writing, (str(error) + ";").encode())
            except BaseException as error:
                os.write(writing, f"{error!r};".encode())
        os._exit(0)
    os.close(writing)
    text = b""
    while part := os.read(reading, 4096):
        text += part
    os.waitpid(child, 0)
    said = text.decode().split(";")[:-1]
    assert len(said) == len(entries)
    assert all("forked" in one and "spawn" in one for one in said), said


def test_the_interpreter_ends_while_something_is_drawn():
    run = script(LONG.format(tests=os.path.dirname(__file__)) + textwrap.dedent("""
    import threading
    threading.Thread(target=slab.render, daemon=True).start()
    time.sleep(0.3)
    """))
    run.communicate(timeout=60)
    assert run.returncode in (0, 1), run.returncode
