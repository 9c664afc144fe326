#!/bin/sh
# Installs the build into a folder of its own and uses it as a stranger would: find_package and pkg-config, shared and
# static, C99 and C++20.
#   install_test.sh BUILD_FOLDER SOURCE_FOLDER RIG.glb
set -eu
build=$1 source=$2 rig=$3
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

cmake --install "$build" --prefix "$place/fascia" >"$place/log" || { cat "$place/log"; exit 1; }
test "$(wc -l <"$place/log")" -gt 5 || { echo "nothing was installed"; exit 1; }

cmake -S "$source/consumer" -B "$place/consumer" -DCMAKE_PREFIX_PATH="$place/fascia" >/dev/null
cmake --build "$place/consumer" >/dev/null
for program in shared_c99 static_c99 shared_cxx20; do
  "$place/consumer/$program" "$rig" || { echo "$program failed"; exit 1; }
done
if ldd "$place/consumer/static_c99" | grep -q libfascia; then echo "the static program needs the shared library"; exit 1; fi

pc=$(find "$place/fascia" -name fascia.pc)
flags=$(PKG_CONFIG_PATH=$(dirname "$pc") pkg-config --cflags --libs fascia)
cc -std=c99 -Wall -Wextra -Werror "$source/consumer/play.c" -o "$place/by_pkg_config" $flags -lm
LD_LIBRARY_PATH=$(dirname "$pc")/.. "$place/by_pkg_config" "$rig"

# What is compiled in comes with its licence, and the bill of materials names it.
if [ -x "$place/fascia/bin/fascia" ] && [ -e /usr/share/doc/libeigen3-dev/copyright ]; then
  bash "$source/../../scripts/sbom.sh" "$place/fascia" -o "$place/fascia.spdx.json" >/dev/null
  python3 - "$place/fascia.spdx.json" "$place/fascia/share/doc/fascia/third_party" <<'PYTHON'
import json, os, sys
bill = json.load(open(sys.argv[1]))
names = {package["name"]: package for package in bill["packages"]}
contained = {r["relatedSpdxElement"] for r in bill["relationships"] if r["relationshipType"] == "CONTAINS"}
for name in ("libeigen3-dev", "libtinygltf-dev", "libimgui-dev", "fonts-dejavu-core"):
    assert names[name]["SPDXID"] in contained, name
for name, package in names.items():
    assert package["licenseConcluded"] != "NOASSERTION", name
    if package["SPDXID"] in contained and name != "fascia":
        assert os.path.getsize(os.path.join(sys.argv[2], name + ".txt")) > 500, name
PYTHON
fi

library=$(find "$place/fascia" -name 'libfascia.so.*.*.*')
readelf -d "$library" | grep -q 'SONAME.*libfascia\.so\.0' || { echo "no SONAME"; exit 1; }
if nm -D --defined-only "$library" | awk '{print $3}' | grep -v '^fascia_\|^FASCIA_0'; then echo "symbols that are not the interface's"; exit 1; fi

if [ -x "$place/fascia/bin/fascia" ]; then
  "$place/fascia/bin/fascia" --version
  page=$(find "$place/fascia/share/man/man1" -name 'fascia.1*')
  case "$page" in *.gz) gzip -dc "$page" ;; *) cat "$page" ;; esac | grep -q '[.]SH NAME'
  bash -c "set -e; . '$place/fascia/share/bash-completion/completions/fascia'; COMP_WORDS=(fascia bu); COMP_CWORD=1; _fascia; \
           test \"\${COMPREPLY[0]}\" = build"
fi
if [ -f "$(find "$place/fascia" -name fascia_builder_targets.cmake)" ]; then
  cmake -S "$source/builder_consumer" -B "$place/builder" -DCMAKE_PREFIX_PATH="$place/fascia" >/dev/null
  cmake --build "$place/builder" >/dev/null
  "$place/builder/landmarks"
fi
