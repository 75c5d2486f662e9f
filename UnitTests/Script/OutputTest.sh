#!/usr/bin/env bash
# OutputTest.sh ROOT BIN: lost output is no success, of no command and no program, and is told before anything is simulated.
set -uo pipefail
[[ -e /dev/full ]] || exit 0

work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
failed=0

# loses COMMAND...: with a full device behind its output it says so, with status 1.
loses() {
    "$@" >/dev/full 2>"$work/errors"
    local status=$?
    ((status == 1)) && grep -qiE 'cannot write|write error|no space' "$work/errors" && return
    echo "$*: status $status, $(cat "$work/errors")" >&2
    failed=1
}

for form in --help help 'help run' 'help test' 'run --help'; do
    # shellcheck disable=SC2086
    loses "$1/fulcrum" $form
done
loses "$2/fulcrum-runner" list
loses "$2/fulcrum-runner" --version
loses "$2/fulcrum-runner" run --help
loses "$2/fulcrum-bench" --help
loses "$2/fulcrum-accuracy" --help
loses "$2/fulcrum-accuracy" advise --help
# A run of hours ends at once: what it would print is lost.
loses "$2/fulcrum-runner" run large_pyramid --steps 10000000 --record none
loses "$2/fulcrum-bench" large_pyramid --steps 10000000
loses "$2/fulcrum-accuracy" --out "$work/runs"

# So does what cannot write its files.
touch "$work/file"
for form in '--json /dev/null/report' "--calls $work/none/calls" "--out $work/file"; do
    # shellcheck disable=SC2086
    "$2/fulcrum-runner" run large_pyramid --steps 10000000 $form >"$work/said" 2>&1
    status=$?
    ((status == 1)) || { echo "$form: status $status, $(cat "$work/said")" >&2; failed=1; }
done
exit $failed
