#!/usr/bin/env bash
# Renders a picture as a job by OpenJD (openjd run) and by Slurm (sbatch), ends a task of each on the way, starts it again, and
# compares the picture's bits with those of one that was rendered at once. What is not installed is skipped, and nothing is installed:
#   tests/farm.sh [PROGRAM]      the program, target/release/eyerays unless another is named
# OpenJD's command is openjd-cli of PyPI. Slurm may be one machine with a node that takes jobs; FARM_FOLDER names a folder that its
# nodes share with this machine, the system's for temporary files unless another is named.
set -euo pipefail
cd "$(dirname "$0")/.."

program=$(realpath "${1:-${CARGO_TARGET_DIR:-target}/release/eyerays}")
scene=$PWD/scenes/cornell_path.toml
work=$(mktemp -d -p "${FARM_FOLDER:-${TMPDIR:-/tmp}}")
trap 'rm -rf "$work"' EXIT
options=(--device cpu --threads 1 --size 96x96 --spp 1603 --checkpoint-every 1)

fail() {
    echo "farm.sh: $*" >&2
    exit 1
}

# What runs in the program's place notes the processes of each task by the film that they write.
cat >"$work/eyerays" <<END
#!/bin/sh
for word in "\$@"; do
    case \$1\$word in render*.film) echo \$\$ >>"$work/\$(basename "\$word").pid" ;; esac
done
exec "$program" "\$@"
END
chmod +x "$work/eyerays"

# Waits at most a minute for a file.
await() {
    for _ in $(seq 600); do
        if [ -e "$1" ]; then return; fi
        sleep 0.1
    done
    fail "$1 was not written"
}

compare() {
    "$program" diff "$work/whole.exr" "$1" | grep -q "equal in every bit  yes" || fail "$1 has other bits"
}

by_openjd() {
    local job=$work/openjd
    "$program" farm "$scene" --parts 4 -o "$job" --picture picture.exr -- "${options[@]}"
    openjd check "$job/job.yaml"
    local run=(openjd run "$job/job.yaml" -p "Scene=$scene" -p "Eyerays=$work/eyerays")
    "${run[@]}" --step Render -tp Part=1 -tp From=400 -tp To=801 >"$work/killed.log" 2>&1 &
    local task=$!
    await "$job/parts/part-1.film"
    kill -KILL "$(cat "$work/part-1.film.pid")"
    if wait "$task"; then fail "the task outlived its end"; fi
    "${run[@]}" --step Merge --run-dependencies >"$work/openjd.log" 2>&1 || { cat "$work/openjd.log"; fail "openjd run failed"; }
    compare "$job/picture.exr"
    echo "OpenJD: the same bits, with a task that was killed"
}

by_slurm() {
    local job=$work/slurm parts merge
    "$program" farm "$scene" --parts 4 -o "$job" --picture picture.exr -- "${options[@]}"
    rm -f "$work"/*.pid
    read -r _ parts _ merge < <(EYERAYS=$work/eyerays sh "$job/submit.sh" | tr -d ,)
    await "$job/parts/part-1.film"
    scontrol requeue "${parts}_1"
    # Slurm lets a task rest for minutes before it is started again.
    for _ in $(seq 300); do
        case $(squeue -h -j "${parts}_1" -o %T) in
            PENDING) scontrol update "JobId=${parts}_1" StartTime=now 2>/dev/null || true ;;
        esac
        if [ -z "$(squeue -h -j "$merge" -o %T 2>/dev/null)" ]; then break; fi
        sleep 1
    done
    [ -e "$job/picture.exr" ] || { cat "$job"/parts/*.log "$job"/merge.log; fail "Slurm made no picture"; }
    [ "$(wc -l <"$work/part-1.film.pid")" -eq 2 ] || fail "the task was not started again"
    # Slurm asks a task to end before it kills it.
    grep -q "ended after [0-9]* of 401 samples" "$job/parts/part-1.log" || fail "the task was not ended on its way"
    compare "$job/picture.exr"
    echo "Slurm: the same bits, with a task that was ended on its way and queued again"
}

"$program" render "$scene" "${options[@]}" -o "$work/whole.exr" -q
if command -v openjd >/dev/null; then by_openjd; else echo "skipped: openjd is not installed (openjd-cli of PyPI)"; fi
if sinfo >/dev/null 2>&1; then by_slurm; else echo "skipped: Slurm is not installed, or has no controller that answers"; fi
