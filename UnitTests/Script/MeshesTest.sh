#!/usr/bin/env bash
# MeshesTest.sh ROOT NODE: the meshes of Samples/Meshes are those that make.mjs writes.
set -euo pipefail
folder=$(mktemp -d)
trap 'rm -r "$folder"' EXIT
"$2" "$1/Samples/Meshes/make.mjs" "$folder"
for mesh in "$1"/Samples/Meshes/*.obj; do cmp "$mesh" "$folder/$(basename "$mesh")"; done
