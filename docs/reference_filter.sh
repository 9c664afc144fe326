#!/bin/sh
# Doxygen reads the headers through this: "#vertices" in a comment is a number of vertices and no link, and each member of the
# table of fascia/api.h is described as the function that it is.
case "$1" in
  */fascia/api.h)
    sed -E 's@^( +)(.*\(\*([a-z_]+)\)\(.*)$@\1/** fascia_\3(): \\copybrief fascia_\3 */ \2@' "$1" ;;
  *)
    sed -E '/\/\/\//s@#([a-z])@\\#\1@g' "$1" ;;
esac
