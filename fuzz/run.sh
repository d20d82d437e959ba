#!/usr/bin/env bash
# Fuzzes one target under libFuzzer, guided by coverage, with AddressSanitizer and debug
# assertions, by the toolchain of the rest: run.sh TARGET [OPTIONS OF LIBFUZZER]. It needs a C++
# compiler; the flags are those that cargo-fuzz sets.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"
target=${1:?a target of src/lib.rs}
shift
host=$(rustc -vV | sed -n 's/^host: //p')
flags="--cfg fuzzing -Zsanitizer=address -Cdebug-assertions -Cpasses=sancov-module"
for option in level=4 inline-8bit-counters pc-table trace-compares; do
    flags+=" -Cllvm-args=-sanitizer-coverage-$option"
done
RUSTC_BOOTSTRAP=1 RUSTFLAGS="$flags" cargo build --release --locked --target "$host"
[ "$target" = build ] && exit
mkdir -p "grown/$target" "artifacts/$target" "corpus/$target"
# Leaks are not looked for: the name of a point file is kept for good on purpose.
STRAT_TARGET=$target ASAN_OPTIONS=detect_leaks=0 "target/$host/release/strat" "grown/$target" "corpus/$target" \
    -artifact_prefix="artifacts/$target/" -max_len=4096 -timeout=10 -rss_limit_mb=1024 \
    -detect_leaks=0 "$@"
