# Programs that ./fulcrum starts: quietly, with progress on stderr, and never left behind. Sourced by it.

# Each job is a process group of its own, by its number: what ends the script ends all of them, with whatever they have started.
jobs_running=()
# What ended jobs have taken, in milliseconds of processors.
spent=0

# For traps: ends the jobs and waits for them.
end_jobs() {
    local job
    trap '' INT TERM HUP
    for job in "${jobs_running[@]}"; do kill -TERM -- "-$job" 2>/dev/null; done
    for job in "${jobs_running[@]}"; do wait "$job" 2>/dev/null; done
}

# stop_jobs SIGNAL: for traps. Ends the jobs and dies of the signal, as who sent it expects. Ninja gives the signal on to
# compilers, which it runs in groups of their own.
stop_jobs() {
    end_jobs
    [[ ! -t 2 ]] || printf '\r\033[K' >&2
    [[ $BASHPID != "$$" ]] || echo "fulcrum: stopped" >&2
    trap - "$1" EXIT
    kill -s "$1" "$BASHPID"
}
stop_with_jobs() {
    local signal
    # shellcheck disable=SC2064
    for signal in INT TERM HUP; do trap "stop_jobs $signal" "$signal"; done
    # Whatever else ends the script, a failure or its last line.
    trap end_jobs EXIT
}

# start_job LOG COMMAND...: in the background, its number in `job`. What it took is in LOG.seconds when it has ended: "user system".
start_job() {
    local log=$1
    shift
    set -m
    (
        trap - INT TERM HUP EXIT
        set +m
        unlock "${!locks[@]}"
        TIMEFORMAT='%3U %3S'
        { time "$@" >"$log" 2>&1 </dev/null; } 2>"$log.seconds"
    ) &
    job=$!
    set +m
    jobs_running+=("$job")
}

# end_job LOG: waits for `job`; adds to `spent`, in milliseconds of processors. The job's exit status.
end_job() {
    local status user=0 system=0 left=() other
    wait "$job"
    status=$?
    for other in "${jobs_running[@]}"; do [[ $other == "$job" ]] || left+=("$other"); done
    jobs_running=("${left[@]}")
    read -r user system < <(tail -n 1 "$1.seconds" 2>/dev/null)
    [[ ! ${user:-}${system:-} =~ ^[0-9.,]+$ ]] || spent=$((spent + 10#${user//[.,]/} + 10#${system//[.,]/}))
    return $status
}

# percent_done LOG: how far Ninja, Make or CTest is, in per cent; nothing where the log does not say.
percent_done() {
    local done
    done=$(tail -n 3 "$1" | grep -oE '^(\[ *[0-9]+(/[0-9]+|%)\]| *[0-9]+/[0-9]+ Test)' | tail -n 1 | tr -d '[] Test')
    case $done in
        *%) echo "${done%\%}" ;;
        */*) echo $((100 * ${done%/*} / ${done#*/})) ;;
    esac
}

# show_progress TITLE LOG PROCESS: on stderr until the process has ended. On a terminal one line that changes; elsewhere a line
# for each tenth, at most one in two seconds and at least one in fifteen, the first after three.
show_progress() {
    local title=$1 log=$2 process=$3 percent tenth=0 start=$SECONDS last=$((SECONDS - 12))
    while kill -0 "$process" 2>/dev/null; do
        percent=$(percent_done "$log")
        if [[ -t 2 ]]; then
            printf '\r\033[K%s %s' "$title" "${percent:+$percent %}" >&2
        elif ((SECONDS - last >= 15 || (${percent:-0} / 10 > tenth && SECONDS - last >= 2 && SECONDS - start >= 2))); then
            printf '%s: %s%d s\n' "$title" "${percent:+$percent %, }" $((SECONDS - start)) >&2
            tenth=$((${percent:-0} / 10)) last=$SECONDS
        fi
        sleep 0.3
    done
    [[ ! -t 2 ]] || printf '\r\033[K' >&2
}

# logged TITLE LOG COMMAND...: runs it quietly and shows how far it is.
logged() {
    local title=$1 log=$2 job
    shift 2
    start_job "$log" "$@"
    show_progress "$title" "$log" "$job"
    end_job "$log"
}

# lock FOLDER: until the script ends or unlocks it, nobody else is at work in build/FOLDER. Whoever waits is told for whom, and can be
# ended. Who has the lock may ask again. Jobs do not hold locks: what they leave behind, as servers of compilers are, does not hold others up.
declare -A locks=()
lock() {
    [[ -z ${locks[$1]:-} ]] || return 0
    local number file=$root/build/.$1.lock
    mkdir -p "$root/build" && exec {number}<>"$file" || fail "cannot write in $root/build"
    if ! flock -n "$number"; then
        echo "fulcrum: waiting for another ./fulcrum that is at work in build/$1 (process $(<"$file"))" >&2
        until flock -n "$number"; do sleep 0.3; done
    fi
    locks[$1]=$number
    echo "$$" >"$file"
}
unlock() {
    local folder number
    for folder in "$@"; do
        number=${locks[$folder]}
        exec {number}>&-
        unset "locks[$folder]"
    done
}
