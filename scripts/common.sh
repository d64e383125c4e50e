# Sourced by the other scripts: works from any folder, and speaks only when there is something to say.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
jobs=$(nproc)

# One compiler cache for all presets: paths are taken relative to the build folder, so that what does not depend on a
# preset is compiled once.
if command -v ccache >/dev/null; then
  export CMAKE_CXX_COMPILER_LAUNCHER=ccache CCACHE_BASEDIR=$PWD CCACHE_DIR=${CCACHE_DIR:-$PWD/build/.ccache}
  export CCACHE_SLOPPINESS=pch_defines,time_macros  # or it does not cache what uses precompiled headers
fi

# run_quietly WHAT COMMAND...: shows the command's output only if it fails.
run_quietly() {
  local what=$1 log
  shift
  log=$(mktemp)
  if ! "$@" >"$log" 2>&1; then
    cat "$log" >&2
    rm -f "$log"
    echo "failed: $what" >&2
    exit 1
  fi
  rm -f "$log"
}

# python_venv FOLDER REQUIREMENTS: a virtual environment with these packages; installs what has changed.
python_venv() {
  local venv=$1 requirements=$2 wanted
  wanted=$(sha256sum python/*requirements.txt)
  [[ ! -e $venv/installed || $(cat "$venv/installed") != "$wanted" ]] || return 0
  [[ -x $venv/bin/python ]] || run_quietly "making $venv" python3 -m venv "$venv"
  echo "Installing $requirements into $venv (a minute or two, the first time)"
  run_quietly "installing $requirements" "$venv/bin/python" -m pip install --quiet --requirement "$requirements"
  echo "$wanted" >"$venv/installed"
}

# python_environment VENV: what the Python package and its tests take, without the package.
python_environment() {
  scripts/install-dependencies --python
  python_venv "$1" python/requirements.txt
}

# python_package VENV: Crossgait's Python package in this virtual environment, from this tree. Its extension is linked
# from what the preset release has built: its folder, configured as the preset says and for this Python.
python_package() {
  local venv=$1
  python_environment "$venv"
  build release apps/all
  run_quietly "building the Python package" "$venv/bin/python" -m pip install --quiet --no-build-isolation --no-deps \
    --config-settings build-dir=build/release --config-settings cmake.args=--preset=release \
    --config-settings cmake.define.CROSSGAIT_BUILD_TESTS=ON --config-settings cmake.define.CROSSGAIT_BUILD_BENCHMARKS=ON .
}

# build PRESET [TARGET...]: configures and builds; everything if no target is named.
build() {
  local preset=$1 progress=(--quiet)
  shift
  [[ ! -t 1 ]] || progress=()
  [[ -e build/$preset/build.ninja ]] || echo "Building build/$preset (some minutes, the first time)"
  run_quietly "configuring $preset" cmake --preset "$preset"
  ninja -C "build/$preset" -j "$jobs" "${progress[@]}" "$@"
}
