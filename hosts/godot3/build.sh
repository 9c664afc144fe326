#!/usr/bin/env bash
# Builds project/libfascia_godot.so: build.sh FOLDER_OF_GODOT_HEADERS FASCIA_INCLUDE FASCIA_LIBRARY_FOLDER
# The headers are modules/gdnative/include of Godot's source with gdnative_api_struct.gen.h, or the tag
# godot-3.2.3-stable of godot-headers. headers.sh takes them from Debian's source package.
set -euo pipefail
cd "$(dirname "$0")"
cc -std=c99 -Wall -Wextra -O2 -fPIC -shared -I"$1" -I"$2" fascia_godot.c -L"$3" -lfascia -Wl,-rpath,"$3" -o project/libfascia_godot.so
