#!/usr/bin/env bash
# Installs ParaView with its Python, and an X server without a screen, on Debian and Ubuntu, so that the plug-in's tests run.
# Needs root, or sudo.
set -euo pipefail

if ! command -v apt-get >/dev/null; then
    echo "install-paraview: found no apt-get; install ParaView with pvpython, and xvfb-run, by hand" >&2
    exit 1
fi
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo -n)
fi
export DEBIAN_FRONTEND=noninteractive
install() { "${as_root[@]}" apt-get install -y --no-install-recommends paraview python3-paraview xvfb xauth; }
# Only where the lists of packages are missing or old are they fetched.
install || { "${as_root[@]}" apt-get update && install; }
