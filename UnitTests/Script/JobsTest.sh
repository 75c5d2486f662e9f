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

# start NAME: a run in the background, its process in `script`. It heeds signals although what a shell starts there ignores SIGINT, and
# whatever this test was started with.
start() {
    env --default-signal=INT,TERM,HUP ./fulcrum run pyramid >"said.$1" 2>&1 &
    script=$!
}
has_begun() { [[ $(grep -c 'ninja begins' calls 2>/dev/null) == "$1" ]]; }
is_gone() { ! kill -0 -- "$1" 2>/dev/null; }
are_gone() {
    local process
    for process in $(cat processes); do is_gone "$process" || return 1; done
}

# Ended by each signal, with whatever it has started.
begun=0
for signal in TERM HUP INT; do
    start $signal
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
# Another that waits can be ended meanwhile.
second=$script
start waits
eventually grep -q 'waiting for another' said.waits
kill "$script"
eventually is_gone "$script"
touch go
wait "$first" || fail_test "the first fails: $(cat said.first)"
wait "$second" || fail_test "the second fails: $(cat said.second)"
has_begun 5 || fail_test "the second did not build"
grep -qx 'runs run pyramid' said.second || fail_test "the second says: $(cat said.second)"
[[ $(sed -n '/ninja/p' calls | tail -n 4 | tr '\n' ' ') == 'ninja begins ninja ends ninja begins ninja ends ' ]] ||
    fail_test "builds overlap: $(cat calls)"

# What is configured while another waits is what it then builds: no tests are taken from a build that has them.
exec 9<>build/.release.lock
flock 9
rm build/release/.fulcrum-options
configured=$(grep -c cmake calls)
start third 9>&-
eventually grep -q 'waiting for another' said.third
echo 'release -DFULCRUM_BUILD_TESTS=ON' >build/release/.fulcrum-options
exec 9>&-
wait "$script" || fail_test "the third fails: $(cat said.third)"
[[ $(grep -c cmake calls) == "$configured" ]] || fail_test "it configures anew: $(cat calls)"

# A script that fails leaves no job behind, either; whoever adopts its processes takes a moment to see that they have ended.
bash -c 'source Scripts/Jobs.sh; stop_with_jobs; start_job said.job sleep 1000; echo "$job"; sleep 0.3; exit 3' >job
[[ $? == 3 ]] || fail_test "the status of a script with jobs is lost"
eventually is_gone "-$(<job)"

# The first half minute is not silent: it says what it does while it does it.
grep -q 'The first build takes' said.TERM || fail_test "a first run says: $(cat said.TERM)"
