#!/bin/sh
# Doxygen reads the headers through this: "#vertices" in a comment is a number of vertices and no link, and the plain comments of the
# public headers, which any C compiler takes, become documentation.
case "$1" in
  */include/fascia/*)
    sed -E '1s@^@/** \\file */ @; s@^( *)/\* @\1/** @; s@([;,{]) +/\* @\1 /**< @; s@^( *)// @\1/// @; s@([;,{]) +// @\1 ///< @' "$1" ;;
  *)
    sed -E '/\/\/\//s@#([a-z])@\\#\1@g' "$1" ;;
esac
