#!/usr/bin/env bash
#
# Takes the pictures and the curves of docs/progressive.md again, on an idle machine: about eight minutes for the
# pictures and, on two cores, an hour for the curves.
#
#     docs/progressive.sh [pictures|curves]

set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

scenes=(balls-area balls-point shell pool nephroid shaft)

pictures() {
    cargo build --release --locked
    local nephroid="${CARGO_TARGET_DIR:-target}/release/nephroid" seconds
    for scene in "${scenes[@]}"; do
        for seconds in 10 60; do
            "$nephroid" render "$scene" --integrator ppm --resolution 240x240 --time $seconds \
                -o "docs/images/progressive-$scene-$seconds.png"
        done
    done
}

curves() {
    local files=("${scenes[@]/#/../scenes/}")
    files=("${files[@]/%/.xml}")
    cd bench
    cargo run --release --locked --bin progressive -- --svg ../docs/images/progressive-errors.svg \
        --marks 1,2,5,10,20,50,100 --reference 600 "${files[@]}"
}

case "${1:-all}" in
    pictures) pictures ;;
    curves) curves ;;
    all) pictures && curves ;;
    *) echo "docs/progressive.sh [pictures|curves]" >&2; exit 2 ;;
esac
