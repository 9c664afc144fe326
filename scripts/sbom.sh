#!/usr/bin/env bash
# Writes the bill of materials of an installed Fascia as SPDX 2.3, and gathers the licences of what it contains.
#   scripts/sbom.sh INSTALLED_FOLDER [-o FILE.spdx.json]      default: INSTALLED_FOLDER/share/doc/fascia/fascia.spdx.json
# The licences go beside that file, into third_party/.
set -euo pipefail
root=$(cd "$(dirname "$0")/.." && pwd)
[ $# -ge 1 ] && [ -d "$1" ] || { echo "usage: scripts/sbom.sh INSTALLED_FOLDER [-o FILE]" >&2; exit 2; }
prefix=$(cd "$1" && pwd)
output=$prefix/share/doc/fascia/fascia.spdx.json
[ "${2:-}" != -o ] || output=$3
mkdir -p "$(dirname "$output")/third_party"

# Debian package, SPDX licence, how it is contained. Headers and static libraries leave no trace in the programs, so they are listed.
compiled_in='libeigen3-dev MPL-2.0
nlohmann-json3-dev MIT
libtinygltf-dev MIT
libtinyobjloader-dev MIT
libcli11-dev BSD-3-Clause
libstb-dev MIT
libnanoflann-dev BSD-2-Clause
libxxhash-dev BSD-2-Clause
libimgui-dev MIT
fonts-dejavu-core Bitstream-Vera'
# What programs and libraries load, by SPDX licence of the Debian package.
declare -A licence=(
  [libc6]=LGPL-2.1-or-later [libstdc++6]='GPL-3.0-or-later WITH GCC-exception-3.1' [libgcc-s1]='GPL-3.0-or-later WITH GCC-exception-3.1'
  [libtbb12]=Apache-2.0 [libtbbmalloc2]=Apache-2.0 [libtbbbind-2-5]=Apache-2.0 [libembree3-3]=Apache-2.0 [libmeshoptimizer2d]=MIT [libdraco7]=Apache-2.0
  [libepoxy0]=MIT [libegl1]=MIT [libglvnd0]=MIT [libgl1]=MIT [zlib1g]=Zlib [libbullet3.24]=Zlib [libglfw3]=Zlib [libstb0]=MIT [libtinyobjloader2rc10]=MIT)

escaped() { printf '%s' "$1" | sed 's/\\/\\\\/g; s/"/\\"/g'; }
version=$(sed -n 's/^project(fascia VERSION \([0-9.]*\).*/\1/p' "$root/CMakeLists.txt")
# The same files give the same document.
created=$(date -u -d "@${SOURCE_DATE_EPOCH:-0}" +%Y-%m-%dT%H:%M:%SZ)

packages='' relations='' files='' hashes=''
add_package() {  # Debian package, licence, relation
  local id="SPDXRef-$(printf '%s' "$1" | tr -c 'A-Za-z0-9.-' '-')" found
  found=$(dpkg-query -W -f='${Version}' "$1" 2>/dev/null) || return 0
  packages+=",
  {\"SPDXID\": \"$id\", \"name\": \"$1\", \"versionInfo\": \"$(escaped "$found")\", \"downloadLocation\": \"https://packages.debian.org/bookworm/$1\", \"filesAnalyzed\": false, \"licenseConcluded\": \"$2\", \"licenseDeclared\": \"$2\", \"copyrightText\": \"NOASSERTION\", \"supplier\": \"Organization: Debian\"}"
  relations+=",
  {\"spdxElementId\": \"SPDXRef-fascia\", \"relationshipType\": \"$3\", \"relatedSpdxElement\": \"$id\"}"
  local copyright=/usr/share/doc/${1%%:*}/copyright
  [ ! -e "$copyright" ] || cp -L "$copyright" "$(dirname "$output")/third_party/${1%%:*}.txt"
}

while read -r package spdx; do add_package "$package" "$spdx" CONTAINS; done <<<"$compiled_in"

loaded=$(find "$prefix" -type f \( -perm -u+x -o -name '*.so*' \) -exec sh -c 'for f; do ldd "$f" 2>/dev/null; done' _ {} + |
  sed -n 's/.*=> \(\/[^ ]*\) .*/\1/p' | sort -u | { grep -v "^$prefix" || true; })
direct=$(find "$prefix" -type f \( -perm -u+x -o -name '*.so*' \) -exec sh -c 'for f; do readelf -d "$f" 2>/dev/null; done' _ {} + |
  sed -n 's/.*(NEEDED).*\[\(.*\)\]/\1/p' | sort -u)
owners=''
for library in $loaded; do
  grep -qxF "$(basename "$library")" <<<"$direct" || continue
  owner=$(dpkg -S "$(readlink -f "$library")" 2>/dev/null | head -1 | cut -d: -f1) || true
  [ -z "$owner" ] || owners+="$owner"$'\n'
done
for owner in $(sort -u <<<"$owners"); do add_package "$owner" "${licence[$owner]:-NOASSERTION}" DYNAMIC_LINK; done

number=0
while IFS= read -r file; do
  [ "$prefix/$file" != "$output" ] || continue
  case "$file" in *third_party/*) continue ;; esac
  number=$((number + 1))
  sum=$(sha1sum "$prefix/$file" | cut -d' ' -f1)
  hashes+="$sum"$'\n'
  files+="$([ $number = 1 ] || printf ,)
  {\"SPDXID\": \"SPDXRef-file-$number\", \"fileName\": \"./$(escaped "$file")\", \"checksums\": [{\"algorithm\": \"SHA1\", \"checksumValue\": \"$sum\"}, {\"algorithm\": \"SHA256\", \"checksumValue\": \"$(sha256sum "$prefix/$file" | cut -d' ' -f1)\"}], \"licenseConcluded\": \"MIT\", \"copyrightText\": \"NOASSERTION\"}"
  relations+=",
  {\"spdxElementId\": \"SPDXRef-fascia\", \"relationshipType\": \"CONTAINS\", \"relatedSpdxElement\": \"SPDXRef-file-$number\"}"
done < <(cd "$prefix" && find . -type f -printf '%P\n' | LC_ALL=C sort)
verification=$(printf '%s' "$hashes" | LC_ALL=C sort | tr -d '\n' | sha1sum | cut -d' ' -f1)

cat >"$output.part" <<JSON
{"spdxVersion": "SPDX-2.3", "dataLicense": "CC0-1.0", "SPDXID": "SPDXRef-DOCUMENT", "name": "fascia-$version",
 "documentNamespace": "https://fascia.invalid/spdx/fascia-$version-$verification",
 "creationInfo": {"created": "$created", "creators": ["Tool: fascia-sbom-$version"]},
 "packages": [
  {"SPDXID": "SPDXRef-fascia", "name": "fascia", "versionInfo": "$version", "downloadLocation": "NOASSERTION", "filesAnalyzed": true,
   "packageVerificationCode": {"packageVerificationCodeValue": "$verification"}, "licenseConcluded": "MIT", "licenseDeclared": "MIT",
   "licenseInfoFromFiles": ["NOASSERTION"], "copyrightText": "$(escaped "$(sed -n 's/^\(Copyright.*\)/\1/p' "$root/LICENSE" | head -1)")"}$packages],
 "files": [$files],
 "relationships": [
  {"spdxElementId": "SPDXRef-DOCUMENT", "relationshipType": "DESCRIBES", "relatedSpdxElement": "SPDXRef-fascia"}$relations]}
JSON
mv "$output.part" "$output"
echo "wrote $output: $number files"
