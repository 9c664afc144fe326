#!/bin/sh
# Installs the build into a folder of its own and uses it as a stranger would: find_package and pkg-config, shared and
# static, C99 and C++20, and a regression test of a head.
#   install_test.sh BUILD_FOLDER|ROOT SOURCE_FOLDER RIG.glb HEAD.glb      ROOT has the packages unpacked, in ROOT/usr
set -eu
build=$1 source=$2 rig=$3 head=$4
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

if [ -d "$build/usr" ]; then
  prefix=$(realpath "$build")/usr
else
  prefix=$place/fascia
  cmake --install "$build" --prefix "$prefix" >"$place/log" || { cat "$place/log"; exit 1; }
  test "$(wc -l <"$place/log")" -gt 5 || { echo "nothing was installed"; exit 1; }
fi

cmake -S "$source/consumer" -B "$place/consumer" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
cmake --build "$place/consumer" >/dev/null
grep -q "fascia_DIR:PATH=$prefix" "$place/consumer/CMakeCache.txt" || { echo "another fascia was found"; exit 1; }
for program in shared_c99 static_c99 shared_cxx20; do
  "$place/consumer/$program" "$rig" || { echo "$program failed"; exit 1; }
done
if ldd "$place/consumer/static_c99" | grep -q libfascia; then echo "the static program needs the shared library"; exit 1; fi

pc=$(find "$prefix" -name fascia.pc)
libraries=$(dirname "$(dirname "$pc")")
flags=$(PKG_CONFIG_PATH=$(dirname "$pc") pkg-config --cflags --libs fascia)
cc -std=c99 -Wall -Wextra -Werror "$source/consumer/play.c" -o "$place/by_pkg_config" $flags -lm
LD_LIBRARY_PATH=$libraries "$place/by_pkg_config" "$rig"

# What is compiled in comes with its licence, and the bill of materials names it.
if [ -x "$prefix/bin/fascia" ] && [ -e /usr/share/doc/libeigen3-dev/copyright ]; then
  bash "$source/../../scripts/sbom.sh" "$prefix" -o "$place/fascia.spdx.json" >/dev/null
  python3 - "$place/fascia.spdx.json" "$prefix/share/doc/fascia/third_party" <<'PYTHON'
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

# Where only the archive is, --static names all that it stands on.
mkdir "$place/static"
cp -r "$libraries/pkgconfig" "$libraries/libfascia.a" "$place/static/"
sed -i "s|^includedir=.*|includedir=$prefix/include|; s|^libdir=.*|libdir=$place/static|" "$place/static/pkgconfig/fascia.pc"
flags=$(PKG_CONFIG_PATH=$place/static/pkgconfig pkg-config --static --cflags --libs fascia)
cc -std=c99 -Wall -Wextra -Werror "$source/consumer/play.c" -o "$place/static_by_pkg_config" $flags
"$place/static_by_pkg_config" "$rig"
if ldd "$place/static_by_pkg_config" | grep -q libfascia; then echo "--static made a shared program"; exit 1; fi

library=$(find "$prefix" -name 'libfascia.so.*.*.*')
readelf -d "$library" | grep -q 'SONAME.*libfascia\.so\.0' || { echo "no SONAME"; exit 1; }
if nm -D --defined-only "$library" | awk '{print $3}' | grep -v '^fascia_\|^FASCIA_0'; then echo "symbols that are not the interface's"; exit 1; fi

if [ -x "$prefix/bin/fascia" ]; then
  "$prefix/bin/fascia" --version
  page=$(find "$prefix/share/man/man1" -name 'fascia.1*')
  case "$page" in *.gz) gzip -dc "$page" ;; *) cat "$page" ;; esac | grep -q '[.]SH NAME'
  bash -c "set -e; . '$prefix/share/bash-completion/completions/fascia'; COMP_WORDS=(fascia bu); COMP_CWORD=1; _fascia; \
           test \"\${COMPREPLY[0]}\" = build"
  zsh_file=$prefix/share/zsh/vendor-completions/_fascia fish_file=$prefix/share/fish/vendor_completions.d/fascia.fish
  grep -q "'build:" "$zsh_file" && grep -q ' -a build' "$fish_file"
  if command -v zsh >/dev/null; then zsh -n "$zsh_file"; fi
  if command -v fish >/dev/null; then
    fish -c "source '$fish_file'; complete -C 'fascia bu'" | grep -q '^build'
    fish -c "source '$fish_file'; complete -C 'fascia build --det'" | grep -q '^--detail'
  fi

  # samples/snapshot: a head's regression test holds, and fails for one whose jaw opens by another angle.
  LC_ALL=C sed 's/"openAngle":0\.4/"openAngle":0.3/' "$head" >"$place/changed.glb"
  if cmp -s "$head" "$place/changed.glb"; then echo "the head's jaw is not where this test looks for it"; exit 1; fi
  for rig_to_test in "$head" "$place/changed.glb"; do
    rm -rf "$place/snapshot"
    cmake -S "$source/../../samples/snapshot" -B "$place/snapshot" -DHEAD="$rig_to_test" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
    held=yes
    ctest --test-dir "$place/snapshot" --output-on-failure >"$place/snapshot/log" 2>&1 || held=no
    if [ "$rig_to_test" = "$head" ]; then expected=yes; else expected=no; fi
    [ $held = $expected ] || { cat "$place/snapshot/log"; echo "samples/snapshot: held: $held, expected: $expected"; exit 1; }
  done
  grep -q 'half_open' "$place/snapshot/log" || { cat "$place/snapshot/log"; echo "the changed jaw is not what fails"; exit 1; }
  test -s "$place/snapshot/reports/my_head.html"
  echo "samples/snapshot: the head's test holds, and a changed jaw fails it"
fi
if [ -f "$(find "$prefix" -name fascia_builder_targets.cmake)" ]; then
  cmake -S "$source/builder_consumer" -B "$place/builder" -DCMAKE_PREFIX_PATH="$prefix" >/dev/null
  cmake --build "$place/builder" >/dev/null
  "$place/builder/landmarks"
fi
