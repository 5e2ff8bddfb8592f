#!/usr/bin/env bash
# Installs what citystream needs on Debian 12, as root. Quick when everything is there already.
# Mesa comes from the backports suite where it can be had (more Vulkan features on lavapipe); CITYSTREAM_STOCK_MESA=1 keeps the stock one.
set -euo pipefail

packages=(
    g++ cmake ninja-build ccache mold pkg-config git ca-certificates
    libboost1.81-dev libopenmesh-dev libdraco-dev libmeshoptimizer-dev libopenimageio-dev libpng-dev libeigen3-dev
    libvulkan-dev vulkan-validationlayers libvulkan-volk-dev libegl-dev libgles-dev libglu1-mesa-dev glslang-tools spirv-tools
    nlohmann-json3-dev libsimdjson-dev libexpat1-dev libfmt-dev libcli11-dev libzstd-dev liblzma-dev zlib1g-dev libxxhash-dev libssl-dev
    libtinygltf-dev libavcodec-dev libavformat-dev libavutil-dev libswscale-dev libx264-dev
    libembree-dev libsquish-dev libstb-dev libglm-dev libgtest-dev libbenchmark-dev python3 unzip curl xz-utils
)
mesa=(mesa-vulkan-drivers libegl-mesa0 libgl1-mesa-dri)

installed() { dpkg-query -W -f '${db:Status-Status}\n' "$@" 2>/dev/null | grep -cx installed || true; }

export DEBIAN_FRONTEND=noninteractive
if [ "$(installed "${packages[@]}")" -ne "${#packages[@]}" ] || [ "$(installed "${mesa[@]}")" -ne "${#mesa[@]}" ]; then
    if [ "$(id -u)" -ne 0 ]; then
        echo "deploy/setup.sh: packages are missing and only root can install them: run it as root once" >&2
        exit 1
    fi
    if [ -z "${CITYSTREAM_STOCK_MESA:-}" ]; then
        sources=/etc/apt/sources.list.d/debian.sources
        if [ -f "$sources" ] && ! grep -q bookworm-backports "$sources"; then
            sed -i 's/^Suites: bookworm bookworm-updates$/& bookworm-backports/' "$sources"
        fi
    fi
    apt-get update -qq
    apt-get install -y -qq --no-install-recommends "${packages[@]}" >/dev/null
    if [ -z "${CITYSTREAM_STOCK_MESA:-}" ] && apt-cache policy mesa-vulkan-drivers | grep -q bookworm-backports; then
        apt-get install -y -qq --no-install-recommends -t bookworm-backports "${mesa[@]}" >/dev/null ||
            echo "deploy/setup.sh: Mesa of the backports suite cannot be had, the stock one is used" >&2
    fi
    apt-get install -y -qq --no-install-recommends "${mesa[@]}" >/dev/null
fi
