# ./fulcrum test: its suites, what they found and what they took. Sourced by ./fulcrum.

# ---- Results ----------------------------------------------------------------------------------------------------------

# What a suite may take, in seconds of processors, whatever else the machine does: Docs/figures.json.
share_of() {
    sed -n '/"processor_seconds"/,/}/p' "$root/Docs/figures.json" | sed -nE "s/.*\"$1\": ([0-9]+).*/\1/p"
}

# took NAME: all seconds of processors since the last call are of this suite.
took() {
    seconds=$(((spent - counted + 500) / 1000)) counted=$spent
    echo "$seconds $1" >>"$logs/seconds"
}

# count NAME PASSED FAILED LOG: adds to the totals, prints the suite's line and where it failed. A skipped test has
# neither passed nor failed: it is counted apart and named, since it checks nothing.
count() {
    local -a unchecked
    local seconds
    mapfile -t unchecked < <(sed -nE 's/.*Test +#[0-9]+: ([^ ]+) .*\*\*\*Skipped .*/\1/p; s/^\[  SKIPPED \] ([^ ]+) \([0-9]+ ms\)$/\1/p' "$4")
    passed=$((passed + $2)) failed=$((failed + $3)) skipped=$((skipped + ${#unchecked[@]}))
    took "$1"
    printf '%-28s %5d passed, %3d failed, %3d skipped  (%d s of processors)\n' "$1" "$2" "$3" "${#unchecked[@]}" "$seconds"
    ((${#unchecked[@]} == 0)) || printf 'skipped: %s\n' "${unchecked[@]}"
    if (($3 > 0)); then
        grep -E '^\[  FAILED  \]|\*\*\*[^S]|^not ok|Failure$|ERROR: |WARNING: ThreadSanitizer|runtime error' "$4" | head -n 20
        echo "(whole log: $4)"
    fi
}

# build_or_count NAME FOLDER PRESET OPTIONS TARGET...: a build that fails counts as one failed test of that suite.
build_or_count() {
    local name=$1 seconds status=0
    shift
    build "$@" || status=1
    took "build of $name"
    ((status == 0)) || count "$name" 0 1 "$logs/$1.log"
    return $status
}

# "milliseconds name" of each test of a log, of GoogleTest, CTest or node.
times_in() {
    sed -nE 's/^\[       OK \] ([^ ]+) \(([0-9]+) ms\)$/\2 \1/p
        s/.*Test +#[0-9]+: ([^ ]+) .* Passed +([0-9]+)\.([0-9])[0-9]* sec.*/\2\300 \1/p
        /^ok [0-9]+ - /{ s/^ok [0-9]+ - //; h; }
        /^  duration_ms: [0-9.]+$/{ G; s/^  duration_ms: ([0-9]+)[0-9.]*\n(.*)/\1 \2/p; }' "$1"
}

# The slowest tests and suites of all, and suites that have grown past their share, which is no failure.
print_times() {
    local suite seconds name share sum=0
    echo "Slowest tests, by the clock:"
    for suite in "${suites_run[@]}"; do
        [[ ! -f $logs/test-$suite.log ]] || times_in "$logs/test-$suite.log" | sed "s/\$/  ($suite)/"
    done | sort -rn | head -n 12 | awk '{ ms = $1; $1 = ""; printf "%7.1f s %s\n", ms / 1000, $0 }'
    echo "Suites, in seconds of processors, and their shares where they take more:"
    while read -r seconds name; do
        sum=$((sum + seconds)) share=$(share_of "$name")
        if [[ -n $share ]] && ((seconds > share)); then
            printf '%5d s  %s: more than its share of %d s\n' "$seconds" "$name" "$share"
        elif ((seconds >= 10)); then
            printf '%5d s  %s\n' "$seconds" "$name"
        fi
    done < <(sort -rn "$logs/seconds")
    printf '%5d s  all; %d s by the clock\n' "$sum" "$SECONDS"
}

# ---- Suites -----------------------------------------------------------------------------------------------------------

# What CTest knows of a build folder, chosen by the options that follow.
ctest_suite() {
    local name=$1 folder=$2 log=$logs/test-$1.log bad total idle
    shift 2
    logged "Running $name" "$log" ctest --test-dir "$root/build/$folder" -j 2 --output-on-failure \
        --timeout 900 "$@"
    read -r bad total < <(sed -nE 's/.*tests passed, ([0-9]+) tests? failed out of ([0-9]+)/\1 \2/p' "$log" | tail -n 1)
    [[ -n ${total:-} ]] || { bad=1 total=1; }
    idle=$(grep -cE 'Test +#[0-9]+: .*\*\*\*Skipped' "$log")
    count "$name" $((total - bad - idle)) "$bad" "$log"
}

# run_shards LOG COMMAND...: a program of tests in eight parts, two at a time. One process for each test takes as long again.
run_shards() {
    local log=$1 run='
        GTEST_SHARD_INDEX=$1 timeout --foreground 1800 "${@:3}" >"$2.$1" 2>&1
        status=$?
        ((status <= 1)) || echo "[  FAILED  ] exit status $status in$(grep "^\[ RUN" "$2.$1" | tail -n 1 | cut -c 13-)" >>"$2.$1"
        exit $((status != 0))'
    shift
    seq 0 7 | GTEST_TOTAL_SHARDS=8 xargs -P 2 -I{} bash -c "$run" - {} "$log" "$@"
    local status=$?
    cat "$log".[0-7]
    return $status
}

# gtest_suite NAME FOLDER PROGRAM FILTER COMMAND...: the tests of a program, which COMMAND starts. A crash counts as one failed
# test, and is named.
gtest_suite() {
    local name=$1 program=$root/build/$2/bin/$3 filter=$4 log=$logs/test-$1.log status good bad
    shift 4
    logged "Running $name" "$log" run_shards "$log" "$@" "$program" "--gtest_filter=$filter"
    status=$?
    good=$(grep -cE '^\[       OK \]' "$log")
    bad=$(grep -cE '^\[  FAILED  \] (.* \([0-9]+ ms\)$|exit status)' "$log")
    if (((status != 0 || good == 0) && bad == 0)); then bad=1; fi
    count "$name" "$good" "$bad" "$log"
}

# node_suite NAME FOLDER [VARIABLE=VALUE...] ARGUMENT...: tests of node, run in a folder.
node_suite() {
    local name=$1 folder=$2 log=$logs/test-$1.log good bad
    local -a variables=()
    shift 2
    while [[ $1 == *=* ]]; do
        variables+=("$1")
        shift
    done
    logged "Running $name" "$log" env -C "$folder" "${variables[@]}" node --test --test-reporter=tap "$@"
    good=$(sed -nE 's/^# pass ([0-9]+)/\1/p' "$log")
    bad=$(sed -nE 's/^# fail ([0-9]+)/\1/p' "$log")
    [[ ${good:-0} == 0 && ${bad:-0} == 0 ]] && bad=1
    count "$name" "${good:-0}" "$bad" "$log"
}

# The pages and the glTF file of short runs of the real programs, in a headless browser and in the validator.
record_for_viewer() {
    local runner=$root/build/release/bin/fulcrum-runner
    "$runner" run pyramid --steps 120 && "$runner" run hinge --record html && "$runner" run query_rays --steps 60 --record html &&
        "$runner" run springs --record html && "$runner" run sensors --record html &&
        "$root/build/release/bin/fulcrum-accuracy" --quick --once --scene incline --record "soft 1/60 4 1 1"
}
viewer_suite() {
    local log=$logs/test-viewer.log recording=$root/build/viewer-test
    mkdir -p "$recording"
    export -f record_for_viewer
    if ! logged "Recording scenes" "$log" env -C "$recording" root="$root" bash -c record_for_viewer; then
        tail -n 5 "$log"
        count viewer 0 1 "$log"
        return
    fi
    node_suite viewer "$root/Samples/Viewer" FULCRUM_RECORDING="$recording/out/pyramid" test/
}

# parity_suite NAME COMPILER PRESET OPTIONS [COMMAND...]: builds the parity tests and runs them.
parity_suite() {
    local name=$1 folder=$1
    build_or_count "$name" "$folder" "$3" "$4 -DCMAKE_CXX_COMPILER=$2" FulcrumParityTests || return
    gtest_suite "$name" "$folder" FulcrumParityTests '*' "${@:5}"
}

# The engine as WebAssembly: golden hashes and the npm package in node, the page in a headless browser.
web_suite() {
    local status=0 seconds
    build_web FulcrumGoldenTests FulcrumWebPage && install_package_tools || status=1
    took "build of webassembly"
    if ((status)); then
        count webassembly 0 1 "$logs/webassembly.log"
        return
    fi
    node_suite webassembly "$root/Web" FULCRUM_RUNNER="$root/build/release/bin/fulcrum-runner" Package/test/ Page/test/
}

# What must give the same bits, by a cross compiler, in an emulator.
aarch64_suite() {
    build_or_count aarch64 aarch64 aarch64 -DFULCRUM_BUILD_TESTS=ON FulcrumParityTests || return
    gtest_suite aarch64 aarch64 FulcrumParityTests '*' qemu-aarch64 -L /usr/aarch64-linux-gnu
}

# The errors of the lab's short grid, against those of the repository; without --all not of the two scenes that take longest.
lab_suite() {
    local log=$logs/test-lab.log good bad without=(--without coincident.4096,huge.box)
    ((!all)) || without=()
    logged "Running lab" "$log" env -C "$root/build" release/bin/fulcrum-accuracy --quick --once "${without[@]}" --out lab-test \
        --baseline "$root/PerformanceTest/Accuracy/quick.json"
    read -r bad good < <(sed -nE 's/^([0-9]+) worse, ([0-9]+) better; errors: ([0-9]+) the same$/\1 \2 \3/p' "$log" |
        awk '{ print $1, $2 + $3 }')
    [[ -n ${good:-} ]] || { bad=1 good=0; }
    count lab "$good" "$bad" "$log"
    grep -m 20 '^worse' "$log"
}

programs_suites() {
    ctest_suite programs release -LE unit
    lab_suite
    ((quick)) || viewer_suite
}

# Suites that leave cores idle run beside the builds that follow: their lines are printed at the end, their progress only where they
# did not come to their totals.
beside=''
start_beside() {
    rm -f "$logs"/beside.*
    set -m
    (
        set +m
        jobs_running=() passed=0 failed=0 skipped=0 spent=0 counted=0
        stop_with_jobs
        "$@"
        echo "$passed $failed $skipped" >"$logs/beside.totals"
    ) >"$logs/beside.out" 2>"$logs/beside.errors" </dev/null &
    beside=$!
    set +m
    jobs_running+=("$beside")
}
finish_beside() {
    local more_passed=0 more_failed=1 more_skipped=0
    : >"$logs/beside.progress"
    show_progress "Running what is left of programs, lab and viewer" "$logs/beside.progress" "$beside"
    wait "$beside"
    jobs_running=()
    cat "$logs/beside.out"
    if [[ -f $logs/beside.totals ]]; then
        read -r more_passed more_failed more_skipped <"$logs/beside.totals"
    else
        cat "$logs/beside.errors" >&2
    fi
    passed=$((passed + more_passed)) failed=$((failed + more_failed)) skipped=$((skipped + more_skipped))
}

# Three builds by GCC with eight lanes, by Clang with four and with one: each must meet the golden hashes of the others. The one that
# ThreadSanitizer checks compiles each file of the engine by itself, as whoever builds it by hand does.
suites_of_all_builds() {
    local engine="-DFULCRUM_BUILD_BENCHMARKS=OFF -DFULCRUM_BUILD_SAMPLES=OFF$strict"
    # ThreadSanitizer of older compilers cannot live with much randomization of addresses; not every container lets it be off.
    local fixed_addresses=(env)
    setarch -R true 2>/dev/null && fixed_addresses=(setarch -R)
    web_suite
    # Clang compiles the lanes with checks in a fifth of GCC's time. Determinism is ThreadSanitizer's.
    build_or_count asan asan asan "$engine -DCMAKE_CXX_COMPILER=clang++ -DFULCRUM_SIMD=SSE2 -DFULCRUM_ALL_TESTS=$((all))" FulcrumTests &&
        gtest_suite asan asan FulcrumTests '-*Determinism*' env
    parity_suite tsan clang++ tsan "$engine -DFULCRUM_SIMD=SCALAR -DFULCRUM_UNITY=OFF" "${fixed_addresses[@]}"
    suites_run+=(webassembly asan tsan)
    ((all)) || return
    parity_suite scalar clang++ scalar "$engine" env
    parity_suite scalar-gcc g++ scalar "$engine" env
    parity_suite sse2-gcc g++ sse2 "$engine" env
    parity_suite clang clang++ release "$engine" env
    suites_run+=(scalar scalar-gcc sse2-gcc clang)
}

run_all_tests() {
    local quick=0 all=0 aarch64=0 strict='' option
    for option in "$@"; do
        case $option in
            --quick) quick=1 ;;
            --all) all=1 ;;
            --aarch64) aarch64=1 ;;
            --strict) strict=' -DFULCRUM_WARNINGS_AS_ERRORS=ON' ;;
            *) unknown_option "$option" test --quick --all --aarch64 --strict ;;
        esac
    done
    mkdir -p "$logs"
    # Asked for first: what is missing ends the command, in the midst of other suites if it came then.
    if ((aarch64)); then
        require "${build_requirements[@]}" "${aarch64_requirements[@]}"
    else
        require "${build_requirements[@]}" "${test_requirements[@]}"
        ((quick)) || require "${web_requirements[@]}"
    fi
    lock test
    local passed=0 failed=0 skipped=0 counted=0 suites_run=()
    spent=0 SECONDS=0
    rm -f "$logs/seconds" "$logs"/test-*.log*
    ((!all)) || export FULCRUM_ALL_TESTS=1
    if ((aarch64)); then
        aarch64_suite
        suites_run=(aarch64)
    else
        if build_or_count release release release "-DFULCRUM_BUILD_TESTS=ON$strict" all; then
            gtest_suite release release FulcrumTests '*' env
            gtest_suite accuracy release FulcrumAccuracyTests '*' env
            start_beside programs_suites
            suites_run=(release accuracy programs)
            ((quick)) || suites_run+=(viewer)
        fi
        ((quick)) || suites_of_all_builds
        [[ -z $beside ]] || finish_beside
    fi
    print_times
    ((skipped == 0)) || echo "$skipped skipped (not among the following)"
    echo "$passed passed, $failed failed" && ((failed == 0))
}
