#!/usr/bin/env bash
# Installs Mesa's software Vulkan driver on Debian and Ubuntu, so that the tests of shaders run without a GPU.
# Needs root, or sudo.
set -euo pipefail

if ! command -v apt-get >/dev/null; then
    echo "install-software-vulkan: found no apt-get; install Mesa's lavapipe driver and the Vulkan loader by hand" >&2
    exit 1
fi
as_root=()
if [ "$(id -u)" -ne 0 ]; then
    as_root=(sudo -n)
fi
export DEBIAN_FRONTEND=noninteractive
install() { "${as_root[@]}" apt-get install -y --no-install-recommends mesa-vulkan-drivers libvulkan1; }
# Only where the lists of packages are missing or old are they fetched.
install || { "${as_root[@]}" apt-get update && install; }
