#!/usr/bin/env bash
# VersionTest.sh FOLDER: the newest heading of the change log and the npm package have the version of Version.h, and so has the tag of a
# commit that is tagged.
set -euo pipefail
cd "$1"

number() { sed -nE "s/^#define FULCRUM_VERSION_$1 ([0-9]+)$/\1/p" Version.h; }
version=$(number MAJOR).$(number MINOR).$(number PATCH)
heading=$(sed -nE 's/^## ([^,]+), .*$/\1/p' CHANGELOG.md | head -n 1)
if [[ $heading != "$version" ]]; then
    echo "CHANGELOG.md begins with version '$heading', Version.h says $version"
    exit 1
fi
if ! grep -qF "\"version\": \"$version\"" Web/Package/package.json; then
    echo "Web/Package/package.json has another version than Version.h, $version"
    exit 1
fi
# A source archive has no tags.
[[ -e .git ]] && command -v git >/dev/null || exit 0
tag=$(git -c safe.directory='*' tag --points-at HEAD --list 'v*')
if [[ -n $tag && $tag != "v$version" ]]; then
    echo "this commit is tagged $tag, Version.h says $version"
    exit 1
fi
if [[ -n $tag ]] && grep -qE "^## $version, in development$" CHANGELOG.md; then
    echo "this commit is tagged $tag, CHANGELOG.md calls it in development"
    exit 1
fi
