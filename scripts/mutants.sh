#!/usr/bin/env bash
# Breaks the source in one place after another and says which breaks the tests catch: scripts/mutants.sh [PATTERN].
#
# Each line of scripts/mutants.txt holds four fields between bars: file, text (which stands there once), what stands in its
# place, and the arguments of the narrowest `cargo test`. PATTERN chooses lines. What is committed is built, in the folder
# MUTANTS_TARGET (target/mutants unless given), crate by crate, so that little is compiled again, and without the portable
# lanes where the processor has others: they take nine tenths of the compiler's time. The tests must pass before anything is
# broken. A break is caught where they fail, or run longer than MUTANTS_SECONDS. Ends with 1 where one survives.
set -euo pipefail
cd "$(dirname "$0")/.."
target=$(realpath -m "${MUTANTS_TARGET:-target/mutants}")
tree=$target/tree log=$target/log
export CARGO_TARGET_DIR=$target
mkdir -p "$target"
chosen=$(grep -v -e '^#' -e '^$' scripts/mutants.txt | grep -- "${1:-}" | sort -s -t/ -k1,1)
if broken=$(awk -F'|' 'NF != 4 { print; found = 1 } END { exit !found }' <<< "$chosen"); then
    echo "not four fields between bars: $broken"
    exit 2
fi
git worktree prune
[ -e "$tree" ] || git worktree add --quiet --detach "$tree" HEAD
git -C "$tree" checkout --quiet --force --detach "$(git rev-parse HEAD)"
cd "$tree"
if grep -qw avx2 /proc/cpuinfo; then
    sed -i 's/LaneSet::Portable => true,/LaneSet::Portable => false,/; s/kernel.run::<Portable>()/unreachable!()/' lanes/dispatch.rs
fi

# The tests of a line: 0 where they pass.
run() { timeout "${MUTANTS_SECONDS:-900}" cargo test --locked $1 > "$log" 2>&1 < /dev/null; }

while read -r tests; do
    if ! run "$tests" || ! grep -q 'ok\. [1-9][0-9]* passed' "$log"; then
        echo "not whole: cargo test $tests"
        exit 1
    fi
done < <(cut -d'|' -f4 <<< "$chosen" | sort -u)

caught=0 all=0
while IFS='|' read -r file from to tests; do
    all=$((all + 1))
    text=$(cat "$file")
    rest=${text#*"$from"}
    if [[ $rest == "$text" || $rest == *"$from"* ]]; then
        echo "stale     $file: '$from' does not stand there once"
        continue
    fi
    printf '%s\n' "${text/"$from"/"$to"}" > "$file"
    if run "$tests"; then
        echo "SURVIVED  $file: $from -> $to"
    elif grep -q 'could not compile' "$log"; then
        # What does not compile is no break.
        echo "no build  $file: $from -> $to"
    else
        caught=$((caught + 1))
        echo "caught    $file: $from -> $to"
    fi
    printf '%s\n' "$text" > "$file"
done <<< "$chosen"
echo "$caught of $all caught, $((all == 0 ? 0 : 1000 * caught / all))/1000"
test "$caught" = "$all"
