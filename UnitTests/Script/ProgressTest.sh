#!/usr/bin/env bash
# Where no terminal is at hand the script tells on stderr how far a build is, in few lines, and leaves stdout alone.
# Argument: the script.
source "$1"

fail_test() {
    echo "$*" >&2
    exit 1
}

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Forty steps in some six seconds, as Ninja tells of them; then the exit status 3.
like_ninja() {
    for i in $(seq 40); do
        echo "[$i/40] Building"
        sleep 0.15
    done
    return 3
}
logged "Building it" "$work/log" like_ninja >"$work/out" 2>"$work/err"
[[ $? == 3 ]] || fail_test "the exit status is lost"
[[ ! -s $work/out ]] || fail_test "stdout has: $(<"$work/out")"
lines=$(grep -cE '^Building it: [0-9]+ %, [0-9]+ s$' "$work/err")
((lines >= 2 && lines <= 10)) || fail_test "$lines lines of progress: $(<"$work/err")"
[[ $(wc -l <"$work/err") == "$lines" ]] || fail_test "other lines: $(<"$work/err")"
sort -c -n -k 3 "$work/err" || fail_test "the progress goes back: $(<"$work/err")"

# What is quick is quiet.
logged "Building nothing" "$work/log" echo "[1/1] Linking" 2>"$work/err"
[[ ! -s $work/err ]] || fail_test "a quick command told: $(<"$work/err")"

# The three ways to say it.
for form in "[30/120] Building CXX object" "[ 25%] Building CXX object" " 25/100 Test  #25: Something"; do
    echo "$form" >"$work/log"
    [[ $(percent_done "$work/log") == 25 ]] || fail_test "'$form' is understood as '$(percent_done "$work/log")'"
done
echo "-- Configuring" >"$work/log"
[[ -z $(percent_done "$work/log") ]] || fail_test "per cent of nothing"
