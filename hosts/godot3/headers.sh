#!/usr/bin/env bash
# Puts GDNative's headers of Debian's Godot 3 into a folder: headers.sh FOLDER. Needs apt and the network; exit 77 without.
set -euo pipefail
folder=$(realpath -m "$1")
[ -f "$folder/include/gdnative_api_struct.gen.h" ] && exit 0
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work/state/lists/partial" "$work/cache/archives/partial" "$work/etc" "$folder"
printf 'Types: deb-src\nURIs: http://deb.debian.org/debian\nSuites: bookworm\nComponents: main\nSigned-By: /usr/share/keyrings/debian-archive-keyring.gpg\n' \
  >"$work/etc/source.sources"
apt=(apt-get -qq -o Dir::Etc::sourcelist=/dev/null -o Dir::Etc::sourceparts="$work/etc" -o Dir::State="$work/state" -o Dir::Cache="$work/cache")
unreachable() { echo "Debian's source package of Godot 3 cannot be reached"; exit 77; }
command -v apt-get >/dev/null || unreachable
timeout 120 "${apt[@]}" -o Acquire::Retries=1 -o APT::Update::Error-Mode=any update || unreachable
(cd "$work" && timeout 180 "${apt[@]}" source --download-only godot3) || unreachable
(cd "$work" && tar xzf godot_*.orig.tar.gz --wildcards '*/modules/gdnative/*' --strip-components=3)
cp -r "$work/include" "$folder/"
cd "$work"
python3 - "$folder/include/gdnative_api_struct.gen.h" <<'PYTHON'
import json, sys
source = open("gdnative_builders.py").read().split("if __name__")[0].replace("from platform_methods import subprocess_main", "")
names = {}
exec(source, names)
open(sys.argv[1], "w").write(names["_build_gdnative_api_struct_header"](json.load(open("gdnative_api.json"))))
PYTHON
