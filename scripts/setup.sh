#!/usr/bin/env bash
# Makes .venv with the locked dependencies and this package in it (editable). Called by `make setup`.
# Needs Python 3.11-3.13; uses uv when it is on the PATH, else venv and pip. Set PYTHON to choose an interpreter.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
venv="${VENV:-.venv}"
lock=requirements/dev.txt

supported() { "$1" -c 'import sys; sys.exit(not (3, 11) <= sys.version_info[:2] < (3, 14))' 2>/dev/null; }

# A venv can be made only where ensurepip is there too (Debian splits it off); uv does not need it.
usable() { supported "$1" && { [ -n "$uv" ] || "$1" -c 'import ensurepip, venv' 2>/dev/null; }; }

find_python() {
  local name
  for name in ${PYTHON:-python3.12 python3.13 python3.11 python3 python}; do
    if command -v "$name" >/dev/null 2>&1 && usable "$name"; then
      command -v "$name"
      return 0
    fi
  done
  return 1
}

uv="$(command -v uv || true)"
if ! { [ -x "$venv/bin/python" ] && supported "$venv/bin/python"; }; then
  if python="$(find_python)"; then
    echo "situgraph: making $venv with $("$python" --version)"
    if [ -n "$uv" ]; then "$uv" venv --quiet --clear --python "$python" "$venv"; else "$python" -m venv --clear "$venv"; fi
  elif [ -n "$uv" ]; then
    echo "situgraph: no Python 3.11-3.13 found here, uv fetches 3.12"
    "$uv" venv --quiet --clear --python 3.12 "$venv"
  else
    echo "situgraph needs Python 3.11, 3.12 or 3.13 with its venv module, and none is on the PATH" \
      "(on Debian or Ubuntu: apt install python3-venv); install one, or name it: make setup PYTHON=/path/to/python3" >&2
    exit 1
  fi
fi

echo "situgraph: installing the locked dependencies"
if [ -n "$uv" ]; then
  export VIRTUAL_ENV="$PWD/$venv"
  case "$venv" in /*) export VIRTUAL_ENV="$venv" ;; esac
  "$uv" pip install --quiet --require-hashes -r "$lock"
  "$uv" pip install --quiet --no-deps --no-build-isolation --editable .
else
  # Not compiled here: most modules are never imported, and Python compiles those that are.
  "$venv/bin/python" -m pip --disable-pip-version-check install --quiet --no-compile --require-hashes -r "$lock"
  "$venv/bin/python" -m pip --disable-pip-version-check install --quiet --no-deps --no-build-isolation --editable .
fi

# Bytecode of what a match imports, also where Python is told to write none: else each process compiles it again.
env -u PYTHONDONTWRITEBYTECODE "$venv/bin/python" - <<'PY'
import situgraph
from numba.core.registry import cpu_target
situgraph.load, situgraph.match, cpu_target.target_context.refresh()
PY

"$venv/bin/python" - <<'PY'
import ctypes.util
if ctypes.util.find_library("EGL") is None:
    print("situgraph: notice: no libEGL here, pictures of the simulated camera are shaded on the CPU (slower);"
          " on Debian or Ubuntu: apt install libegl1 libegl-mesa0 libgl1-mesa-dri")
PY
echo "situgraph: ready ($venv/bin/situgraph)"
