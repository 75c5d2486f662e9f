#!/usr/bin/env bash
# SuitesTest.sh ROOT: ./fulcrum test adds up what its suites say, fails where one does, and tells what took long. Compilers and programs
# of tests are stubs.
set -uo pipefail

fail_test() {
    echo "$*" >&2
    exit 1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
mkdir -p "$work"/{tools,Docs,Web,Samples/Viewer,UnitTests/Fuzz}
echo 'const FuzzTarget kShapes{"shapes",' >"$work/UnitTests/Fuzz/Shapes.cpp"
cp -r "$1/fulcrum" "$1/Scripts" "$work/"
cd "$work" || exit 1
sed -i '/^require() {/,/^}/d' fulcrum
printf 'require() { [[ ! -e $WORK/lacks || " $* " != *emscripten* ]] || fail "no emscripten"; }\ninstall_package_tools() { :; }\n' >>Scripts/Jobs.sh
sed -i '/^install_package_tools() {/,/^}/d' fulcrum
cat >Docs/figures.json <<'JSON'
{
  "processor_seconds": {
    "release": 0,
    "asan": 1000
  }
}
JSON

# One of eight shards has the tests.
cat >tools/tests-stub <<'STUB'
#!/usr/bin/env bash
[[ ${GTEST_SHARD_INDEX:-0} == 0 ]] || exit 0
# More than half a second of a processor, however fast it is.
if [[ -n ${BUSY:-} && $0 == */release/* ]]; then
    until times >"$WORK/times" && read -r user _ <"$WORK/times" && ((10#${user//[!0-9]/} >= 700)); do
        for ((i = 0; i < 1000; i++)); do :; done
    done
fi
echo "[       OK ] Quick.IsQuick (3 ms)"
echo "[       OK ] Slow.IsSlow$(basename "$(dirname "$(dirname "$0")")") (4321 ms)"
[[ ! -e $WORK/crashes ]] || { echo "[ RUN      ] Bad.Crashes"; kill -SEGV $$; }
STUB
cat >tools/cmake <<'STUB'
#!/usr/bin/env bash
echo "cmake $*" >>"$WORK/calls"
while (($# > 0)); do [[ $1 == -B ]] && mkdir -p "$2" && touch "$2/build.ninja"; shift; done
STUB
cat >tools/ninja <<'STUB'
#!/usr/bin/env bash
echo "ninja $*" >>"$WORK/calls"
[[ ! -e $WORK/breaks ]] || { echo "error: broken"; exit 1; }
mkdir -p "$2/bin"
for program in FulcrumTests FulcrumAccuracyTests FulcrumParityTests; do cp "$WORK/tools/tests-stub" "$2/bin/$program"; done
printf '#!/bin/sh\necho "1 worse, 2 better; errors: 3 the same"\n' >"$2/bin/fulcrum-accuracy"
printf '#!/bin/sh\n' >"$2/bin/fulcrum-runner"
printf '#!/bin/sh\necho "Done 5 runs in 1 second"\n' >"$2/bin/FulcrumFuzz"
chmod +x "$2"/bin/*
STUB
cat >tools/ctest <<'STUB'
#!/usr/bin/env bash
echo "1/2 Test #1: Script.Long ......   Passed   12.34 sec"
echo "2/2 Test #2: Script.None ......***Skipped   0.10 sec"
echo "100% tests passed, 0 tests failed out of 2"
STUB
cat >tools/node <<'STUB'
#!/usr/bin/env bash
printf 'ok 1 - a page is drawn\n  ---\n  duration_ms: 7654.3\n  ...\n# pass 1\n# fail 0\n'
STUB
chmod +x tools/*
export WORK=$work PATH=$work/tools:$PATH

expect() { grep -qE -- "$1" said || fail_test "it does not say '$1': $(cat said)"; }

./fulcrum test --quick >said 2>errors && fail_test "an error of the lab is no failure: $(cat said)"
expect '^release +2 passed, +0 failed'
expect '^programs +1 passed, +0 failed, +1 skipped'
expect '^skipped: Script.None$'
expect '^lab +5 passed, +1 failed'
expect '12.3 s +Script.Long +\(programs\)'
expect '4.3 s +Slow.IsSlowrelease +\(release\)'
expect '^10 passed, 1 failed$'
! grep -q asan calls || fail_test "--quick builds more: $(cat calls)"

sed -i 's/echo "1 worse/echo "0 worse/' tools/ninja
BUSY=1 ./fulcrum test --strict >said 2>errors || fail_test "it fails: $(cat said errors)"
expect '^tsan +2 passed'
expect '7.7 s +a page is drawn +\(webassembly\)'
expect 's  release: more than its share of 0 s'
! grep -q 'asan: more' said || fail_test "$(cat said)"
expect '^16 passed, 0 failed$'
grep -q -- '-B build/tsan .*WARNINGS_AS_ERRORS=ON.*FULCRUM_UNITY=OFF' calls || fail_test "$(cat calls)"

touch crashes
./fulcrum test --quick >said 2>errors && fail_test "a crash is no failure: $(cat said)"
expect 'exit status 139 in Bad.Crashes'
rm crashes
touch breaks
./fulcrum test --quick >said 2>errors && fail_test "a build that fails is no failure: $(cat said)"
expect '^0 passed, 1 failed$'
! grep -q "can't read" errors || fail_test "$(cat errors)"
! grep -q Slow.IsSlow said || fail_test "it tells of tests that an earlier command ran: $(cat said)"
rm breaks
# What is missing is told before any suite has begun.
touch lacks
rm calls
./fulcrum test >said 2>errors && fail_test "a missing package is no failure: $(cat said)"
grep -q 'no emscripten' errors && [[ ! -e calls ]] || fail_test "$(cat said errors calls)"
rm lacks
# Lost output is no success.
./fulcrum fuzz --seconds 1 >said 2>errors || fail_test "fuzzing fails: $(cat said errors)"
expect '^shapes +Done 5 runs'
[[ -e /dev/full ]] || exit 0
! ./fulcrum test --quick >/dev/full 2>errors || fail_test "lost output is success"
! ./fulcrum fuzz --seconds 1 >/dev/full 2>errors || fail_test "lost output of fuzz is success"
