#!/usr/bin/env bash
# HelpTest.sh FOLDER: help neither configures nor builds, whether or not the program is there and however its folder was
# configured; and a folder with tests, configured by hand, keeps them.
set -uo pipefail

fail_test() {
    echo "$*" >&2
    exit 1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$1/fulcrum" "$1/Scripts" "$work/"
cd "$work" || exit 1
# Whoever configures or builds leaves a trace, and fails.
mkdir tools
for tool in cmake apt-get; do
    printf '#!/bin/sh\necho "%s $*" >>"%s/calls"\nexit 1\n' $tool "$work" >tools/$tool
    chmod +x tools/$tool
done
export PATH=$work/tools:$PATH

# Every command, with nothing built.
commands=(run export drop replay shrink test fuzz bench accuracy advise list gallery web figures docs setup)
for command in "${commands[@]}"; do
    for form in "help $command" "$command --help" "$command -h"; do
        # shellcheck disable=SC2086
        output=$(./fulcrum $form 2>&1) || fail_test "$form fails: $output"
        [[ $output == "  $command"* ]] || fail_test "$form says: $output"
    done
done
[[ ! -e calls && ! -e build ]] || fail_test "help of what is not built leaves: $(ls) $(cat calls)"

# With programs in a folder that was configured by hand, help is theirs, and the folder stays as it is.
mkdir -p build/release/bin
echo 'FULCRUM_BUILD_TESTS:BOOL=ON' >build/release/CMakeCache.txt
touch build/release/build.ninja
for program in fulcrum-runner fulcrum-bench fulcrum-accuracy; do
    printf '#!/bin/sh\necho "%s: $*"\n' $program >build/release/bin/$program
    chmod +x build/release/bin/$program
done
before=$(ls -R build)
expect() {
    local output
    output=$(./fulcrum "$1" --scene pyramid --help 2>&1) || fail_test "$1 --help fails: $output"
    [[ ${output##*$'\n'} == "$2" ]] || fail_test "$1 --help says: $output"
}
expect run 'fulcrum-runner: run --help'
expect drop 'fulcrum-runner: drop --help'
expect bench 'fulcrum-bench: --help'
expect accuracy 'fulcrum-accuracy: --help'
expect advise 'fulcrum-accuracy: advise --help'
[[ ! -e calls && $(ls -R build) == "$before" ]] || fail_test "help changes the build: $(ls -R build) $(cat calls)"

# A command that does build configures it with what it had.
source ./fulcrum
require() { :; }
build() { echo "$3"; }
[[ $(build_program fulcrum-bench) == -DFULCRUM_BUILD_TESTS=ON ]] || fail_test "a folder configured by hand loses its tests"
[[ $(build_program fulcrum-bench -DFULCRUM_PEER_BULLET=ON) == '-DFULCRUM_BUILD_TESTS=ON -DFULCRUM_PEER_BULLET=ON' ]] ||
    fail_test "an option is lost"
rm build/release/CMakeCache.txt
[[ $(build_program fulcrum-bench) == -DFULCRUM_BUILD_TESTS=OFF ]] || fail_test "an empty folder gets tests"
