#!/usr/bin/env bash
# Builds the program as a package for Debian and Ubuntu: scripts/build-deb.sh [FOLDER]
# Needs Rust and cargo-deb (cargo install --locked cargo-deb); FOLDER, standard dist, gets the .deb.
set -euo pipefail
cd "$(dirname "$0")/.."
folder=${1:-dist}
program=${CARGO_TARGET_DIR:-target}/release/voltet
cargo build --locked --release -p voltet
# Where Cargo.toml's [package.metadata.deb] takes them from.
shared=target/deb
rm -rf "$shared"
mkdir -p "$shared" "$folder"
"$program" man "$shared"
gzip --no-name --best "$shared"/*.1
"$program" completions bash > "$shared/voltet.bash"
"$program" completions zsh > "$shared/_voltet"
"$program" completions fish > "$shared/voltet.fish"
gzip --no-name --best --stdout CHANGELOG.md > "$shared/changelog.gz"
# Debian's own form, of this version alone.
version=$("$program" --version)
cat > "$shared/changelog.Debian" << END
voltet (${version#voltet }-1) unstable; urgency=medium

  * Upstream release: see changelog.gz.

 -- The voltet developers <voltet@users.noreply.github.com>  $(date --rfc-email --date "@${SOURCE_DATE_EPOCH:-$(git log -1 --format=%ct)}")
END
cargo deb --no-build --output "$folder"
