#!/usr/bin/env bash
# ArgumentsTest.sh ROOT BIN: what the script says of wrong arguments, before anything is built, are the words of the programs, which
# stand in BIN; what the programs take, the script lets pass.
set -uo pipefail

failed=0
fail_test() {
    echo "$*" >&2
    failed=1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cp -r "$1/fulcrum" "$1/Scripts" "$work/"
mkdir -p "$work/PerformanceTest" "$work/UnitTests"
ln -s "$1/Samples" "$work/Samples"
ln -s "$1/PerformanceTest/Accuracy" "$work/PerformanceTest/Accuracy"
ln -s "$1/UnitTests/Fuzz" "$work/UnitTests/Fuzz"
bin=$2
cd "$work" || exit 1
touch some.json some.calls some.obj
# Nothing is built: it would be seen here.
sed -i '/^require() {/,/^}/d' fulcrum
printf 'require() { :; }\nbuild() { echo "builds"; exit 7; }\n' >>Scripts/Jobs.sh
sed -i '/^build() {/,/^}/d' fulcrum

program() {
    case $1 in
        bench) "$bin/fulcrum-bench" "${@:2}" ;;
        accuracy) "$bin/fulcrum-accuracy" "${@:2}" ;;
        advise) "$bin/fulcrum-accuracy" "$@" ;;
        *) "$bin/fulcrum-runner" "$@" ;;
    esac
}

# refuses ARGUMENT...: the script refuses, in the program's words.
refuses() {
    local said wanted
    wanted=$(program "$@" 2>&1 >/dev/null | head -n 1)
    said=$(./fulcrum "$@" 2>&1)
    (($? == 1)) || fail_test "'$*' is taken: $said"
    [[ $said == "$wanted" ]] || fail_test "of '$*' the script says: $said"$'\n'"the program: $wanted"
}
# takes ARGUMENT...: the script goes on to build.
takes() {
    local said
    said=$(./fulcrum "$@" 2>/dev/null)
    [[ $said == builds ]] || fail_test "'$*' is refused: $(./fulcrum "$@" 2>&1)"
}

for verb in run; do
    word=pyramid
    [[ $verb != drop ]] || word=some.obj
    for option in --steps --threads --dt --seconds --substeps --velocity-iterations --position-iterations --seed; do
        [[ $verb != bench || $option != --seconds ]] || continue
        refuses $verb $word $option x
    done
    for wrong in '--steps 0' '--dt 7' '--substeps 256' '--position-iterations -1' '--preset fst' '--stepz 3' '--position-correction hard'; do
        # shellcheck disable=SC2086
        refuses $verb $word $wrong
    done
done
refuses run
refuses run pyramidd
refuses run pyramid hinge
refuses run pyramid --record gbl
refuses run pyramid --record none,html
refuses export pyramid
refuses drop
refuses drop some.obj --count 0
refuses replay
refuses shrink
refuses shrink some.calls --speed -1
refuses list more
refuses bench pyramidd
refuses bench --threads 1,65
refuses accuracy --threads 0
refuses accuracy --quik
refuses advise pyramid

takes run pyramid --steps 5 --seed 3 --dt 0.01 --quiet --record html,glb --json=- --threads=2
takes run some.json --seconds 1e3
takes export pyramid here.cbor
takes drop some.obj --onto some.obj --onto-scale 0.5 --onto-up -z --count 7
takes replay some.calls --threads 2
takes shrink some.calls --below -3 --out smaller.calls
takes bench pyramid drum --threads 1,2 --only-timed --tolerance 5% --baseline some.json --save saved.json
takes bench --scene all --history some.json some.json
takes accuracy --quick --scene incline.stick --without incline --record "soft 1/60 4 1 1"
takes advise pyramid --error 1% --budget=2ms
takes advise incline --budget 0.5
takes list

# The options of each program are those of the script, and so are the names of scenes.
source ./fulcrum
for verb in run drop replay shrink bench accuracy advise; do
    options_of $verb
    known=$(printf '%s\n' "${options[@]%%=*}" | sort -u)
    has=$(program $verb --help | sed -nE 's/^ +(-h,)?(--[a-z-]+).*/\2/p' | grep -vx -- --help | sort -u)
    for option in "${options[@]}"; do
        [[ $option != *=* ]] || refuses $verb "${option%%=*}"
    done
    [[ $known == "$has" ]] || fail_test "options of $verb, script < and program >: $(diff <(echo "$known") <(echo "$has"))"
done
[[ $(scene_names | sort) == $("$bin/fulcrum-runner" list | sed -nE 's/^  ([a-z0-9_]+) .*/\1/p' | sort) ]] ||
    fail_test "the script knows other scenes: $(diff <(scene_names | sort) <("$bin/fulcrum-runner" list | sed -nE 's/^  ([a-z0-9_]+) .*/\1/p' | sort))"
exit $failed
