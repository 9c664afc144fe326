#!/usr/bin/env bash
# Installs what Fascia needs from Debian 12's packages; what is there already is left alone.
#   scripts/setup.sh [--demo|--test|--full]
# --demo (the default): build and demo. --test: the tests too. --full: heavy tests and benchmarks too.
set -euo pipefail

tier=demo
case "${1:-}" in
  ''|--demo) ;;
  --test) tier=test ;;
  --full) tier=full ;;
  *) echo "usage: scripts/setup.sh [--demo|--test|--full]" >&2; exit 2 ;;
esac

packages=(
  g++ cmake ninja-build ccache pkg-config ca-certificates
  libeigen3-dev libbullet-dev libglfw3-dev libtinygltf-dev libtinyobjloader-dev libdraco-dev
  libcli11-dev nlohmann-json3-dev
  libembree-dev libtbb-dev libmeshoptimizer-dev libnanoflann-dev libxxhash-dev zlib1g-dev
  libepoxy-dev libegl-dev libgl-dev libegl1 libgl1-mesa-dri libimgui-dev libstb-dev
  ffmpeg fonts-dejavu-core fonts-lato
)
[ "$tier" = demo ] || packages+=(libgtest-dev libvalijson-dev binutils locales clang-format abigail-tools valgrind xvfb xauth)
[ "$tier" != full ] || packages+=(
  clang clang-tidy doxygen libvtk9-dev libcgal-dev python3-numpy python3-pil python3-scipy
  nodejs npm slurmctld slurmd slurm-client munge
  # bindings and hosts: scripts/hosts.sh
  emscripten chromium python3-dev pybind11-dev python3-matplotlib unzip mono-mcs mono-runtime blender godot3-server godot3-runner
  g++-mingw-w64-x86-64-posix wine wine64 lintian zsh fish
)

missing=()
for package in "${packages[@]}"; do
  dpkg-query -W -f='${Status}' "$package" 2>/dev/null | grep -q 'install ok installed' || missing+=("$package")
done
# Node.js may be there without being Debian's.
command -v node >/dev/null && missing=("${missing[@]/nodejs/}") && missing=("${missing[@]/npm/}")
missing=($(printf '%s\n' "${missing[@]:-}" | sed '/^$/d'))
if [ "${#missing[@]}" -eq 0 ]; then
  echo "setup: everything for '$tier' is installed"
  exit 0
fi

as_root=()
if [ "$(id -u)" -ne 0 ]; then
  command -v sudo >/dev/null || { echo "setup: run as root, or install: ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "setup: installing ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}" >/dev/null
