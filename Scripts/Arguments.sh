# What the commands of ./fulcrum take, so that a mistake is told before anything is built. What the programs say themselves of a wrong
# option, value or name is said here in the same words: UnitTests/Script/ArgumentsTest.sh compares. Sourced by ./fulcrum.

# ---- Nearest word -----------------------------------------------------------------------------------------------------

# Levenshtein's distance of two words.
distance() {
    local a=$1 b=$2 i j cost best
    local -a previous current
    for ((j = 0; j <= ${#b}; j++)); do previous[j]=$j; done
    for ((i = 1; i <= ${#a}; i++)); do
        current=("$i")
        for ((j = 1; j <= ${#b}; j++)); do
            cost=1
            [[ ${a:i-1:1} == "${b:j-1:1}" ]] && cost=0
            best=$((previous[j - 1] + cost))
            ((previous[j] + 1 < best)) && best=$((previous[j] + 1))
            ((current[j - 1] + 1 < best)) && best=$((current[j - 1] + 1))
            current[j]=$best
        done
        previous=("${current[@]}")
    done
    distance=${previous[${#b}]}
}

# nearest WORD CANDIDATE...: the candidate of the smallest distance.
nearest() {
    local word=$1 candidate best='' least=1000 distance
    shift
    for candidate in "$@"; do
        distance "$word" "$candidate"
        if ((distance < least)); then
            least=$distance best=$candidate
        fi
    done
    echo "$best"
}

unknown() { fail "unknown $1 '$2'; the nearest is '$(nearest "${@:2}")'${hint:-}"; }

unknown_option() { fail "unknown option '$1' of $2; the nearest is '$(nearest "$1" "${@:3}")'"; }

# ---- Options of the programs ------------------------------------------------------------------------------------------

# A word an option: its name, then what it takes. Nothing: a flag. N:LEAST:MOST and X:LEAST:MOST: a number, whole or not; NN: several
# whole ones with commas; ONE:a,b: one of these; KINDS: of recordings; PART, TIME: an error, a cost;
# FILE: a file that is there; WRITE: one that is written; TEXT; MANY: all words up to the next option. Behind @ stands what the program calls
# the value, where that does not follow.
solver_options=(--preset=ONE:fast,balanced,accurate,reference@PRESET --substeps=N:1:255 --velocity-iterations=N:1:255
    --position-iterations=N:0:255 --position-correction=ONE:soft,baumgarte@KIND --narrow-phase=ONE:automatic,libccd@METHOD
    --seed=N:0:18446744073709551615)
run_options=(--steps=N:1:10000000 --seconds=X:0.001:1e+06 --dt=X:1e-05:1 --threads=N:1:64 --errors --record=KINDS --json=WRITE
    --calls=WRITE --out=TEXT@DIR --quiet "${solver_options[@]}")
options_of() {
    case $1 in
        run) options=("${run_options[@]}") ;;
        drop) options=(--count=N:1:20000 --onto=FILE --onto-scale=X:1e-06:1e+06 --onto-up=ONE:x,y,z,-x,-y,-z@AXIS "${run_options[@]}") ;;
        replay) options=(--threads=N:1:64) ;;
        shrink) options=(--speed=X:0:1e+09 --below=X:-1e+09:1e+09 --differs --crashes --out=TEXT@FILE --threads=N:1:64) ;;
        bench) options=(--scene=MANY@SCENE... --threads=NN:1:64 --steps=N:1:10000000 --dt=X:1e-05:1 --runs=N:1:1000 --only-timed --json=WRITE
            --save=WRITE --baseline=FILE --tolerance=TEXT@PERCENT --history=MANY@FILE... --peer=ONE:bullet@ENGINE --quiet "${solver_options[@]}") ;;
        accuracy) options=(--scene=TEXT@SCENE --without=TEXT@SCENE,... --quick --threads=N:1:64 --out=TEXT@DIR --resume --peer=ONE:bullet@ENGINE
            --table=TEXT@FILE --once --save=WRITE --baseline=FILE --soak --recordings --record=TEXT@SETTING --targets --commit=TEXT) ;;
        advise) options=(--error=PART --budget=TIME --out=TEXT@DIR) ;;
        *) options=() ;;
    esac
}

# word_of WHAT: what the program calls such a value.
word_of() {
    case $1 in
        *@*) echo "${1##*@}" ;;
        NN:*) echo N,... ;;
        PART) echo ERROR ;;
        WRITE) echo FILE ;;
        *) echo "${1%%:*}" ;;
    esac
}

# is_within VALUE LEAST MOST: of decimal numbers.
is_within() { awk -v value="$1" -v least="$2" -v most="$3" 'BEGIN { exit !(value + 0 >= least + 0 && value + 0 <= most + 0) }'; }

check_number() {
    local name=$1 text=$2 kind=$3 least=$4 most=$5 word='a whole number' pattern='^-?[0-9]+$'
    [[ $kind != X ]] || word='a number' pattern='^-?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][-+]?[0-9]+)?$'
    [[ $kind != NN ]] || word='whole numbers'
    [[ $text =~ $pattern || $kind == X && $text =~ ^-?(inf|infinity)$ ]] ||
        fail "$name takes $word from $least to $most, not '$text'$hint"
    is_within "$text" "$least" "$most" && return
    is_within "$text" "$least" 1e999 || most=$least
    fail "$name $text is outside $4 to $5; the nearest valid value is $most$hint"
}

check_value() {
    local name=$1 text=$2 kind least most part
    local -a known
    IFS=: read -r kind least most <<<"$3"
    case $kind in
        N | X) check_number "$name" "$text" "$kind" "$least" "$most" ;;
        NN) for part in ${text//,/ }; do check_number "$name" "$part" NN "$least" "$most"; done ;;
        ONE)
            IFS=, read -ra known <<<"$least"
            [[ " ${known[*]} " != *" $text "* ]] || return 0
            case $name in
                --position-correction) unknown "kind of $name" "$text" "${known[@]}" ;;
                --onto-up) unknown "axis of $name" "$text" "${known[@]}" ;;
                --narrow-phase) fail "$name takes ${least/,/ or }, not '$text'$hint" ;;
                --peer) unknown peer "$text" "${known[@]}" ;;
                *) unknown "$name" "$text" "${known[@]}" ;;
            esac
            ;;
        KINDS)
            for part in ${text//,/ }; do
                [[ $part =~ ^(html|glb|none)$ ]] || unknown 'kind of --record' "$part" html glb none
            done
            [[ ,$text, != *,none,* || ! $text =~ html|glb ]] || fail "--record $text: none stands alone; html,glb records both$hint"
            [[ $text =~ [a-z] ]] || fail "--record takes html, glb, html,glb or none$hint"
            ;;
        PART) [[ $text =~ ^[0-9.]+([eE][-+]?[0-9]+)?%?$ ]] || fail "$name: '$text' is no positive number with or without %" ;;
        TIME) [[ $text =~ ^[0-9.]+([eE][-+]?[0-9]+)?(ms)?$ ]] || fail "$name: '$text' is no positive number with or without ms" ;;
        FILE) [[ -f $text && -r $text ]] || fail "$name: cannot read $text" ;;
        WRITE) check_writable "$name" "$text" ;;
    esac
}

# check_writable WHAT FILE: no file is made or changed by that.
check_writable() {
    local folder
    [[ $2 != - ]] || return 0
    folder=$(dirname -- "$2")
    [[ -d $folder ]] || fail "$1 $2: there is no folder $folder"
    [[ ! -d $2 ]] || fail "$1 $2 is a folder"
    if [[ -e $2 ]]; then [[ -w $2 ]]; else [[ -w $folder ]]; fi || fail "$1: cannot write $2"
}

# parse VERB ARGUMENT...: options are checked; the other words are left in `words`, values of MANY and the names of options in `many`
# and `given`.
parse() {
    local verb=$1 argument name spec value each hint=" (./fulcrum $1 --help shows all)"
    local -a options
    shift
    [[ $verb != @(bench|accuracy|advise) ]] || hint=' (--help shows all)'
    options_of "$verb"
    words=() many=() given=()
    while (($# > 0)); do
        argument=$1
        shift
        if [[ $argument != -?* || $argument =~ ^-[0-9.] ]]; then
            words+=("$argument")
            continue
        fi
        name=${argument%%=*} spec=''
        for each in "${options[@]}"; do
            [[ ${each%%=*} != "$name" ]] || spec=$each
        done
        if [[ -z $spec ]]; then
            ((${#options[@]} > 0)) || fail "$verb takes no option '$name'"
            unknown option "$name" "${options[@]%%=*}"
        fi
        given+=("$name")
        [[ $spec == *=* ]] || continue
        if [[ $argument == *=* ]]; then value=${argument#*=}; else
            (($# > 0)) || fail "$name: 1 required $(word_of "${spec#*=}") missing$hint"
            value=$1
            shift
        fi
        spec=${spec#*=}
        check_value "$name" "$value" "${spec%@*}"
        [[ $spec == MANY@* ]] || continue
        many+=("$name:$value")
        while (($# > 0)) && [[ $1 != -* ]]; do
            many+=("$name:$1")
            shift
        done
    done
}

is_given() { [[ " ${given[*]} " == *" $1 "* ]]; }
no_more_than() {
    local hint=" (./fulcrum $2 --help shows all)"
    [[ $2 != @(bench|accuracy|advise) ]] || hint=' (--help shows all)'
    ((${#words[@]} <= $1)) || fail "one argument too many: '${words[$1]}'$hint"
}

# ---- Names ------------------------------------------------------------------------------------------------------------

scene_names() { grep -rhoE '\.name = "[a-z0-9_]+"' "$root"/Samples/Scenes/*.cpp | cut -d '"' -f 2 | grep -vxE 'drop|drop_onto'; }
# Those of the lab that have several forms are known by the first part of their name here.
lab_scene_names() { grep -rhoE '\.name = "[a-z0-9_]+"' "$root"/PerformanceTest/Accuracy/Scenes/*.cpp | cut -d '"' -f 2 | sort -u; }
is_scene_file() { [[ $1 =~ \.(json|cbor)$ ]]; }
check_scene() {
    local -a names
    mapfile -t names < <(scene_names; [[ -z ${2:-} ]] || echo "$2")
    [[ " ${names[*]} " == *" $1 "* ]] || unknown scene "$1" "${names[@]}"
}
check_file() { [[ -f $1 && -r $1 ]] || fail "cannot read $1"; }

# check_arguments VERB ARGUMENT...: returns if they may be right, or says what is wrong and exits.
check_arguments() {
    local verb=$1 hint='' each
    local -a words many given names
    shift
    parse "$verb" "$@"
    case $verb in
        run)
            no_more_than 1 run
            ((${#words[@]} > 0)) || fail "run needs a scene's name, for example: ./fulcrum run pyramid"
            ! is_given --steps || ! is_given --seconds || fail "--steps excludes --seconds"
            if is_scene_file "${words[0]}"; then check_file "${words[0]}"; else
                hint=' (./fulcrum list shows all)' check_scene "${words[0]}"
            fi
            ;;
        export)
            no_more_than 2 export
            is_scene_file "${words[1]:-}" || fail "export needs a scene and a file, for example: ./fulcrum export pyramid pyramid.json"
            hint=' (./fulcrum list shows all)' check_scene "${words[0]}"
            check_writable export "${words[1]}"
            ;;
        drop | replay | shrink)
            no_more_than 1 "$verb"
            if ((${#words[@]} == 0)); then
                [[ $verb != drop ]] || fail "drop needs a mesh file, for example: ./fulcrum drop Samples/Meshes/teapot.obj"
                fail "$verb needs a file of recorded calls, for example of ./fulcrum run pyramid --calls pyramid.calls"
            fi
            check_file "${words[0]}"
            ;;
        bench)
            for each in "${words[@]/#/--scene:}" "${many[@]}"; do
                case $each in
                    --scene:*) check_scene "${each#*:}" all ;;
                    --history:*) check_file "${each#*:}" ;;
                esac
            done
            ! is_given --tolerance || is_given --baseline || fail "--tolerance requires --baseline"
            ;;
        accuracy)
            no_more_than 0 accuracy
            mapfile -t names < <(lab_scene_names; echo all)
            each=$(option_value --scene "$@")
            is_scene_file "$each" || [[ -z $each || " ${names[*]} " == *" ${each%%.*} "* ]] || unknown scene "$each" "${names[@]}"
            ;;
        advise)
            no_more_than 1 advise
            ((${#words[@]} > 0)) || fail "SCENE is required (./fulcrum advise --help shows all)"
            is_given --error || is_given --budget || fail "advise needs --error or --budget (./fulcrum advise --help)"
            mapfile -t names < <(lab_scene_names)
            if is_scene_file "${words[0]}"; then check_file "${words[0]}"; elif [[ " ${names[*]} " != *" ${words[0]%%.*} "* ]]; then
                check_scene "${words[0]}"
            fi
            ;;
        gallery) for each in "${words[@]}"; do check_scene "$each"; done ;;
        list | docs | setup | --version) no_more_than 0 "$verb" ;;
        *) hint=' (./fulcrum --help lists all)' unknown command "$verb" "${verbs[@]}" ;;
    esac
}

check_figures() {
    local file
    case ${1:-} in
        '') ;;
        --check) (($# == 1)) || fail "figures --check takes no '$2'" ;;
        --take | --seconds)
            (($# > 1)) || fail "figures $1 needs a file"
            for file in "${@:2}"; do [[ $file == --bullet ]] || check_file "$file"; done
            ;;
        *) unknown_option "$1" figures --check --take --seconds ;;
    esac
}

fuzz_targets() { sed -nE 's/^const FuzzTarget k[A-Za-z]+\{"([a-z-]+)".*/\1/p' "$root"/UnitTests/Fuzz/*.cpp; }

# option_value NAME ARGUMENT...: the last one.
option_value() {
    local name=$1 value=''
    shift
    while (($# > 0)); do
        case $1 in
            "$name"=*) value=${1#*=} ;;
            "$name") value=${2:-} ;;
        esac
        shift
    done
    echo "$value"
}
