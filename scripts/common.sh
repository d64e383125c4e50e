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

# python_venv FOLDER LOCK...: a virtual environment with what these files of python/requirements/ lock; installs what has
# changed. In the place of torch.lock it may take torch-cpu.lock.
python_venv() {
  local venv=$1 wanted lock locks=() from=()
  wanted=$(cd python/requirements && sha256sum "${@:2}")
  [[ ! -e $venv/installed || $(cat "$venv/installed") != "$wanted" ]] || return 0
  [[ -x $venv/bin/python ]] || run_quietly "making $venv" python3 -m venv "$venv"
  for lock in "${@:2}"; do
    [[ $lock != torch.lock ]] || lock=$(torch_lock "$venv/bin/python")
    locks+=("$lock")
    from+=(--requirement "python/requirements/$lock")
  done
  echo "Installing ${locks[*]} into $venv (a minute or two, the first time)"
  run_quietly "installing ${locks[*]}" "$venv/bin/python" -m pip install --quiet --only-binary :all: --require-hashes "${from[@]}"
  echo "$wanted" >"$venv/installed"
}

# torch_lock PYTHON: PyTorch's build for processors alone where pip finds it, or else that of the public registry, which
# comes with 3 GB for graphics cards.
torch_lock() {
  local log lock=torch-cpu.lock
  log=$(mktemp)
  if ! "$1" -m pip install --quiet --dry-run --no-deps --only-binary :all: --require-hashes --requirement "python/requirements/$lock" >"$log" 2>&1; then
    lock=torch.lock
    grep --quiet "No matching distribution found" "$log" || { cat "$log" >&2 && exit 1; }
  fi
  rm -f "$log"
  echo "$lock"
}

# python_environment VENV: what the Python package and its tests take, without the package.
python_environment() {
  scripts/install-dependencies --python
  python_venv "$1" package.lock torch.lock
}

# python_package VENV: Crossgait's Python package in this virtual environment, from this tree. Its extension is linked
# from what the preset release has built: its folder, configured as the preset says and for this Python.
python_package() {
  local venv=$1
  python_environment "$venv"
  build release apps/all
  # No hashes: it is this tree, and takes nothing from a registry.
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
