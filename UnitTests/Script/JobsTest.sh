#!/usr/bin/env bash
# JobsTest.sh ROOT: what ends the script ends what it has started, and is not called a failed build; one builds in a folder at a
# time. Ninja, CMake and compilers are stubs.
set -uo pipefail

fail_test() {
    echo "$*" >&2
    exit 1
}
# eventually COMMAND...: it becomes true, or the test ends after a minute.
eventually() {
    local i
    for ((i = 0; i < 600; i++)); do
        "$@" && return
        sleep 0.1
    done
    fail_test "never: $* ($(tail -n 5 "$work"/said* "$work/calls" 2>&1))"
}

work=$(mktemp -d)
trap 'touch "$work/go"; sleep 0.2; rm -rf "$work"' EXIT
cp -r "$1/fulcrum" "$1/Scripts" "$work/"
cd "$work" || exit 1
mkdir -p tools Samples/Scenes
echo '.name = "pyramid"' >Samples/Scenes/Pyramid.cpp

# CMake configures at once; Ninja starts a compiler that runs until the file `go` is there, and a program.
cat >tools/cmake <<'STUB'
#!/usr/bin/env bash
echo "cmake" >>"$WORK/calls"
mkdir -p build/release && touch build/release/build.ninja
STUB
cat >tools/ninja <<'STUB'
#!/usr/bin/env bash
echo "ninja begins" >>"$WORK/calls"
cc1plus-stub &
echo "$$ $!" >>"$WORK/processes"
wait
mkdir -p "$WORK/build/release/bin"
printf '#!/bin/sh\necho "runs $*"\n' >"$WORK/build/release/bin/fulcrum-runner"
chmod +x "$WORK/build/release/bin/fulcrum-runner"
echo "ninja ends" >>"$WORK/calls"
STUB
cat >tools/cc1plus-stub <<'STUB'
#!/usr/bin/env bash
while [[ ! -e $WORK/go ]]; do sleep 0.1; done
STUB
chmod +x tools/*
export WORK=$work PATH=$work/tools:$PATH
# Whatever a build needs is taken to be there.
printf 'require() { :; }\n' >>Scripts/Jobs.sh
sed -i '/^require() {/,/^}/d' fulcrum

# start NAME: a run in the background, its process in `script`.
start() {
    ./fulcrum run pyramid >"said.$1" 2>&1 &
    script=$!
}
has_begun() { [[ $(grep -c 'ninja begins' calls 2>/dev/null) == "$1" ]]; }
are_gone() {
    local process
    for process in $(cat processes); do
        ! kill -0 "$process" 2>/dev/null || return 1
    done
}

# Ended by each signal, with whatever it has started.
begun=0
for signal in TERM HUP INT; do
    # A script in the background ignores SIGINT from its beginning, unless it is a job of a shell with job control.
    set -m
    start $signal
    set +m
    begun=$((begun + 1))
    eventually has_begun $begun
    kill -s $signal "$script"
    wait "$script"
    status=$?
    ((status == 128 + $(kill -l $signal))) || fail_test "after SIG$signal its status is $status: $(cat said.$signal)"
    eventually are_gone
    ! grep -q 'failed' said.$signal || fail_test "SIG$signal is called a failure: $(cat said.$signal)"
    grep -q 'fulcrum: stopped' said.$signal || fail_test "after SIG$signal it says: $(cat said.$signal)"
done
! grep -q 'ninja ends' calls || fail_test "ninja ended by itself"

# Two at once: the second waits, says so, and builds when the first has ended.
start first
first=$script
eventually has_begun 4
start second
eventually grep -q "waiting for another ./fulcrum that is at work in build/release (process $first)" said.second
has_begun 4 || fail_test "two build at once"
touch go
wait "$first" || fail_test "the first fails: $(cat said.first)"
wait "$script" || fail_test "the second fails: $(cat said.second)"
has_begun 5 || fail_test "the second did not build"
grep -qx 'runs run pyramid' said.second || fail_test "the second says: $(cat said.second)"
[[ $(sed -n '/ninja/p' calls | tail -n 4 | tr '\n' ' ') == 'ninja begins ninja ends ninja begins ninja ends ' ]] ||
    fail_test "builds overlap: $(cat calls)"

# The first half minute is not silent: it says what it does while it does it.
grep -q 'The first build takes' said.TERM || fail_test "a first run says: $(cat said.TERM)"
