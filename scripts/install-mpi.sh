#!/usr/bin/env bash
# Installs MPI and the library of Clang, which rsmpi reads MPI's headers with, on Debian and Ubuntu, so that programs are built with the
# feature `mpi`, and its tests run: Open MPI, or MPICH (`scripts/install-mpi.sh mpich`, then MPICC=mpicc.mpich). Needs root, or sudo.
set -euo pipefail

case "${1:-openmpi}" in
openmpi) packages=(libopenmpi-dev openmpi-bin) ;;
mpich) packages=(libmpich-dev mpich) ;;
*)
    echo "install-mpi: got '$1', expected openmpi or mpich" >&2
    exit 2
    ;;
esac
if ! command -v apt-get >/dev/null; then
    echo "install-mpi: found no apt-get; install an MPI with mpicc and mpirun, and libclang, by hand" >&2
    exit 1
fi
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo -n)
fi
export DEBIAN_FRONTEND=noninteractive
install() { "${as_root[@]}" apt-get install -y --no-install-recommends "${packages[@]}" libclang-dev; }
# Only where the lists of packages are missing or old are they fetched.
install || { "${as_root[@]}" apt-get update && install; }
