#!/bin/sh
# A stream of landmarks as lines of JSON gives the curves that the same stream gives as a table; a line with another
# number of points is refused by its number.
#   json_stream.sh SAMPLE_CAPTURE RIG.glb STREAM.csv
set -eu
awk -F, 'NR > 1 {
  printf "{\"time\": %s, \"points\": [", $1
  for (i = 2; i <= NF; i += 3) {
    if (i > 2) printf ", "
    if ($i == "") printf "null"; else printf "[%s, %s, %s]", $i, $(i + 1), $(i + 2)
  }
  print "]}"
}' "$3" | tr -d '\r' >stream.jsonl
grep -q null stream.jsonl
"$1" "$2" "$3" -o table.csv
"$1" "$2" - -o json.csv <stream.jsonl
cmp table.csv json.csv
(head -n 3 stream.jsonl && echo '{"time": 9, "points": [[1, 2, 3]]}') >short.jsonl
if "$1" "$2" short.jsonl 2>short.txt; then exit 1; fi
grep -q 'line 4' short.txt
