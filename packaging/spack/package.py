# SPDX-License-Identifier: (Apache-2.0 OR MIT)

from spack_repo.builtin.build_systems.cargo import CargoPackage

from spack.package import *


class Voltet(CargoPackage):
    """Volume pictures of simulation results on unstructured grids, straight from the cells, with
    transfer functions over a scalar and its gradient magnitude."""

    homepage = "https://github.com/voltet/voltet"
    git = "https://github.com/voltet/voltet.git"
    url = "https://github.com/voltet/voltet/archive/refs/tags/v0.3.0.tar.gz"

    maintainers("voltet")

    license("MIT OR Apache-2.0", checked_by="voltet")

    version("main", branch="main")
    version("0.3.0", tag="v0.3.0")

    # The system's Vulkan loader is opened at run time; without one the processor draws.
    variant("gpu", default=True, description="Draws on graphics devices by Vulkan, too")
    variant("mpi", default=False, description="Shares one grid out among processes")
    variant("editor", default=False, description="Node editor, voltet edit")

    depends_on("c", type="build")
    depends_on("rust@1.89:", type="build")
    depends_on("rust@1.95:", type="build", when="+editor")
    depends_on("mpi", when="+mpi")
    depends_on("llvm+clang", type="build", when="+mpi")

    @property
    def build_args(self):
        optional = ("gpu", "mpi", "editor")
        features = ["cli"] + [name for name in optional if self.spec.satisfies(f"+{name}")]
        return ["--locked", "--no-default-features", "--features", ",".join(features)]

    @property
    def check_args(self):
        return ["--locked", "--package", "voltet", "--lib"]

    @run_after("install")
    def manual_and_completions(self):
        program = Executable(self.prefix.bin.voltet)
        program("man", self.prefix.share.man.man1)
        for shell, folder, name in (
            ("bash", bash_completion_path(self.prefix), "voltet"),
            ("zsh", zsh_completion_path(self.prefix), "_voltet"),
            ("fish", fish_completion_path(self.prefix), "voltet.fish"),
        ):
            mkdirp(folder)
            with open(folder / name, "w") as file:
                program("completions", shell, output=file)
