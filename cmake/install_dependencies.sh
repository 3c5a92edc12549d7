#!/bin/sh
# SPDX-License-Identifier: BSD-3-Clause
# Installs what Holdfast is built from, on Debian 12, Debian 13 and their relatives. Quick when everything is there already.
#
#   sh cmake/install_dependencies.sh                  install what is missing (as root, or through sudo without a
#                                                     password)
#   sh cmake/install_dependencies.sh --training       also what the training of the U-Net and its test need
#   sh cmake/install_dependencies.sh --documentation  also what the tests of the documentation need
#   sh cmake/install_dependencies.sh --benchmarks     also what the benchmarks are built of
#   sh cmake/install_dependencies.sh --python         also what the segmenter `python` and the Python package are built
#                                                     of, and numpy
#   sh cmake/install_dependencies.sh --python-tests   the same, and what the tests of the Python package need
#   sh cmake/install_dependencies.sh --bench-tests    also a browser, Slurm's daemons and GNU parallel for tests of the
#                                                     bench
#   sh cmake/install_dependencies.sh --cameras        also what the source `openni2` (Kinect, Xtion, Astra) is built of
#   sh cmake/install_dependencies.sh --onnxruntime    also ONNX Runtime, the engine `onnxruntime` of networks, in
#                                                     /usr/local/lib, from the npm package onnxruntime-node (70 MB), where
#                                                     Debian has no package of it
#   sh cmake/install_dependencies.sh --surface        also what the section `surface` is built of, OpenVDB, and
#                                                     OctoMap's library and assimp, with which its tests
#                                                     read maps and meshes
#   sh cmake/install_dependencies.sh --ros            also ROS 1, of which its node is built and in which its test runs it
#                                                     (Debian 12; later ones have no ROS 1)
#   sh cmake/install_dependencies.sh --clang          also clang, for tests of the headers and of the format, the fuzz targets and the
#                                                     quick sanitizer build
#   sh cmake/install_dependencies.sh --valgrind       also valgrind, for tests/valgrind
#   sh cmake/install_dependencies.sh --clean-root     also mmdebstrap, for tests/clean_root.sh
#   sh cmake/install_dependencies.sh --arm64          also the cross compiler for aarch64, mmdebstrap and qemu, for
#                                                     `tests/clean_root.sh arm64` (docs/arm.md)
#   sh cmake/install_dependencies.sh --dry-run        say what would be installed, change nothing
#   sh cmake/install_dependencies.sh --list           print the names of all packages, installed or not, change nothing
set -eu

packages="
  build-essential cmake ninja-build ccache file git ca-certificates pkg-config
  libeigen3-dev libopencv-dev libceres-dev libflann-dev liblz4-dev libbz2-dev libzstd-dev libsqlite3-dev
  libdeflate-dev libjpeg-dev libopenexr-dev libdnnl-dev libboost-dev libyaml-cpp-dev libcli11-dev nlohmann-json3-dev
  libgtest-dev libgmock-dev"
basic=" $(echo $packages) "

say() { printf 'install_dependencies: %s\n' "$*"; }
fail() { say "$@" >&2; exit 1; }

# The version of ONNX Runtime that is brought where Debian has none.
onnxruntime=1.20.1
wants_onnxruntime=no

# ONNX Runtime is there where the dynamic loader knows it, by whatever way it came.
has_onnxruntime() {
  ldconfig=$(command -v ldconfig || echo /sbin/ldconfig)
  "$ldconfig" -p 2>/dev/null | grep -q 'libonnxruntime\.so'
}

dry_run=no
lists=no
for argument in "$@"; do
  case "$argument" in
    --training) packages="$packages python3 python3-numpy python3-onnx python3-opencv python3-torch" ;;
    --documentation) packages="$packages python3 doxygen" ;;
    --benchmarks) packages="$packages libbenchmark-dev" ;;
    --python | --python-tests)
      packages="$packages python3-dev pybind11-dev python3-numpy python3-pip python3-setuptools python3-venv python3-wheel"
      [ "$argument" = --python ] ||
        packages="$packages mypy python3-matplotlib python3-nbformat python3-pandas python3-psutil python3-pytest"
      ;;
    --bench-tests) packages="$packages chromium munge parallel slurm-client slurmctld slurmd" ;;
    --cameras) packages="$packages libopenni2-dev" ;;
    --onnxruntime) wants_onnxruntime=yes ;;
    --surface) packages="$packages libopenvdb-dev liboctomap-dev libassimp-dev" ;;
    --ros)
      packages="$packages libopenvdb-dev libroscpp-dev libtf2-ros-dev libnav-msgs-dev libsensor-msgs-dev libdiagnostic-msgs-dev
        libvisualization-msgs-dev libstd-srvs-dev python3-roslaunch rosout python3-rosbag python3-rospy python3-opencv
        python3-diagnostic-msgs python3-nav-msgs python3-sensor-msgs python3-std-srvs python3-tf2-msgs"
      ;;
    --clang) packages="$packages clang clang-format libclang-rt-dev llvm" ;;
    --valgrind) packages="$packages valgrind" ;;
    --clean-root) packages="$packages mmdebstrap" ;;
    --arm64) packages="$packages crossbuild-essential-arm64 mmdebstrap qemu-user-static" ;;
    --dry-run) dry_run=yes ;;
    --list) lists=yes ;;
    -h | --help) sed -n '3,31s/^# \{0,1\}//p' "$0"; exit 0 ;;
    *) fail "unknown argument '$argument'; known are --training, --documentation, --benchmarks, --python, --python-tests, --bench-tests, --cameras, --onnxruntime, --surface, --ros, --clang, --valgrind, --clean-root, --arm64, --dry-run, --list and --help" ;;
  esac
done

if [ "$lists" = yes ]; then
  echo $packages
  exit 0
fi
if ! command -v apt-get >/dev/null 2>&1 || ! command -v dpkg-query >/dev/null 2>&1; then
  fail "no apt-get here: please install, by the means of your system, what Debian 12 calls" $packages
fi

if [ "$wants_onnxruntime" = yes ] && has_onnxruntime; then wants_onnxruntime=no; fi
if [ "$wants_onnxruntime" = yes ]; then
  if [ -n "$(apt-cache search --names-only '^libonnxruntime-dev$' 2>/dev/null)" ]; then
    packages="$packages libonnxruntime-dev"
    wants_onnxruntime=no
  elif ! command -v npm >/dev/null 2>&1; then
    packages="$packages npm"
  fi
fi

# Ubuntu 22.04 has no libclang-rt-dev, whose files are in what clang needs. Nothing is known before the lists of packages
# were fetched, so that clang is the proof of them.
needs_no_clang_rt() { [ -n "$(apt-cache madison clang 2>/dev/null)" ] && [ -z "$(apt-cache madison libclang-rt-dev 2>/dev/null)" ]; }

missing=""
for package in $packages; do
  status=$(dpkg-query --show --showformat='${db:Status-Status}' "$package" 2>/dev/null || true)
  [ "$status" = installed ] && continue
  if [ "$package" = libclang-rt-dev ] && needs_no_clang_rt; then continue; fi
  missing="$missing $package"
done
missing=${missing# }

say_if_cmake_is_old() {
  cmake=$(dpkg-query --show --showformat='${Version}' cmake 2>/dev/null || true)
  if [ -n "$cmake" ] && dpkg --compare-versions "$cmake" lt 3.25; then
    say "CMake $cmake of this system is too old for Holdfast, which needs 3.25; docs/install.md#ubuntu-2204 says how to get one"
  fi
}

[ "$wants_onnxruntime" = no ] || from_npm=" onnxruntime-node@$onnxruntime (npm)"
if [ -z "$missing${from_npm:-}" ]; then
  say_if_cmake_is_old
  say "everything is installed"
  exit 0
fi
if [ "$dry_run" = yes ]; then
  say "would install:${missing:+ $missing}${from_npm:-}"
  exit 0
fi

if [ "$(id -u)" -eq 0 ]; then
  as_root=""
elif command -v sudo >/dev/null 2>&1 && sudo -n true 2>/dev/null; then
  as_root="sudo -n"
else
  say "missing packages, and neither root nor sudo without a password. Run this as root, then try again:" >&2
  [ -z "$missing" ] || printf '  apt-get update && apt-get install --yes --no-install-recommends %s\n' "$missing" >&2
  [ -z "${from_npm:-}" ] || printf '  sh cmake/install_dependencies.sh --onnxruntime\n' >&2
  exit 1
fi

# Fails where this system has no package, and says what to do without it: Ubuntu has no browser outside of snaps; Ubuntu
# 24.04 and Debian 13 have no ROS 1, and Ubuntu 24.04 has no python3-torch.
require_candidates() {
  present="" absent="" absent_basic=""
  for package in $missing; do
    case $(LC_ALL=C apt-cache policy "$package" 2>/dev/null | sed -n 's/^  Candidate: //p') in
      "" | "(none)")
        if [ "$package" = libclang-rt-dev ] && needs_no_clang_rt; then continue; fi
        case "$basic" in
          *" $package "*) absent_basic="$absent_basic $package" ;;
          *) absent="$absent $package" ;;
        esac
        ;;
      *) present="$present $package" ;;
    esac
  done
  missing=${present# }
  [ -z "$absent_basic" ] || fail "this system has no package of:$absent_basic, which Holdfast is built from. Are all package sources" \
    "switched on (Ubuntu: universe), and is the system known (docs/install.md#versions)? The others are: ${missing:-none}"
  [ -z "$absent" ] && return
  fail "this system has no package of:$absent. Leave out the option that asks for them (docs/install.md#ubuntu), or install" \
    "them from elsewhere. The others are: ${missing:-none}"
}

# `env` because sudo does not pass variables on.
run_apt() { $as_root env DEBIAN_FRONTEND=noninteractive apt-get "$@"; }
if [ -n "$missing" ]; then
  say "installing: $missing"
  run_apt update --quiet || fail "apt-get update failed; is there a network, and are the package sources right?"
  require_candidates
  run_apt install --quiet --yes --no-install-recommends $missing ||
    fail "apt-get install failed. These were wanted: $missing"
fi

# The package carries the libraries of several systems; npm checks its sum, and only the one for this machine is kept.
install_onnxruntime() {
  case $(uname -m) in
    x86_64) machine=x64 ;;
    aarch64) machine=arm64 ;;
    *) fail "the npm package onnxruntime-node has no library for $(uname -m); build ONNX Runtime, and name it in \`engine_library\`" ;;
  esac
  say "installing: onnxruntime-node@$onnxruntime (npm)"
  folder=$(mktemp -d)
  trap 'rm -rf "$folder"' EXIT
  (cd "$folder" && npm pack --silent "onnxruntime-node@$onnxruntime" >/dev/null) ||
    fail "npm pack onnxruntime-node@$onnxruntime failed; is there a network?"
  tar -xzf "$folder/onnxruntime-node-$onnxruntime.tgz" -C "$folder" "package/bin/napi-v3/linux/$machine"
  $as_root install -m 644 "$folder/package/bin/napi-v3/linux/$machine/libonnxruntime.so.1" "/usr/local/lib/libonnxruntime.so.$onnxruntime"
  $as_root "$ldconfig"
  has_onnxruntime || fail "/usr/local/lib/libonnxruntime.so.$onnxruntime is not known to the dynamic loader"
}
[ "$wants_onnxruntime" = no ] || install_onnxruntime
say_if_cmake_is_old
say "done"
