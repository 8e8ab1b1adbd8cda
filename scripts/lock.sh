#!/usr/bin/env bash
# Writes requirements/{base,dev}.txt anew from pyproject.toml: pinned, hashed, for Python 3.11-3.13 on Linux.
# Needs uv. What the files must not hold (torch, registries, local paths) is tested in tests/architecture.
# Pass --upgrade to move to the newest releases; otherwise the pins that still fit are kept.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
uv="${UV:-uv}"

lock() {
  local output=$1
  shift
  "$uv" pip compile pyproject.toml "$@" --universal --python-version 3.11 --generate-hashes \
    --no-emit-index-url --no-emit-find-links --no-annotate --quiet \
    --custom-compile-command "scripts/lock.sh" --output-file "$output"
}

lock requirements/base.txt "$@"
# Tests and checks run on the very versions of the base install.
lock requirements/dev.txt --group dev --constraint requirements/base.txt "$@"
