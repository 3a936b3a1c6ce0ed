#!/usr/bin/env bash
# Runs every test: formatting, lints, Rust, documentation, and Python in a virtual environment of its own, .venv.
# Tests compute for minutes: they are built in release, once, for Rust and Python alike.
# Needs Rust and Python 3.11 or newer; the network only for the package registries, and only when something is missing.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

# Environments of other projects (conda, ROS) must not leak in.
unset CONDA_PREFIX PYTHONHOME PYTHONPATH
export PYTHONNOUSERSITE=1
export VIRTUAL_ENV=$PWD/.venv
python=$VIRTUAL_ENV/bin/python
package=crates/umbmark-py
requirements=$package/requirements-test.txt

section=''
# Lints that run beside the build, and what they print.
lints='' lint_log=''
section_began=0

end_section() {
    if [ -n "$section" ]; then
        echo "-- $section: $((SECONDS - section_began)) s"
    fi
}

begin() {
    end_section
    section=$1
    section_began=$SECONDS
    printf '\n== %s\n' "$section"
}

stop() {
    echo "test.sh: $1" >&2
    exit 1
}

end() {
    local status=$?
    if [ -n "$lints" ]; then
        kill "$lints" 2> /dev/null || true
        rm -f "$lint_log"
    fi
    if [ "$status" -ne 0 ] && [ -n "$section" ]; then
        echo "test.sh: FAILED in: $section" >&2
    fi
}
trap end EXIT

# Whether a component of Rust is there that rustup may have left out.
has() {
    if ! cargo "$1" --version > /dev/null 2>&1; then
        echo "skipped: cargo $1 is not installed (rustup component add $2)"
        return 1
    fi
}

is_new_enough() {
    "$1" -c 'import sys; sys.exit(sys.version_info < (3, 11))' > /dev/null 2>&1
}

make_environment() {
    local candidate without_venv=''
    for candidate in python3.13 python3.12 python3.11 python3 python; do
        if is_new_enough "$candidate"; then
            if "$candidate" -m venv --clear .venv > /dev/null 2>&1; then
                return
            fi
            without_venv=$candidate
        fi
    done
    if [ -n "$without_venv" ]; then
        stop "$without_venv cannot make a virtual environment; install its venv module (Debian, Ubuntu: python3-venv)"
    fi
    stop 'Python 3.11 or newer is needed, and none was found as python3.13, python3.12, python3.11, python3 or python'
}

install_chromium() {
    apt-get update > /dev/null 2>&1
    DEBIAN_FRONTEND=noninteractive apt-get install --yes --no-install-recommends chromium chromium-driver > /dev/null 2>&1
}

command -v cargo > /dev/null || stop 'cargo was not found; install Rust from https://rustup.rs'

begin 'Python: environment'
if ! is_new_enough "$python"; then
    make_environment
fi
# What was installed last, written when it was complete.
installed=.venv/requirements-installed.txt
if ! cmp -s "$requirements" "$installed"; then
    "$python" -m pip install --quiet --disable-pip-version-check --requirement "$requirements"
    cp "$requirements" "$installed"
fi
"$python" --version

begin 'Rust: formatting'
if has fmt rustfmt; then
    # Not `cargo fmt`, which does not see files whose `mod` line a macro makes.
    git ls-files '*.rs' | xargs rustfmt --check --edition 2024
fi

begin 'Rust: lints and build'
# Side by side, each in its profile: the largest crate is compiled last, and on one core.
if has clippy clippy; then
    lint_log=$(mktemp)
    cargo clippy --workspace --all-targets -- -D warnings > "$lint_log" 2>&1 &
    lints=$!
fi
cargo test --release --workspace --no-run
if [ -n "$lints" ]; then
    lints_failed=0
    wait "$lints" || lints_failed=1
    cat "$lint_log"
    rm -f "$lint_log"
    lints=''
    [ "$lints_failed" = 0 ] || stop 'clippy has found something (above)'
fi

begin 'Rust: tests'
cargo test --release --workspace

begin 'Rust: documentation'
RUSTDOCFLAGS='-D warnings' cargo doc --workspace --no-deps

begin 'Python: module'
"$python" -m maturin develop --release --manifest-path "$package/Cargo.toml"

begin 'Python: formatting and lints'
"$python" -m ruff format --check --config "$package/pyproject.toml" "$package" tests/reference tests/worlds tests/report notebooks examples .ci
"$python" -m ruff check --config "$package/pyproject.toml" "$package" tests/reference tests/worlds tests/report notebooks examples .ci

begin 'Python: types'
"$python" -m mypy --config-file "$package/pyproject.toml" "$package/python" "$package/tests" examples .ci
"$python" -m mypy --config-file "$package/pyproject.toml" tests/reference
"$python" -m mypy --config-file "$package/pyproject.toml" tests/worlds
"$python" -m mypy --config-file "$package/pyproject.toml" tests/report
"$python" -m mypy.stubtest --mypy-config-file "$package/pyproject.toml" \
    --allowlist "$package/stubtest-allowlist.txt" umbmark

begin 'Python: tests'
"$python" -m pytest --numprocesses auto "$package"
"$python" -m pytest --numprocesses auto --config-file "$package/pyproject.toml" tests/reference
"$python" -m pytest --numprocesses auto --config-file "$package/pyproject.toml" tests/worlds

begin 'Python: notebooks'
# Jupyter and matplotlib write into the home folder unless they are told otherwise.
made=$(mktemp -d)
export IPYTHONDIR=$made JUPYTER_CONFIG_DIR=$made JUPYTER_DATA_DIR=$made JUPYTER_RUNTIME_DIR=$made MPLCONFIGDIR=$made
"$python" .ci/render_notebooks.py --check
rm -rf "$made"

begin 'Workbench: types of its page'
if command -v tsc > /dev/null; then
    tsc --project crates/umbmark-web/jsconfig.json
else
    echo 'skipped: tsc is not installed (npm install --global typescript)'
fi

begin 'Report and workbench: in a browser'
if ! command -v chromedriver > /dev/null && [ "$(id -u)" = 0 ] && command -v apt-get > /dev/null; then
    install_chromium || true
fi
command -v chromedriver > /dev/null || echo 'skipped in part: chromium and chromium-driver are not installed'
"$python" -m pytest --numprocesses auto --config-file "$package/pyproject.toml" tests/report

end_section
printf '\nall tests passed in %d s\n' "$SECONDS"
