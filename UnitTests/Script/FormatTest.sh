#!/usr/bin/env bash
# FormatTest.sh ROOT CLANG_FORMAT: whether every source file is as clang-format would write it; names the first lines that are not.
set -euo pipefail
cd "$1"
find Assets Collision Constraints Jobs Math PerformanceTest Physics Samples UnitTests Web -name node_modules -prune -o -name '*.h' -print0 -o -name '*.cpp' -print0 |
    xargs -0 "$2" --dry-run -Werror --ferror-limit=1 ./*.h
