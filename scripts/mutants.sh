#!/usr/bin/env bash
# Breaks the source in one place after another and says which breaks the tests catch: scripts/mutants.sh [FILE PATTERN].
# Each line of scripts/mutants.txt holds four fields between bars: file, text, what stands in its place, and the arguments
# of the narrowest `cargo test`. Works in a worktree of its own, on what is committed; ends with 1 where one survives.
set -euo pipefail
cd "$(dirname "$0")/.."
list=$PWD/scripts/mutants.txt
scratch=$(mktemp -d)
git worktree add --quiet --detach "$scratch/tree" HEAD
trap 'git worktree remove --force "$scratch/tree"; rm -rf "$scratch"' EXIT
export CARGO_TARGET_DIR=${MUTANTS_TARGET:-$scratch/target}
cd "$scratch/tree"

caught=0 survived=0
while IFS='|' read -r file from to tests; do
    case $file in '' | '#'*) continue ;; esac
    case $file in *"${1:-}"*) ;; *) continue ;; esac
    text=$(cat "$file")
    if [[ $text != *"$from"* ]]; then
        echo "stale     $file: no '$from'"
        survived=$((survived + 1))
        continue
    fi
    printf '%s\n' "${text/"$from"/"$to"}" > "$file"
    # What does not compile is no mutation.
    if ! cargo test --quiet --no-run $tests > "$scratch/log" 2>&1; then
        echo "no build  $file: $from -> $to"
        survived=$((survived + 1))
    elif cargo test --quiet $tests > "$scratch/log" 2>&1; then
        echo "SURVIVED  $file: $from -> $to"
        survived=$((survived + 1))
    else
        echo "caught    $file: $from -> $to"
        caught=$((caught + 1))
    fi
    git checkout --quiet -- "$file"
done < "$list"
echo "$caught caught, $survived not"
test "$survived" = 0
