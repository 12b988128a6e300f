#!/usr/bin/env bash
# Makes voltet-VERSION.tar.gz of the commit that is checked out, and prints its sha256: packaging/source.sh VERSION [FOLDER]
# The same commit gives the same bytes: times are the commit's, and the compressed stream names neither file nor time.
set -euo pipefail
version=${1:?"the version, such as 0.3.0"}
folder=$(realpath "${2:-.}")
cd "$(dirname "$0")/.."
stated=$(sed -n '/^\[workspace.package\]/,/^$/s/^version = "\(.*\)"/\1/p' Cargo.toml)
if [ "$version" != "$stated" ]; then
    echo "Cargo.toml states the version $stated, not $version" >&2
    exit 2
fi
file=$folder/voltet-$version.tar.gz
git archive --format=tar --prefix="voltet-$version/" HEAD | gzip --no-name --best > "$file"
sha256sum "$file"
