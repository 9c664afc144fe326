#!/bin/sh
# Doxygen reads the C headers through this: their plain comments, which any C compiler takes, become documentation.
sed -E 's@^( *)/\* @\1/** @; s@([;,{]) +/\* @\1 /**< @' "$1"
